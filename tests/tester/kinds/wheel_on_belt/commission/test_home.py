"""Homing on the twin: the home offset puts the zero where it is straight (CiA 402-2: zero = home + 0x607C)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.machine.commission.step_engine import Ended
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named

HOME = tuple(replace(step, needs=()) for step in named("home"))


def with_switch_at(axis: str, place_deg: float) -> Callable[[WheelRig], None]:
    """Build the home switch of an axis in off its straight place, deg."""

    def build(world: WheelRig) -> None:
        homing = world.axes[axis].homing
        assert homing is not None
        homing.home_position = place_deg

    return build


@pytest.mark.parametrize(("axis", "place_deg"), [("sideslip", 3.0), ("sideslip", -1.5), ("camber", 2.0)])
def test_the_offset_that_a_crooked_zero_asks_for_makes_it_straight(
    tmp_path: Path, axis: str, place_deg: float
) -> None:
    built = with_switch_at(axis, place_deg)
    crooked = Bench(tmp_path / "a.jsonl", built=built, steps=HOME).run()
    assert crooked.ended is Ended.REFUSED
    wanted = f"axes.{axis}.home_offset: {-place_deg:.2f} (now 0)"
    assert wanted in crooked.text
    rig = believed(f"axes.{axis}.home_offset={-place_deg}")
    bench = Bench(tmp_path / "b.jsonl", rig=rig, built=built, steps=HOME)
    assert bench.run().ended is Ended.DONE
    last = bench.record.last("home")
    assert last is not None
    assert last.values[axis] == {"shown_deg": pytest.approx(place_deg), "read_deg": pytest.approx(place_deg)}
