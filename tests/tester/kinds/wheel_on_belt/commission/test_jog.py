"""Jogging on the twin: directions, scales, bounds, and its end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import pytest

from drivers.canopen import objects as o
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.jog import AXES
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.step_engine import Ended
from tester.machine.prompts import Question
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named

NAMES = [axis.name for axis in AXES]


def watched(monkeypatch: pytest.MonkeyPatch, look: Callable[[WheelRig], None]) -> None:
    """Inspect the machine at every tick."""
    advance = WheelRig.advance

    def and_look(world: WheelRig, now: float) -> None:
        advance(world, now)
        look(world)

    monkeypatch.setattr(WheelRig, "advance", and_look)


def scaled(rig: RigConfig, name: str, factor: float) -> RigConfig:
    """Return a machine whose axis moves ``factor`` times as far as the rig file says: it needs fewer counts.

    No standstill relay removes the torque at overspeed.
    """
    axis = getattr(rig.axes, name)
    new = replace(
        axis,
        velocity_increments=axis.velocity_increments / factor,
        position_increments=axis.position_increments / factor,
    )
    return replace(rig, axes=replace(rig.axes, **{name: new}), sim=replace(rig.sim, standstill_relay=False))


def turned(name: str) -> Callable[[WheelRig], None]:
    def build(world: WheelRig) -> None:
        if name in ("wheel", "belt"):
            sensor = world.plant.wheel_speed if name == "wheel" else world.plant.belt_speed
            sensor.factor *= -1.0
        else:
            world.turned.add(name)

    return build


@pytest.mark.parametrize("seed", range(2))
def test_every_axis_of_a_clean_rig_passes(tmp_path: Path, seed: int) -> None:
    bench = Bench(tmp_path / "r.jsonl", seed, steps=named("identify", *(f"jog {name}" for name in NAMES)))
    outcome = bench.run()
    assert outcome.ended is Ended.DONE, outcome
    assert outcome.rig_s < 6 * 60
    for name in NAMES:
        entry = bench.record.last(f"jog {name}")
        assert entry is not None and abs(entry.values["scale_error"]) < 0.005


@pytest.mark.parametrize("name", NAMES)
def test_a_reversed_axis_is_named(tmp_path: Path, name: str) -> None:
    bench = Bench(tmp_path / "r.jsonl", built=turned(name), steps=named(f"jog {name}"))  # type: ignore[arg-type]
    outcome = bench.run()
    assert outcome.ended is Ended.REFUSED
    assert f"the {name} axis is reversed" in outcome.text


@pytest.mark.parametrize(
    ("name", "factor"),
    [*((name, 1.1) for name in NAMES), ("wheel", 0.5), ("wheel", 10.0), ("belt", 2.0), ("press", 10.0)],
)
def test_a_wrong_scale_is_named_with_the_right_increments(tmp_path: Path, name: str, factor: float) -> None:
    rig = believed()
    bench = Bench(tmp_path / "r.jsonl", rig=rig, machine=scaled(rig, name, factor), steps=named(f"jog {name}"))
    outcome = bench.run()
    assert outcome.ended is Ended.REFUSED
    assert f"scale of the {name} axis" in outcome.text
    said = float(outcome.text.split(f"axes.{name}.velocity_increments: ")[1].split()[0].rstrip(";"))
    right = getattr(rig.axes, name).velocity_increments / factor
    assert said == pytest.approx(right, rel=0.05)


@pytest.mark.parametrize("name", ["wheel", "belt", "press"])
def test_a_scale_ten_times_wrong_is_found_before_anything_is_faster_than_a_person_may_be_near(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = believed()
    bench = Bench(tmp_path / "r.jsonl", rig=rig, machine=scaled(rig, name, 10.0), steps=named(f"jog {name}"))
    fastest = [0.0]
    deepest = [0.0]

    def look(world: WheelRig) -> None:
        fastest[0] = max(fastest[0], abs(world.rim_m_s), abs(world.belt_m_s))
        deepest[0] = max(deepest[0], world.ruler("press"))

    watched(monkeypatch, look)
    assert bench.run().ended is Ended.REFUSED
    assert fastest[0] <= 0.25
    assert deepest[0] < rig.geometry.touch_mm
    assert bench.world is not None and bench.world.plant.force_z_n == 0.0


@pytest.mark.parametrize("name", ["wheel", "belt"])
def test_a_scale_ten_times_wrong_is_named_where_the_standstill_relay_cuts_the_jog(tmp_path: Path, name: str) -> None:
    rig = believed()
    machine = replace(scaled(rig, name, 10.0), sim=rig.sim)
    outcome = Bench(tmp_path / "r.jsonl", rig=rig, machine=machine, steps=named(f"jog {name}")).run()
    assert outcome.ended is Ended.FAILED
    assert f"by a standstill relay: the scale of the {name} axis is wrong" in outcome.text


def test_a_key_press_moves_for_two_seconds_at_most_and_power_is_off_in_between(tmp_path: Path) -> None:
    bench = Bench(tmp_path / "r.jsonl", steps=named("jog belt"))
    ways: list[float] = []
    powered: list[bool] = []

    class Watched(TwinPerson):
        def put(self, question: Question) -> None:
            world = bench.world
            if world is not None:
                ways.append(world.ruler("belt"))
                powered.append(any(drive.energised for drive in world.axes.values()))
            super().put(question)

    bench.person = Watched()
    assert bench.run().ended is Ended.DONE
    assert max(b - a for a, b in pairwise(ways)) <= 2.1 * 50.0
    assert not any(powered)


def test_only_the_axis_that_is_jogged_has_power_and_its_torque_is_bounded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench = Bench(tmp_path / "r.jsonl", steps=named("jog wheel"))
    on: set[str] = set()

    def look(world: WheelRig) -> None:
        for name, drive in world.axes.items():
            if drive.energised:
                on.add(name)
                assert drive.store.values[(o.MAX_TORQUE, 0)] <= 300, name

    watched(monkeypatch, look)
    assert bench.run().ended is Ended.DONE
    assert on == {"wheel"}


def test_the_guard_may_be_open_at_rest_and_nothing_moves_until_it_is_closed(tmp_path: Path) -> None:
    bench = Bench(tmp_path / "r.jsonl", steps=named("jog belt"))

    class Opens(TwinPerson):
        opened = 0

        def prepare(self, question: Question) -> None:
            super().prepare(question)
            world = bench.world
            if question.key == "jog belt first" and world is not None:
                world.axes["press"].set_guard(self.opened > 0)
                self.opened += 1

    person = bench.person = Opens()
    assert bench.run().ended is Ended.DONE
    assert person.opened == 2
    assert any("guard or the safety chain is open" in question.text for question in person.asked)


def test_a_guard_opened_while_an_axis_moves_stops_it(tmp_path: Path) -> None:
    def opened(world: WheelRig) -> None:
        if world.ruler("belt") > 5.0:
            world.axes["press"].set_guard(False)

    bench = Bench(tmp_path / "r.jsonl", steps=named("jog belt"), look=opened)
    outcome = bench.run()
    assert outcome.ended is Ended.FAILED
    assert "guard open" in outcome.text
    assert bench.world is not None and bench.world.ruler("belt") < 12.0


def test_a_press_that_touches_stops_by_the_load_cell(tmp_path: Path) -> None:
    rig = believed()
    near = believed("sim.contact.gap=2.5 mm")
    bench = Bench(tmp_path / "r.jsonl", rig=rig, machine=near, steps=named("jog press"))

    def built(world: WheelRig) -> None:
        world.install(0, 0, "1#", new_specimen=True)

    bench.built = built
    outcome = bench.run()
    assert outcome.ended is Ended.FAILED
    assert "the wheel touches" in outcome.text
    assert bench.world is not None and bench.world.ruler("press") < 2.8  # it was touched at 2.5 mm, and springs back
