"""Why a wheel's conditions make no master curve."""

from __future__ import annotations

from pathlib import Path

from tester.analysis.master_curve.verdict import signs_of
from tester.kinds.wheel_on_belt.fit.master_conditions import MASTERS
from tests.tester.kinds.wheel_on_belt.fit.made import made_run


def test_the_papers_data_contradict_any_shift_below_the_maximum_over_temperature() -> None:
    found = MASTERS.packaged("appendix-b")
    assert "friction heats the surface of the wheel with 50 W (up to 185 W)" in found.refusal
    assert "in 11 of 17 places where both are clear" in found.refusal
    below = signs_of([one for one in found.points if one.block_c <= 70.0])
    assert (below.same, below.cells) == (11, 11)


def test_a_run_of_a_wheel_is_refused_with_its_own_power(tmp_path: Path) -> None:
    found = MASTERS.run(made_run(tmp_path / "one", [(25.0, 200.0, 0.3), (40.0, 200.0, 0.0)]))
    assert "friction heats the surface" in found.refusal
    assert len(found.points) == 1 and found.left_out[-1][1] in ("rolls without slip", "rolling")
