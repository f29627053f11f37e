"""Events at the rig become notices: which, their words, and when each is over."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.notices.notice import NextNeeded, Notice, NoticeCause, NoticeOver
from tester.service.commands import Answer, RunRecipe, Stop
from tester.service.notifier import ItemEnd, Notifier
from tester.service.state_view import PromptView, RunView
from tester.store.run_folders import RunStatus
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.service.stage import Script, Stage, play

RUN = RunView("night-1", "/runs/night-1", "r", "", "", "", None, False, 1.0, "", "running", "", None, ())


@pytest.fixture(autouse=True)
def _every_poll_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)


@pytest.fixture
def stage(tmp_path: Path) -> Stage:
    return Stage(tmp_path, lambda _stage: iter(()))  # type: ignore[arg-type,return-value]


@pytest.fixture
def notifier(stage: Stage) -> Notifier:
    made = Notifier(stage, "rig 2", simulated=False)
    made.begun(RUN)
    return made


def notices(stage: Stage) -> list[Notice]:
    return [note for note in stage.told if isinstance(note, Notice)]


def test_a_trip_is_a_notice_with_the_actions_of_machine_and_person(stage: Stage, notifier: Notifier) -> None:
    notifier.event("trip", "overload: 900 N above 800 N", "trip")
    (made,) = notices(stage)
    assert (made.cause, made.key, made.run, made.rig) == (NoticeCause.TRIP, "trip overload", "night-1", "rig 2")
    assert "standstill" in made.itself and "tester ack" in made.todo and made.by and made.since_utc


@pytest.mark.parametrize(("severity", "count"), [("warning", 1), ("info", 0)])
def test_only_a_condition_without_a_value_is_a_notice(
    stage: Stage, notifier: Notifier, severity: str, count: int
) -> None:
    notifier.event("condition", "condition 3 (200 N): insufficient: 1 of 3 valid", severity)
    assert len(notices(stage)) == count


def test_other_events_are_no_notices(stage: Stage, notifier: Notifier) -> None:
    for kind in ("step", "repeat", "command", "soak"):
        notifier.event(kind, "text", "warning")
    assert stage.told == []


@pytest.mark.parametrize(
    ("status", "outcome"),
    [(RunStatus.DONE, "done"), (RunStatus.INCOMPLETE, "short"), (RunStatus.STOPPED, "stopped"),
     (RunStatus.TRIPPED, "tripped"), (RunStatus.FAILED, "failed"), (RunStatus.UNREACHABLE, "failed")],
)  # fmt: skip
def test_an_end_has_one_of_five_outcomes(stage: Stage, notifier: Notifier, status: RunStatus, outcome: str) -> None:
    notifier.ended(replace(RUN, outcome=status.value), "night-1: so")
    (made,) = notices(stage)
    assert (made.cause, made.outcome, made.key) == (NoticeCause.FINISHED, outcome, "end of night-1")


def test_the_end_by_a_trip_has_the_trips_key(stage: Stage, notifier: Notifier) -> None:
    notifier.event("trip", "overload: 900 N above 800 N", "trip")
    notifier.ended(replace(RUN, outcome="tripped"), "night-1: tripped")
    assert [made.key for made in notices(stage)] == ["trip overload"] * 2


def test_a_later_run_does_not_take_an_earlier_trips_key(stage: Stage, notifier: Notifier) -> None:
    notifier.event("trip", "overload: 900 N above 800 N", "trip")
    notifier.over()
    notifier.begun(replace(RUN, name="night-2"))
    notifier.ended(replace(RUN, name="night-2", outcome="tripped"), "the wire is lost")
    assert notices(stage)[-1].key == "end of night-2"


def test_the_end_of_a_queues_run_is_the_items_notice(stage: Stage, notifier: Notifier) -> None:
    notifier.item_of = lambda view: ItemEnd(f"item 3 ({view.name}): done", "it begins item 4 at 02:14", "nothing", "")
    notifier.ended(replace(RUN, outcome="done"), "night-1: done")
    (made,) = notices(stage)
    assert (made.cause, made.what, made.itself) == (
        NoticeCause.ITEM, "item 3 (night-1): done", "it begins item 4 at 02:14",
    )  # fmt: skip


def test_a_question_is_one_notice_and_over_when_it_is_answered(stage: Stage, notifier: Notifier) -> None:
    question = PromptView(1, "install wheel 3", 0.0, "")
    assert [notifier.prompt(question), notifier.prompt(question), notifier.prompt(None)] == [True, False, False]
    first, over = stage.told
    assert isinstance(first, Notice) and first.what == "install wheel 3"
    assert isinstance(over, NoticeOver) and over.key == first.key


def test_the_first_question_of_a_further_part_is_a_new_one(stage: Stage, notifier: Notifier) -> None:
    notifier.prompt(PromptView(1, "install wheel 1", 0.0, ""))
    notifier.begun(RUN)
    assert notifier.prompt(PromptView(1, "install wheel 2", 0.0, ""))
    assert len(notices(stage)) == 2


def test_every_note_has_a_number_of_its_own(stage: Stage, notifier: Notifier) -> None:
    for _ in range(3):
        notifier.disk("90 MB free")
        notifier.mode("HOLD", "held by a person")
        notifier.mode("RUN", "")
    numbers = [note.number for note in stage.told if not isinstance(note, NextNeeded)]
    assert len(set(numbers)) == len(numbers) == 9


def test_a_run_reports_its_question_its_next_need_and_its_end(tmp_path: Path) -> None:
    two = SHORT.replace('  - compound: "1#"\n', '  - compound: "1#"\n  - compound: "2#"\n')

    def script(stage: Stage) -> Script:
        yield stage.order(RunRecipe("short", text=two, speed=20.0))
        yield from stage.until(lambda view: view.prompt is not None)
        yield stage.order(Answer(1))
        yield from stage.until(lambda view: view.mode == "RUN")
        yield stage.order(Stop())
        yield from stage.until(lambda view: view.run is not None and view.run.exit is not None)

    stage = play(tmp_path, script)
    kinds = [note.cause.value if isinstance(note, Notice) else note.type for note in stage.told]
    assert [kind for kind in kinds if kind != "next"] == ["prompt", "over", "finished"]
    expected = [note for note in stage.told if isinstance(note, NextNeeded)]
    assert any("wheel" in one.question and one.next_utc for one in expected)
    assert expected[-1] == NextNeeded("no run is under way")
    assert notices(stage)[-1].outcome == "stopped"
