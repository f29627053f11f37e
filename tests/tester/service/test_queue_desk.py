"""The queue in the service: a script replaces its clients, real runs on the simulated rig."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import pytest

from tester.base import clock
from tester.queue.items import End, ItemState
from tester.queue.places import queue_folder
from tester.queue.record import RECORD, read_queue
from tester.queue.view import ItemView, QueueView
from tester.service.alarms import Cause
from tester.service.commands import (
    Acknowledge,
    Answer,
    QueueAdd,
    QueueDrop,
    QueueMove,
    QueueSkip,
    QueueStand,
    QueueStart,
    RunRecipe,
    Stop,
)
from tester.store.run_folders import run_folders
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.service.stage import Script, Stage, play

ADD = QueueAdd("short", text=SHORT, seed=1, speed=None, yes=True)
RIG = "simulated rubber friction tester"


@pytest.fixture(autouse=True)
def _every_poll_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)


def until(stage: Stage, reached: Callable[[QueueView], bool]) -> Script:
    """Wait for a queue that meets a condition."""
    while not (stage.queues and reached(stage.queues[-1])):
        yield None


def answered(stage: Stage, command: str) -> Script:
    """Wait for the answer to a command, and forget it."""
    while command not in stage.accepted and command not in stage.refused:
        yield None


def added(stage: Stage, *adds: QueueAdd) -> Script:
    """Add items, one after the other."""
    for add in adds:
        stage.accepted.pop("queue_add", None)
        yield stage.order(add)
        yield from answered(stage, "queue_add")


def states(view: QueueView) -> list[tuple[int, str]]:
    return [(item.id, item.end.value if item.end is not None else item.state.value) for item in view.items]


def item_of(stage: Stage, number: int) -> ItemView:
    return next(item for item in stage.queues[-1].items if item.id == number)


def runs(folder: Path) -> list[str]:
    return [run.name for run in run_folders(folder / "runs")]


def test_two_items_run_one_after_the_other(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, replace(ADD, seed=2))
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: all(item.state.over for item in view.items) and len(view.items) == 2)

    stage = play(tmp_path, script)
    last = stage.queues[-1]
    assert (states(last), last.going, last.state) == ([(1, "done"), (2, "done")], False, "standing: it came to its end")
    assert [item_of(stage, number).run for number in (1, 2)] == runs(tmp_path)
    assert all(view.state for view in stage.queues)


def test_the_record_on_the_disk_is_the_queue_that_clients_see(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD, ADD)
        yield stage.order(QueueMove(3, 3, 1))
        yield from answered(stage, "queue_move")
        yield stage.order(QueueDrop(2, 4))
        yield from answered(stage, "queue_drop")

    stage = play(tmp_path, script)
    kept = read_queue(queue_folder(tmp_path / "runs", RIG, simulated=True))
    assert [(entry.item.id, entry.state) for entry in kept.listed] == [(3, ItemState.WAITING), (1, ItemState.WAITING)]
    assert [item.id for item in stage.queues[-1].listed] == [3, 1]


def test_a_change_for_an_older_revision_is_refused(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD)
        yield stage.order(QueueMove(2, 1, 1))
        yield from answered(stage, "queue_move")

    stage = play(tmp_path, script)
    assert "revision 2, not 1" in stage.refused["queue_move"]
    assert [item.id for item in stage.queues[-1].listed] == [1, 2]


def test_an_invalid_recipe_is_refused_with_every_problem(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, replace(ADD, text=SHORT.replace("200 N", "9 kN").replace("300 mm/s", "90 m/s")))

    stage = play(tmp_path, script)
    assert len(stage.refused["queue_add"].splitlines()) >= 2
    assert not stage.queues[-1].items


def test_nothing_begins_before_a_person_starts_the_queue(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD)
        for _ in range(20):
            yield None

    stage = play(tmp_path, script)
    assert not runs(tmp_path)
    assert stage.queues[-1].state == "standing: not started yet"


def test_after_a_restart_the_queue_is_stopped(tmp_path: Path) -> None:
    def first(stage: Stage) -> Script:
        yield from added(stage, ADD)
        yield stage.order(QueueStart())
        yield from answered(stage, "queue_start")

    def second(_stage: Stage) -> Script:
        for _ in range(20):
            yield None

    play(tmp_path, first)
    before = runs(tmp_path)
    stage = play(tmp_path, second)
    assert runs(tmp_path) == before
    assert not stage.queues[-1].going


def test_an_end_that_a_power_cut_took_from_the_record_is_read_from_the_run(tmp_path: Path) -> None:
    def first(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD)
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: view.items[0].end is not None)
        yield stage.order(QueueStand())
        yield from answered(stage, "queue_stand")

    def second(stage: Stage) -> Script:
        yield from until(stage, lambda view: bool(view.items))

    play(tmp_path, first)
    record = queue_folder(tmp_path / "runs", RIG, simulated=True) / RECORD
    lines = record.read_bytes().splitlines(keepends=True)
    at = next(number for number, line in enumerate(lines) if b'"event":"ended"' in line)
    record.write_bytes(b"".join(lines[:at]) + lines[at][:-20])
    stage = play(tmp_path, second)
    assert states(stage.queues[-1]) == [(1, "done"), (2, "waiting")]
    assert (item_of(stage, 1).run, stage.queues[-1].going) == (runs(tmp_path)[0], False)


def test_stop_ends_the_item_and_makes_the_queue_stand(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD)
        yield stage.order(QueueStart())
        yield from stage.until(lambda view: view.mode == "RUN")
        yield stage.order(Stop())
        yield from until(stage, lambda view: any(item.end for item in view.items))
        for _ in range(20):
            yield None

    stage = play(tmp_path, script)
    assert states(stage.queues[-1]) == [(1, "stopped"), (2, "waiting")]
    assert "item 1 was stopped: stop by client 1" in stage.queues[-1].state
    assert len(runs(tmp_path)) == 1


def test_stop_between_two_items_makes_the_queue_stand(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD)
        yield stage.order(QueueStart())
        yield from answered(stage, "queue_start")
        yield stage.order(Stop())
        for _ in range(30):
            yield None

    stage = play(tmp_path, script)
    assert (runs(tmp_path), stage.queues[-1].going) == ([], False)
    assert states(stage.queues[-1]) == [(1, "waiting")]


def test_a_skipped_item_is_stopped_and_the_next_one_runs(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD)
        yield stage.order(QueueStart())
        yield from stage.until(lambda view: view.mode == "RUN")
        yield from until(stage, lambda view: any(item.state is ItemState.RUNNING for item in view.items))
        yield stage.order(QueueSkip(1, stage.queues[-1].revision))
        yield from until(stage, lambda view: all(item.state.over for item in view.items))

    stage = play(tmp_path, script)
    assert states(stage.queues[-1]) == [(1, "stopped"), (2, "done")]
    assert item_of(stage, 1).reason == "skipped by client 1"


def test_a_trip_makes_the_queue_stand_also_once_it_is_acknowledged(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD, ADD)
        yield stage.order(QueueStart())
        yield from stage.until(lambda view: view.mode == "LATCHED")
        for _ in range(20):
            yield None
        assert states(stage.queues[-1]) == [(1, "running"), (2, "waiting")]
        yield stage.order(Stop())  # a drive whose heartbeat was lost is connected anew by the next run only
        yield from until(stage, lambda view: view.items[0].end is not None)
        stage.accepted.clear()
        yield stage.order(QueueStart())
        yield from answered(stage, "queue_start")
        yield stage.order(Acknowledge())
        for _ in range(20):
            yield None

    stage = play(tmp_path, script, 'sim.faults=["t=20 s: belt drive heartbeat lost for 3 s"]')
    last = stage.queues[-1]
    assert (states(last), last.going, len(runs(tmp_path))) == ([(1, "tripped"), (2, "waiting")], False, 1)
    assert last.state.startswith("standing: item 1 tripped")
    assert "acknowledge it first" in stage.refused["queue_start"]


def test_an_alarm_keeps_the_next_item_from_beginning(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        assert stage.service is not None
        yield from added(stage, ADD)
        stage.service.desk.alarms.raise_(Cause("disk", 2, "nearly full", ""), 0.0)
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: not view.going and "alarms" in view.state)

    stage = play(tmp_path, script)
    assert (stage.queues[-1].going, runs(tmp_path)) == (False, [])
    assert "item 1 does not begin: alarms: 1 in the list: disk" in stage.queues[-1].state


def test_a_changed_rig_makes_the_item_wait_for_a_person_who_agrees(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        assert stage.service is not None
        yield from added(stage, ADD)
        queue = stage.service.queue
        queue.rig = replace(queue.rig, overrides=("sim.noise=0.5",))
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: not view.going and "the rig file changed" in view.state)
        yield stage.order(QueueStart(agree=(1,)))
        yield from until(stage, lambda view: any(item.end for item in view.items))

    stage = play(tmp_path, script)
    waited = next(v for v in stage.queues if not v.going and "the rig file changed" in v.state)
    assert waited.state == ("standing: item 1 does not begin: recipe: the rig file changed (sim.noise: 0.5, was 1)")
    assert item_of(stage, 1).end is End.DONE


def test_a_person_cannot_agree_to_unknown_evidence(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ADD)
        yield stage.order(QueueStart(agree=(1,)))
        yield from answered(stage, "queue_start")

    assert "nothing differs that is known" in play(tmp_path, script).refused["queue_start"]


def test_no_other_run_begins_while_the_queue_goes(tmp_path: Path) -> None:
    refused: list[str] = []

    def script(stage: Stage) -> Script:
        yield from added(stage, ADD)
        yield stage.order(QueueStart())
        yield from answered(stage, "queue_start")
        yield stage.order(RunRecipe("short", text=SHORT, speed=None, yes=True))
        while "run" not in stage.refused:  # the item's own run is accepted under the same name
            yield None
        refused.append(stage.refused["run"])
        yield stage.order(QueueStand("the night is over"))
        yield from answered(stage, "queue_stand")

    stage = play(tmp_path, script)
    assert "let it stand first" in refused[0] or "a run is under way" in refused[0]
    assert "queue_stand" in stage.accepted and not stage.queues[-1].going


def test_a_damaged_record_is_reported_and_nothing_begins(tmp_path: Path) -> None:
    folder = queue_folder(tmp_path / "runs", RIG, simulated=True)
    folder.mkdir(parents=True)
    (folder / RECORD).write_bytes(b'{"chain":"0","entry":{}}\n')

    def script(stage: Stage) -> Script:
        yield stage.order(ADD)
        yield from answered(stage, "queue_add")

    stage = play(tmp_path, script)
    assert "the line is damaged" in stage.refused["queue_add"]
    assert stage.queues[-1].problem


ASKS = replace(ADD, yes=False, answer_within_s=3600.0)


class FastClock:
    """A clock that gains a minute at every check of a question."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def monotonic(self) -> float:
        self.now_s += 60.0
        return self.now_s


