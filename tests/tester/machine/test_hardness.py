"""The hardness that a person reads at mounting, on each kind of machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from tester.inputs.recipe.hardness import HARDNESS_U, BelievedHardness
from tester.kinds.wheel_on_belt.procedures.wheel_steps import InstallWheel
from tester.kinds.wheel_on_belt.recipe.plan_steps import Install
from tester.machine.hardness import HardnessBelief
from tester.machine.prompts import Prompt
from tests.tester.kinds.specimen_on_track.bench import DISC, TrackBench
from tests.tester.kinds.wheel_on_belt.bench import Bench, make_bench
from tests.tester.machine.plain import bench as plain

INSTALL = Install(1, specimen=1, wheel=3, compound="own", hardness=True)
OWN = HardnessBelief({"own": BelievedHardness(64.0, 2.0)}, lambda piece, shore_a: shore_a + piece)


def installed(answer: str, step: Install = INSTALL, belief: HardnessBelief = OWN, by: str = "") -> Bench:
    """Mount a wheel; its question gets this answer from this person, or an automatic one."""
    bench = make_bench(automatic=not answer)
    bench.ctx.hardness = belief
    work = InstallWheel(step, [])
    if answer:
        bench.until(work, lambda: bench.ctx.prompts.waiting is not None)
        waiting = bench.ctx.prompts.waiting
        assert waiting is not None and waiting.reply(answer) == ""
        waiting.by = by
    bench.run(work)
    return bench


def stored(bench: Bench) -> list[tuple[object, ...]]:
    return bench.notes.written("UPDATE piece SET hardness")


def test_the_hardness_of_a_wheel_is_typed_at_its_question() -> None:
    bench = installed("63.5 Shore A", by="anna")
    (row,) = stored(bench)
    assert row[:2] == (63.5, "anna") and row[-1] == 3
    assert "answer with its hardness, such as 64.5 Shore A" in bench.ctx.prompts.asked[0].text
    assert bench.notes.texts("hardness") == ["63.5 Shore A read at piece 3"] and not bench.notes.texts("doubt")


def test_a_hardness_beyond_the_tolerance_is_a_doubt() -> None:
    (said,) = installed("66.1").notes.texts("doubt")
    assert said.startswith('hardness of piece 3: 66.1 Shore A is not that of "own"')
    assert said.endswith("(expected 64 of its file, within 2)")


def test_a_yes_leaves_the_hardness_unknown() -> None:
    bench = installed("yes")
    assert stored(bench) == [] and bench.notes.texts("hardness") == ['no hardness read at piece 3: "yes"']


def test_a_compound_without_a_hardness_is_no_doubt() -> None:
    bench = installed("30", belief=HardnessBelief())
    assert stored(bench)[0][0] == 30.0 and not bench.notes.texts("doubt")


@pytest.mark.parametrize("step", [replace(INSTALL, hardness=False), replace(INSTALL, hardness=False, again=True)])
def test_a_question_that_does_not_ask_for_it_takes_no_hardness(step: Install) -> None:
    bench = make_bench(automatic=False)
    work = InstallWheel(step, [])
    bench.until(work, lambda: bench.ctx.prompts.waiting is not None)
    waiting = bench.ctx.prompts.waiting
    assert waiting is not None and waiting.reply("64") == "expected one of: yes"


def test_without_a_person_the_wheel_s_own_hardness_is_read() -> None:
    bench = installed("")
    assert bench.ctx.prompts.asked[0].answer == "67.0 Shore A (automatic)"
    assert stored(bench)[0][:2] == (67.0, "automatic")


def test_without_a_person_an_unknown_hardness_is_not_read() -> None:
    assert stored(installed("", belief=HardnessBelief({}, OWN.read))) == []


@pytest.mark.parametrize(("tolerance", "doubt"), [(None, False), (1.0, True), (5.0, False)])
def test_the_tolerance_is_that_of_the_compound_s_file(tolerance: float | None, doubt: bool) -> None:
    said = BelievedHardness(64.0, tolerance).doubt("own", 64.0 + 0.9 * HARDNESS_U)
    assert bool(said) is doubt


def asked_first(bench: Any, until: Callable[[], object]) -> Prompt:
    bench.prompts.automatic = False
    until()
    waiting = bench.prompts.waiting
    assert isinstance(waiting, Prompt)
    return waiting


def test_on_a_track_it_is_typed_at_the_specimen_s_question() -> None:
    bench = TrackBench("pin-on-disc", DISC.replace("compound: SBR", "compound: SBR, measured: {hardness: prompt}"))
    read: list[tuple[int, float, str]] = []
    bench.kept.hardness = lambda piece, shore_a, by: read.append((piece, shore_a, by))  # type: ignore[method-assign]
    waiting = asked_first(bench, lambda: bench.until(lambda one: one.prompts.waiting is not None, 60.0))
    assert waiting.text.startswith("put specimen 1 on the arm") and waiting.reply("101") != ""
    assert waiting.reply("58") == ""
    bench.until(lambda one: bool(read), bench.now + 10.0)
    assert read == [(1, 58.0, "")]


def test_on_a_plain_machine_it_is_typed_at_the_specimen_s_question() -> None:
    recipe = plain.RECIPE.replace("compound: A", "compound: A, measured: {hardness: prompt}")
    bench = plain.Bench(plain.bench_plan(recipe))
    read: list[float] = []
    journal = bench.ctx.journal
    journal.hardness = lambda piece, shore_a, by: read.append(shore_a)  # type: ignore[method-assign]
    waiting = asked_first(bench, lambda: bench.until(lambda one: one.prompts.waiting is not None))
    assert waiting.question.unit == "Shore A" and waiting.reply("58") == ""
    bench.until(lambda one: bool(read))
    assert read == [58.0]
