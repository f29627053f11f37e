"""Rigs whose turning axes have frequency inverters: refusals of check, and runs on the twin."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.kinds import load_rig
from tester.machine.run import Outcome
from tests.tester.kinds.wheel_on_belt.bench import AT_ONCE, Simulation

BELT = ("axes.belt.profile=cia402_inverter", "axes.belt.velocity_increments=1100")
WHEEL = ("axes.wheel.profile=cia402_inverter", "axes.wheel.gear=12", "axes.wheel.velocity_increments=114.59156")
TRACK = ("axes.track.profile=cia402_inverter", "axes.track.velocity_increments=15000")


def refused(*overrides: str, rig: str = "sim") -> str:
    with pytest.raises(InvalidSource) as error:
        load_rig(rig, overrides=overrides)
    return "; ".join(problem.message for problem in error.value.problems)


def test_wheel_and_belt_run_a_recipe_on_inverters() -> None:
    simulation = Simulation(AT_ONCE, (*BELT, *WHEEL), seed=1).to_the_end(4000.0)
    run = simulation.run
    assert run.engine.control.state.trip is None and run.outcome is Outcome.DONE, run.reason
    assert simulation.world.axes["belt"].mode_display == 2


def test_a_disc_may_be_turned_by_an_inverter() -> None:
    assert load_rig("pin-on-disc", overrides=TRACK).drives()["track"].drive.inverter


def test_an_axis_that_needs_its_position_gets_no_inverter() -> None:
    for axis in ("press", "sideslip"):
        assert "CiA 402 frequency inverter knows velocity mode only" in refused(f"axes.{axis}.profile=cia402_inverter")
    assert "feedback: CiA 402 frequency inverter" in refused(TRACK[0], rig="grosch")


@pytest.mark.parametrize(("overrides", "rig", "said"), [
    ((*BELT, "axes.belt.velocity_increments=900"), "sim", "a count of 0x6042 is 1.11 mm/s at the contact"),
    ((*BELT, "axes.belt.velocity_increments=30000"), "sim", "to 32767, the 16 bits of 0x6042"),
    ((*WHEEL, "axes.wheel.gear=10"), "sim", "gear 10 and 1 r/min a count of 0x6042 make 95.493 per rad/s"),
    ((*TRACK, "axes.track.velocity_increments=1000"), "pin-on-disc", "counts of 0x6042 (expected 100 or more"),
])
def test_counts_too_coarse_too_many_or_of_another_gear_are_refused(
    overrides: tuple[str, ...], rig: str, said: str,
) -> None:
    assert said in refused(*overrides, rig=rig)


def test_interlocks_that_watch_the_torque_are_named(tmp_path: Path) -> None:
    path = tmp_path / "mute.toml"
    text = 'title = "Mute"\nchecked = "here"\nvelocity_mode = "vl"\n[objects]\nmissing = ["6077", "6076"]\n'
    path.write_text(text, encoding="utf-8")
    said = refused(f"axes.belt.profile={path}", BELT[1])
    assert "Mute reports no torque (0x6077), as needed for shaft power, belt torque, belt caught" in said
    said = refused(f"axes.wheel.profile={path}", *WHEEL[1:])
    assert "as needed for shaft power, belt torn" in said
