"""A question that waits too long: what stops, the queue's next step, and what counts as a person."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import cast

import pytest

from tester.queue.events import ItemAdded, ItemBegan, ItemSkipped, ItemTaken, QueueEvent, QueueStarted
from tester.queue.fold import Queue
from tester.queue.items import PersonAsk, QueueItem, Unanswered
from tester.service.queue_changes import Changes
from tester.service.state_view import PromptView
from tester.service.unanswered import AnswerLimit
from tester.service.watch import RunWatch
from tests.tester.queue.made import item, queue_of

MOUNT = (PersonAsk(0.0, "wheel 1: 1#"),)


@dataclass
class Kept:
    """Changes that are on the disk at once."""

    queue: Queue
    events: list[QueueEvent] = field(default_factory=list[QueueEvent])

    def put(self, make: Callable[[Queue], QueueEvent], then: Callable[[str], None]) -> None:
        self.events.append(make(self.queue))
        then("")


@dataclass
class Scene:
    """An item under way that asks a question, and a clock."""

    changes: Kept
    now_s: float = 0.0
    closed: bool = True
    question: str = "mount wheel 1"
    stops: list[str] = field(default_factory=list[str])

    def __post_init__(self) -> None:
        self.limit = AnswerLimit(self.stops.append)

    def look_at(self, now_s: float) -> None:
        self.now_s = now_s
        readings = SimpleNamespace(guard_closed=self.closed)
        prompt = PromptView(1, self.question, 0.0, "") if self.question else None
        run = SimpleNamespace(engine=SimpleNamespace(ctx=SimpleNamespace(readings=readings)))
        watch = cast("RunWatch", SimpleNamespace(prompt=lambda: prompt, run=run))
        self.limit.look(watch, cast("Changes", self.changes))


@pytest.fixture
def scene(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Scene]:
    def made(policy: Unanswered | None, following: QueueItem | None = None) -> Scene:
        more = [ItemAdded(following)] if following is not None else []
        first = ItemAdded(replace(item(1, asks=MOUNT), unanswered=policy))
        queue = queue_of(first, *more, QueueStarted("anna"), ItemTaken(1), ItemBegan(1, "run-1"))
        found = Scene(Kept(queue))
        monkeypatch.setattr("tester.service.unanswered.clock", SimpleNamespace(monotonic=lambda: found.now_s))
        return found

    return made


def test_the_item_is_stopped_once_when_its_time_is_over(scene: Callable[..., Scene]) -> None:
    one = scene(Unanswered(600.0), item(2))
    for now_s in (0.0, 599.0):
        one.look_at(now_s)
    assert one.stops == []
    for now_s in (600.0, 700.0):
        one.look_at(now_s)
    assert one.stops == ["no answer within 10 min to question 1: mount wheel 1"]
    assert one.changes.events == []


def test_without_a_limit_the_question_waits(scene: Callable[..., Scene]) -> None:
    one = scene(None)
    for now_s in (0.0, 1e6):
        one.look_at(now_s)
    assert one.stops == []


def test_an_open_guard_is_a_person_and_the_time_begins_anew(scene: Callable[..., Scene]) -> None:
    one = scene(Unanswered(600.0))
    one.look_at(0.0)
    one.closed = False
    one.look_at(590.0)
    one.closed = True
    one.look_at(1100.0)
    assert one.stops == []
    one.look_at(1190.0)
    assert len(one.stops) == 1


def test_another_question_has_its_own_time(scene: Callable[..., Scene]) -> None:
    one = scene(Unanswered(600.0))
    one.look_at(0.0)
    one.question = ""
    one.look_at(500.0)
    one.question = "mount wheel 2"
    one.look_at(700.0)
    assert one.limit.left_s(Unanswered(600.0)) == 600.0
    assert one.stops == []


def test_the_queue_continues_where_the_next_item_needs_no_person(scene: Callable[..., Scene]) -> None:
    one = scene(Unanswered(600.0, skip=True), item(2))
    for now_s in (0.0, 600.0):
        one.look_at(now_s)
    why = "no answer within 10 min to question 1: mount wheel 1"
    assert one.changes.events == [ItemSkipped(1, why)]
    assert one.stops == [why]


def test_the_queue_stops_where_the_next_item_needs_a_person(scene: Callable[..., Scene]) -> None:
    one = scene(Unanswered(600.0, skip=True), item(2, asks=MOUNT))
    for now_s in (0.0, 600.0):
        one.look_at(now_s)
    assert one.changes.events == []
    assert one.stops == ["no answer within 10 min to question 1: mount wheel 1; item 2 asks for a person, too"]
