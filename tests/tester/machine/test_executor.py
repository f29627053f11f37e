"""The sequence of a plan, with any activities."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from tester.inputs.recipe.plan import Plan, PromptStep, Step
from tester.machine.activity import Activity, MoveFailedError
from tester.machine.executor import Executor, Procedures, Unforeseen
from tests.tester.machine.toy import LampContext, make_context


class Scans:
    """An activity of two scans."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.left = 2
        self.resumed = 0

    def resume(self, ctx: LampContext) -> None:
        self.resumed += 1

    def step(self, ctx: LampContext) -> bool:
        self.left -= 1
        if self.name == "fails":
            raise MoveFailedError("not done after 3 s")
        return self.left == 0


class LampProcedures(Procedures[LampContext]):
    """Serves prompts; returns the steps inserted before and after them."""

    def __init__(self) -> None:
        self.began: list[str] = []
        self.first: dict[str, Unforeseen[LampContext]] = {}
        self.then: dict[str, Unforeseen[LampContext]] = {}

    def activity(self, step: Step, to_come: Sequence[Step], ctx: LampContext) -> Activity[LampContext]:
        self.began.append(step.title)
        return Scans(step.title)

    def before(self, step: Step, ctx: LampContext) -> Unforeseen[LampContext] | None:
        return self.first.pop(step.title, None)

    def after(
        self, activity: Activity[LampContext], to_come: Sequence[Step], ctx: LampContext
    ) -> Unforeseen[LampContext] | None:
        assert isinstance(activity, Scans)
        return self.then.pop(activity.name, None)


def walk(procedures: LampProcedures, *texts: str) -> tuple[Executor[LampContext], list[str]]:
    """Walk prompts to the end; return the executor and the titles that were shown, scan by scan."""
    steps = tuple(PromptStep(i, text) for i, text in enumerate(texts))
    executor, ctx = Executor(Plan("toy", steps, (), (), 0.0, 1), procedures), make_context()
    shown: list[str] = []
    while not executor.finished:
        executor.step(ctx)
        shown.append(ctx.progress.title)
    return executor, list(dict.fromkeys(shown))


@pytest.fixture
def procedures() -> LampProcedures:
    return LampProcedures()


def test_steps_are_served_in_their_order(procedures: LampProcedures) -> None:
    executor, shown = walk(procedures, "a", "b")
    assert procedures.began == shown == ["a", "b"] and not executor.failed and executor.activity is None


def test_preparations_are_inserted_before_a_step(procedures: LampProcedures) -> None:
    procedures.first["b"] = Unforeseen(steps=[PromptStep(9, "x"), PromptStep(9, "y")])
    walk(procedures, "a", "b")
    assert procedures.began == ["a", "x", "y", "b"]


def test_an_activity_that_no_step_asks_for_has_a_title_of_its_own(procedures: LampProcedures) -> None:
    procedures.first["b"] = Unforeseen(Scans("look"), "look at it")
    _, shown = walk(procedures, "a", "b")
    assert shown == ["a", "look at it", "b"] and procedures.began == ["a", "b"]


def test_consequences_of_a_step_come_before_the_rest_of_the_plan(procedures: LampProcedures) -> None:
    procedures.then["a"] = Unforeseen(Scans("still a"), steps=[PromptStep(9, "x")])
    _, shown = walk(procedures, "a", "b")
    assert shown == procedures.began == ["a", "x", "b"]


def test_a_step_that_fails_ends_the_run(procedures: LampProcedures) -> None:
    procedures.then["a"] = Unforeseen(failed="the lamp is broken")
    executor, _ = walk(procedures, "a", "b")
    assert executor.failed == "the lamp is broken" and procedures.began == ["a"]


def test_a_move_that_is_not_done_in_its_time_ends_the_run(procedures: LampProcedures) -> None:
    executor, _ = walk(procedures, "fails", "b")
    assert executor.failed == "fails: not done after 3 s"


def test_after_a_hold_the_activity_in_progress_is_resumed(procedures: LampProcedures) -> None:
    executor, ctx = Executor(Plan("toy", (PromptStep(1, "a"),), (), (), 0.0, 1), procedures), make_context()
    executor.step(ctx)
    ctx.repeat_key = ctx.burst = 3
    executor.hold(ctx)
    executor.resume(ctx)
    assert isinstance(executor.activity, Scans) and executor.activity.resumed == 1
    assert (ctx.repeat_key, ctx.burst) == (0, 0)


class BusyHands:
    """Hands that need some scans."""

    def __init__(self, scans: int, failed: str = "") -> None:
        self.scans, self.then = scans, failed
        self.failed = ""

    def busy(self, now: float) -> bool:
        self.scans -= 1
        self.failed = self.then if self.scans < 0 else ""
        return self.scans >= 0


def test_no_activity_advances_while_hands_are_busy(procedures: LampProcedures) -> None:
    executor, ctx = Executor(Plan("toy", (PromptStep(1, "a"),), (), (), 0.0, 1), procedures), make_context()
    executor.hands = BusyHands(3)
    for _ in range(3):
        executor.step(ctx)
        assert not procedures.began and not executor.finished
    executor.step(ctx)
    executor.step(ctx)
    assert procedures.began == ["a"] and executor.finished and not executor.failed


def test_work_that_hands_did_not_do_ends_the_run_with_the_reason(procedures: LampProcedures) -> None:
    executor, ctx = Executor(Plan("toy", (PromptStep(1, "a"),), (), (), 0.0, 1), procedures), make_context()
    executor.step(ctx)
    executor.hands = BusyHands(1, "the hands are stuck")
    executor.step(ctx)
    assert not executor.finished
    executor.step(ctx)
    assert executor.finished and executor.failed == "a: the hands are stuck"
