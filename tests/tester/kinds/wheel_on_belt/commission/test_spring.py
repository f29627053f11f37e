"""The press's lifting spring is measured by its torque and a balance; a wrong one, or a wrong torque, is named."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from random import Random

import pytest

from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.commission.step_engine import CommissionOutcome, Ended
from tester.machine.prompts import Question
from tests.campaigns.faults.stage import Stage
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench, believed, named, nothing

STEPS = named("spring")
SEEDS = range(12)
ADVICE = re.compile(r"screw.spring: ([\d.]+) N; axes.press.screw.spring_rate: ([\d.]+) N/mm")


def keys(spring_n: float, rate: float) -> tuple[str, str, str]:
    """Return the rig file's lines for a spring: a growing one takes more of the press's torque on a worn wheel."""
    return (f"axes.press.screw.spring={spring_n:g} N", f"axes.press.screw.spring_rate={rate:g} N/mm",
            "limits.load=400 N")  # fmt: skip


def drawn(seed: int) -> tuple[float, float, tuple[str, ...]]:
    """Return a spring, N and N/mm, and a twin with it and a screw's friction, by seed."""
    chooser = Random(f"{seed} spring")
    spring_n, rate = round(chooser.uniform(30.0, 60.0), 1), round(chooser.choice((0.0, chooser.uniform(0.0, 1.0))), 2)
    friction = (
        f"sim.drives.screw_efficiency={chooser.uniform(0.87, 0.93):.3f}",
        f"sim.drives.screw_drag={chooser.uniform(0.01, 0.02):.4f} N m",
        "sim.drives.screw_efficiency_spread=0",
    )
    return spring_n, rate, (f"sim.drives.press_spring={spring_n} N", f"sim.drives.press_spring_rate={rate} N/mm",
                            *friction)  # fmt: skip


def commissioned(
    path: Path, seed: int, file: tuple[str, ...], twin: tuple[str, ...] = (),
    built: Callable[[WheelRig], None] = nothing, person: TwinPerson | None = None,
) -> tuple[Bench, CommissionOutcome]:  # fmt: skip
    machine = believed(*twin)
    bench = Bench(path / "r.jsonl", seed, rig=believed(*file), machine=machine, steps=STEPS, built=built, person=person)
    return bench, bench.run()


@pytest.mark.parametrize("seed", SEEDS)
def test_the_spring_of_the_file_passes_and_its_force_is_on_record(tmp_path: Path, seed: int) -> None:
    spring_n, rate, twin = drawn(seed)
    bench, outcome = commissioned(tmp_path, seed, keys(spring_n, rate), twin)
    assert outcome.ended is Ended.DONE, outcome.text
    entry = bench.record.last("spring")
    assert entry is not None and outcome.rig_s < 60.0
    at_rest_n, grown = float(entry.values["spring_n"]), float(entry.values["rate_n_per_mm"])
    assert at_rest_n + 4.0 * grown == pytest.approx(spring_n + 4.0 * rate, abs=1.3), "half a digit of the torque"


@pytest.mark.parametrize("seed", SEEDS)
def test_another_spring_is_named_and_the_advice_passes(tmp_path: Path, seed: int) -> None:
    spring_n, rate, twin = drawn(seed)
    wrong_n = spring_n * Random(f"{seed} wrong").choice((0.8, 0.9, 1.1, 1.2))
    _, outcome = commissioned(tmp_path, seed, keys(wrong_n, rate), twin)
    assert outcome.ended is Ended.REFUSED
    advised = ADVICE.search(outcome.text)
    assert advised is not None and "lifting spring of the press" in outcome.text, outcome.text
    (tmp_path / "again").mkdir()
    _, outcome = commissioned(tmp_path / "again", seed, keys(*map(float, advised.groups())), twin)
    assert outcome.ended is Ended.DONE, outcome.text