def unanswered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *adds: QueueAdd) -> Stage:
    """Play a queue whose first question gets no answer, until its item is over and the queue had time to continue."""
    monkeypatch.setattr("tester.service.unanswered.clock", FastClock())

    def script(stage: Stage) -> Script:
        yield from added(stage, *adds)
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: view.items[0].end is not None)
        yield from until(stage, lambda view: not view.going)

    return play(tmp_path, script)


def test_a_question_without_an_answer_stops_its_item_and_the_queue(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = unanswered(tmp_path, monkeypatch, ASKS, ADD)
    assert states(stage.queues[-1]) == [(1, "stopped"), (2, "waiting")]
    assert stage.queues[-1].state.startswith("standing: item 1 was stopped: no answer within 60 min to question 1: ")
    assert any("without an answer the item is stopped at" in view.state for view in stage.queues)


def test_a_wheel_that_was_never_mounted_keeps_the_queue_from_going_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = unanswered(tmp_path, monkeypatch, replace(ASKS, unanswered="skip"), ADD)
    assert states(stage.queues[-1]) == [(1, "stopped"), (2, "waiting")]


def test_an_answer_in_time_lets_the_item_continue(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, ASKS)
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: "waits for a person" in view.state)
        yield stage.order(Answer(1))
        yield from until(stage, lambda view: view.items[0].end is not None)

    assert states(play(tmp_path, script).queues[-1]) == [(1, "done")]


def test_copies_are_added_together_and_run_one_after_the_other(tmp_path: Path) -> None:
    def script(stage: Stage) -> Script:
        yield from added(stage, replace(ADD, copies=2))
        assert stage.accepted["queue_add"] == {"id": 1, "ids": [1, 2], "revision": 1}
        yield stage.order(QueueStart())
        yield from until(stage, lambda view: all(item.state.over for item in view.items))

    stage = play(tmp_path, script)
    assert states(stage.queues[-1]) == [(1, "done"), (2, "done")]
    seeds = [reader.run().info.seed for run in run_folders(tmp_path / "runs") for reader in [RunReader(run)]]
    assert seeds == [1, 2]


def test_a_queue_whose_first_item_would_last_too_long_is_not_started(tmp_path: Path) -> None:
    soon = datetime.fromisoformat(clock.utc_in(120.0)).astimezone().strftime("%H:%M")

    def script(stage: Stage) -> Script:
        yield from added(stage, replace(ADD, speed=1.0))
        yield stage.order(QueueStart(until=soon))
        yield from answered(stage, "queue_start")

    stage = play(tmp_path, script)
    assert stage.refused["queue_start"].startswith("item 1 may last until ")
    assert not stage.queues[-1].going
