"""Where the paper's data lie."""

from __future__ import annotations

from collections.abc import Mapping

from sim.physics.slip import LOAD_N, SLIP_M_S, TEMPERATURE_C, caveats
from tester.kinds.wheel_on_belt.fit.data import APPENDICES, rows


class Flat:
    """A law without data."""

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        return 0.5


def flat(compound: str, figures: Mapping[str, float]) -> Flat:
    return Flat()


def test_the_ranges_are_those_of_the_appendices() -> None:
    every = [row for name in APPENDICES for row in rows(name)]
    found = {key: [float(row[key]) for row in every] for key in ("load_N", "slip_mm_s", "temp_C")}
    assert (min(found["load_N"]), max(found["load_N"])) == LOAD_N
    assert (min(found["slip_mm_s"]) / 1e3, max(found["slip_mm_s"]) / 1e3) == SLIP_M_S
    assert (min(found["temp_C"]), max(found["temp_C"])) == TEMPERATURE_C


def test_a_rolling_wheel_with_an_angle_slides() -> None:
    assert not list(caveats("2#", 0.0, 200.0, 25.0, 10.0))