@pytest.mark.parametrize("seed", SEEDS)
def test_a_growth_that_the_file_lacks_is_advised(tmp_path: Path, seed: int) -> None:
    _, _, twin = drawn(seed)
    twin = (*twin, "sim.drives.press_spring=45 N", "sim.drives.press_spring_rate=0.8 N/mm")
    _, outcome = commissioned(tmp_path, seed, keys(45.0, 0.0), twin)
    advised = ADVICE.search(outcome.text)
    assert advised is not None, outcome.text
    assert float(advised[2]) == pytest.approx(0.8, abs=0.25)


@pytest.mark.parametrize("seed", range(3))
def test_a_run_with_the_advised_spring_trips_nothing(tmp_path: Path, seed: int) -> None:
    spring_n, _, twin = drawn(seed)
    twin = (*twin, "sim.drives.press_spring_rate=0.9 N/mm")
    _, outcome = commissioned(tmp_path, seed, keys(0.8 * spring_n, 0.0), twin)
    advised = ADVICE.search(outcome.text)
    assert advised is not None, outcome.text
    trips: list[list[str]] = []
    for file in (keys(*map(float, advised.groups())), keys(0.9 * spring_n, 0.0)):
        stage = Stage(SHORT, twin, seed, believed=file)
        while not stage.ended:
            stage.tick()
        trips.append(stage.ledger.trips)
    assert trips == [[], ["press spring"]]


@pytest.mark.parametrize("gain", [0.88, 0.93, 1.07, 1.12])
def test_a_gain_of_the_torque_is_not_taken_for_a_spring(tmp_path: Path, gain: float) -> None:
    def built(world: WheelRig) -> None:
        world.axes["press"].misread_torque(gain, 0.0)

    _, outcome = commissioned(tmp_path, 0, (), built=built)
    assert outcome.ended is Ended.REFUSED
    assert "gain of the press's torque" in outcome.text and not ADVICE.search(outcome.text)


@pytest.mark.parametrize(("gain", "offset_nm"), [(1.0, -0.05), (0.01, 0.0), (-1.0, 0.0)])
def test_a_torque_that_no_spring_takes_is_named(tmp_path: Path, gain: float, offset_nm: float) -> None:
    def built(world: WheelRig) -> None:
        world.axes["press"].misread_torque(gain, offset_nm)

    _, outcome = commissioned(tmp_path, 0, (), built=built)
    assert outcome.ended is Ended.REFUSED
    assert "press's torque in free travel" in outcome.text


def test_a_torque_that_drifts_on_the_way_is_no_growing_spring(tmp_path: Path) -> None:
    def look(world: WheelRig) -> None:
        world.axes["press"].misread_torque(1.0, 2e-3 * world.now_s)

    outcome = Bench(tmp_path / "r.jsonl", steps=STEPS, look=look).run()
    assert "it drifts" in outcome.text and not ADVICE.search(outcome.text)


@pytest.mark.parametrize(("typed", "named_by"), [("400", "unit, zero and hook"), ("4.1", "unit, zero and hook")])
def test_nonsense_of_the_balance_changes_nothing(tmp_path: Path, typed: str, named_by: str) -> None:
    class Mistypes(TwinPerson):
        def answer(self, question: Question) -> str:
            return typed if question.key.endswith("spring weighed") else super().answer(question)

    wrong = keys(34.0, 0.0)
    _, outcome = commissioned(tmp_path, 0, wrong, person=Mistypes())
    assert outcome.ended is Ended.REFUSED
    assert named_by in outcome.text and not ADVICE.search(outcome.text)


def test_a_press_that_something_holds_is_named(tmp_path: Path) -> None:
    def look(world: WheelRig) -> None:
        if world.axes["press"].axis.position > 3.0:
            world.axes["press"].block(True)

    bench = Bench(tmp_path / "r.jsonl", steps=STEPS, look=look)
    outcome = bench.run()
    assert "something is in its way" in outcome.text


def test_a_press_without_a_spring_needs_no_balance(tmp_path: Path) -> None:
    holds = ("sim.press_on_power_loss=hold", "axes.press.screw.spring=0 N")
    bench, outcome = commissioned(tmp_path, 0, holds, holds)
    assert outcome.ended is Ended.DONE, outcome.text
    assert not any(question.key == "spring weighed" for question in bench.person.asked)
