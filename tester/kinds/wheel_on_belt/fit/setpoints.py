"""The paper's values and laws at setpoints of this machine: what figures show beside what was measured."""

from __future__ import annotations

from collections.abc import Callable

from sim.physics.data_range import caveats
from sim.physics.friction import MODEL_NAMES, UnknownCompoundError
from sim.physics.slip import predict
from tester.base.axes import Setpoint
from tester.kinds.wheel_on_belt.fit.data import APPENDICES, READABLE, rows
from tester.kinds.wheel_on_belt.image.axes import AXES, held_by


def published_values() -> list[tuple[Setpoint, float]]:
    """Return the readable rows of the paper's appendices, those with sideslip too, each once."""
    found: dict[Setpoint, float] = {}
    for name in APPENDICES:
        for row in rows(name):
            if row["quality"] in READABLE:
                held = AXES.setpoint(
                    row["formula"],
                    slip_velocity=1e-3 * float(row["slip_mm_s"]),
                    load=float(row["load_N"]),
                    sideslip=float(row["angle_deg"]),
                    temperature=float(row["temp_C"]),
                )
                found.setdefault(held, float(row["mu"]))
    return list(found.items())


def law_caveats(setpoint: Setpoint) -> list[str]:
    """Return why a coefficient of the paper's laws at a setpoint is to be taken with care."""
    held = held_by(setpoint)
    at = abs(held.slip_velocity_m_s), held.load_n, held.temperature_c, held.sideslip_deg
    return [*caveats(held.compound, *at)]


def law_at(name: str) -> Callable[[Setpoint], float]:
    """Return a law over setpoints, NaN for compounds that are not the paper's; raises KeyError for no such law."""
    if name not in MODEL_NAMES:
        raise KeyError(name)

    def value(setpoint: Setpoint) -> float:
        held = held_by(setpoint)
        try:
            return predict(held.compound, held.slip_velocity_m_s, held.load_n, held.temperature_c, held.sideslip_deg,
                           held.wheel_speed_m_s, name)  # fmt: skip
        except UnknownCompoundError:
            return float("nan")

    return value
