"""This machine's part of fitting: its laws, the paper's appendices, and published values and laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

from sim.physics.friction import MODEL_NAMES, UnknownCompoundError
from sim.physics.slip import caveats, predict
from tester.analysis.fit.fit_law import Sourced
from tester.analysis.fit.fit_part import FitPart, LawPlace, PublishedTable, Subject
from tester.base.axes import Setpoint, surface_of
from tester.kinds.wheel_on_belt.fit.data import APPENDICES, READABLE, appendix, rows
from tester.kinds.wheel_on_belt.fit.laws import LAWS, LOAD, SLIP
from tester.kinds.wheel_on_belt.image.axes import AXES, held_by


class WheelFits(FitPart):
    """Laws of a wheel on a belt, the paper's appendices, and the conditions of runs."""

    laws = LAWS
    cells = (LOAD, SLIP)
    packaged = tuple(APPENDICES)
    published_laws = MODEL_NAMES

    def packaged_points(self, name: str) -> Sourced:
        return appendix(name)

    def run_points(self, folder: Path) -> Sourced:
        from tester.kinds.wheel_on_belt.fit.run_data import run_points

        return run_points(folder)

    def subject(self, group: str) -> Subject:
        from tester.kinds.wheel_on_belt.fit.run_data import subject_of

        return subject_of(group)

    def published_values(self) -> Sequence[tuple[Setpoint, float]]:
        """Return the readable rows of the paper's appendices, including those with sideslip, each once."""
        values: dict[Setpoint, float] = {}
        for name in APPENDICES:
            for row in rows(name):
                if row["quality"] in READABLE:
                    setpoint = AXES.setpoint(
                        row["formula"],
                        slip_velocity=1e-3 * float(row["slip_mm_s"]),
                        load=float(row["load_N"]),
                        sideslip=float(row["angle_deg"]),
                        temperature=float(row["temp_C"]),
                    )
                    values.setdefault(setpoint, float(row["mu"]))
        return list(values.items())

    def law_caveats(self, setpoint: Setpoint) -> Sequence[str]:
        held = held_by(setpoint)
        at = abs(held.slip_velocity_m_s), held.load_n, held.temperature_c, held.sideslip_deg
        return [*caveats(held.compound, *at)]

    def place(self, setpoint: Setpoint) -> LawPlace | None:
        held = held_by(setpoint)
        angled = any(held.positions.values())
        at = held.temperature_c, held.load_n, abs(held.slip_velocity_m_s)
        return None if angled else LawPlace(Subject(held.compound, surface=surface_of(setpoint)), *at)

    def law_at(self, name: str) -> Callable[[Setpoint], float]:
        """Return a law over setpoints, NaN for compounds outside the paper; raises KeyError for an unknown law."""
        if name not in MODEL_NAMES:
            raise KeyError(name)

        def value(setpoint: Setpoint) -> float:
            held = held_by(setpoint)
            try:
                return predict(held.compound, held.slip_velocity_m_s, held.load_n, held.temperature_c,
                               held.sideslip_deg, held.wheel_speed_m_s, name)  # fmt: skip
            except UnknownCompoundError:
                return float("nan")

        return value

    def checked(self, sources: Sequence[str], validation: Sequence[str]) -> bool:
        """Return whether this is the paper's own split: fitted to appendix A, validated on B."""
        from tester.kinds.wheel_on_belt.fit.published import FIT, VALIDATION

        return [*sources] == [FIT] and [*validation] == [VALIDATION]

    def published_table(self) -> PublishedTable:
        from tester.kinds.wheel_on_belt.fit.published import published_table

        return published_table()


FITS: Final = WheelFits()
