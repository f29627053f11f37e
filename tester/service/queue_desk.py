"""The queue in the service: clients' changes, the evidence before an item, the message to clients.

It starts nothing itself: ``due`` returns the item that may begin, and the service's loop runs it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from pydantic import JsonValue

from tester.base import clock
from tester.base.lock import ExclusiveUse, RigInUseError
from tester.base.screen import Check
from tester.base.trouble import in_words
from tester.queue.assess import Assessment, AssessTask
from tester.queue.check import following
from tester.queue.decide import Evidence, Look, StartItem, decide, too_late
from tester.queue.events import (
    ItemAgreed,
    ItemBegan,
    ItemEnded,
    ItemReturned,
    ItemTaken,
    QueueEvent,
    QueueStarted,
    QueueStood,
)
from tester.queue.fold import MOST_WAITING, Queue, QueueEntry, QueueError
from tester.queue.items import End, QueueItem
from tester.queue.places import item_folder, queue_folder, run_recipe
from tester.queue.record import QueueRecord
from tester.queue.recover import recovery
from tester.service.assessing import Assessor
from tester.service.commands import QueueAdd, QueueOrder, QueueSkip, QueueStand, QueueStart
from tester.service.queue_changes import Changes
from tester.service.queue_edits import added, edited, stood
from tester.service.queue_evidence import Attested, evidence_of
from tester.service.queue_news import QueueNews
from tester.service.service_link import Order
from tester.service.state_publisher import Desk
from tester.service.unanswered import AnswerLimit

AGAIN_S: Final = 30.0
"""Time until the rig is looked at again while an item waits for something that passes without a person, s [A]."""
MOST_ADDS: Final = 50
"""Greatest number of items that wait to be checked."""


@dataclass(frozen=True, slots=True)
class QueueRig:
    """The service's rig as its options name it: what every item runs on."""

    rig: str
    overrides: tuple[str, ...]
    accept_risk: str
    runs: Path


@dataclass(slots=True)
class _Found:
    """What a look for an item found. ``at_s``: tester.base.clock.monotonic."""

    item: int
    revision: int
    what: Assessment
    at_s: float


class QueueDesk:
    """The queue of the service's rig."""

    def __init__(self, desk: Desk, rig: QueueRig, stop: Callable[[str], None], busy: Callable[[], str]) -> None:
        """``stop`` stops the item under way for a reason; ``busy`` returns why nothing may begin, "" if it may."""
        self.desk = desk
        self.rig = rig
        self.folder = queue_folder(rig.runs, desk.rig.name, simulated=desk.rig.simulated)
        self.problem = "the queue is not read yet"
        self.changes: Changes | None = None
        self._stop = stop
        self._busy = busy
        self._use = ExclusiveUse()
        self._assessor = Assessor()
        self._adds: deque[Order] = deque()
        self._looking: Order | tuple[int, int] | None = None
        """What the look under way is for: an order that adds, or item and revision."""
        self._found: _Found | None = None
        self._attested: Attested | None = None
        self._wait = ""
        """Why the next item does not begin, as long as the queue goes."""
        self._again_s = 0.0
        self._limit = AnswerLimit(stop)
        self._news = QueueNews(desk, self._limit)

    # -- the record -------------------------------------------------------------------------------------------

    def open(self) -> None:
        """Read the record, and put right what an ended service left. Nothing begins before a person starts the
        queue.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            self._use.lock_file("the queue", self.folder / ".lock", "", lasting=False)
            record = QueueRecord(self.folder)
            for event in recovery(record.queue, self.folder, self.rig.runs):
                record.append(event)
        except (QueueError, RigInUseError, OSError) as error:
            self.problem = in_words(error)
            return
        self.changes, self.problem = Changes(record), ""

    def close(self) -> None:
        """Write what waits, and close the record."""
        self._assessor.end()
        if self.changes is not None:
            self.changes.close()
        self._use.release()

    @property
    def queue(self) -> Queue:
        """The queue as it is on the disk; empty while it cannot be used."""
        return self.changes.queue if self.changes is not None else Queue(why=self.problem)

    @property
    def going(self) -> bool:
        """Whether the next item may begin by itself."""
        return self.queue.going

    @property
    def unsettled(self) -> bool:
        """Whether a change is not on the disk yet."""
        return self.changes is not None and self.changes.pending

    # -- clients ----------------------------------------------------------------------------------------------

    def obey(self, order: Order, action: QueueOrder) -> None:
        """Carry out a client's change of the queue, or refuse it with a reason."""
        if self.changes is None:
            self.desk.gateway.refuse(order, self.problem)
        elif isinstance(action, QueueAdd):
            self._add(order)
        elif isinstance(action, QueueStart):
            self._start(order, action)
        elif isinstance(action, QueueStand):
            reason = f"stood by {order.by}" + (f": {action.reason}" if action.reason else "")
            self._put(order, lambda _queue: QueueStood(reason, order.by))
        else:
            self._put(order, lambda queue: edited(queue, action, order.by), lambda: self._edited(action, order.by))

    def stopped(self, by: str) -> None:
        """Let the queue stand after STOP from any client."""
        if self.changes is not None and (self.going or self.unsettled):
            self.changes.put(lambda queue: stood(queue, by))

    def _put(self, order: Order, make: Callable[[Queue], QueueEvent], done: Callable[[], None] = lambda: None) -> None:
        """Ask for a change and answer its client once it is on the disk."""
        assert self.changes is not None

        def then(refusal: str) -> None:
            if refusal:
                self.desk.gateway.refuse(order, refusal)
                return
            self.desk.command(f"{order.action.command.replace('_', ' ')} by {order.by}")
            done()
            self.desk.gateway.accept(order, {"revision": self.queue.revision})

        self.changes.put(make, then)

    def _edited(self, action: QueueOrder, by: str) -> None:
        under_way = self.queue.under_way
        if isinstance(action, QueueSkip) and under_way is not None and under_way.item.id == action.id:
            self._stop(f"skipped by {by}")

    def _add(self, order: Order) -> None:
        if len(self._adds) >= MOST_ADDS:
            self.desk.gateway.refuse(order, f"{MOST_ADDS} items wait to be checked already: wait for their answers")
        elif len(self.queue.listed) >= MOST_WAITING:  # the record refuses copies beyond it
            self.desk.gateway.refuse(order, f"the queue is full: it holds {MOST_WAITING} items")
        else:
            self._adds.append(order)

    def _start(self, order: Order, action: QueueStart) -> None:
        """Start the queue; first a look at the first item to which a person agrees, whose hashes are then kept."""
        assert self.changes is not None
        until_utc = following(action.until, clock.utc_now()) if action.until else ""
        if why := self._may_not_start(action, until_utc):
            self.desk.gateway.refuse(order, why)
            return
        for number in action.agree:
            found = self._found
            if found is None or found.item != number:
                text = f"item {number}: nothing differs that is known; start the queue, and it says what does"
                self.desk.gateway.refuse(order, text)
                return
            hashes = found.what.hashes
            self.changes.put(lambda _queue, n=number, h=hashes: ItemAgreed(n, h, order.by))

        def started() -> None:
            self._attested = Attested(order.by, clock.monotonic())
            self._found, self._again_s, self._wait = None, 0.0, ""

        self._put(order, lambda _queue: QueueStarted(order.by, until_utc), started)

    def _may_not_start(self, action: QueueStart, until_utc: str) -> str:
        if self.queue.going:
            return "the queue is started already"
        if self.desk.latched:
            return f"the rig is latched ({self.desk.latched}): acknowledge it first"
        return too_late(self.queue, until_utc, clock.utc_now())

    # -- between two ticks --------------------------------------------------------------------------------------

    def look(self) -> None:
        """Go on with changes and looks, and publish what is new; never wait."""
        if self.changes is not None:
            self.changes.look()
            self._look_at_items()
            self._limit.look(self.desk.watch, self.changes)
        self._publish()

    def _look_at_items(self) -> None:
        if self._assessor.busy:
            found = self._assessor.poll()
            if found is None:
                return
            self._take(found)
        if self._looking is None and self._adds and not self.unsettled:
            order = self._adds.popleft()
            assert isinstance(order.action, QueueAdd)
            self._begin_look(order, self._task(self.queue.next_id, order.action))

    def _begin_look(self, what: Order | tuple[int, int], task: AssessTask) -> None:
        self._looking = what
        try:
            self._assessor.begin(task)
        except OSError as error:
            self._take(Assessment((f"the recipe cannot be checked: {error}",)))

    def _task(self, number: int, what: QueueAdd | QueueEntry) -> AssessTask:
        rig, folder = self.rig, str(item_folder(self.folder, number))
        own = what if isinstance(what, QueueAdd) else what.item
        overrides = (*rig.overrides, *own.overrides)
        task = AssessTask(folder, str(rig.runs), rig.rig, "", "", overrides, rig.accept_risk, own.yes, own.speed)
        if isinstance(what, QueueAdd):
            return replace(task, origin="" if what.text else what.recipe, text=what.text, copies=what.copies)
        item = what.item
        return replace(task, origin=item.origin, text=item.recipe, then=what.agreed, known_rig=item.rig,
                       simulated=item.simulated)  # fmt: skip

    def _take(self, found: Assessment) -> None:
        """Take the result of a look."""
        looking, self._looking = self._looking, None
        if isinstance(looking, tuple):
            self._found = _Found(*looking, found, clock.monotonic())
        elif looking is not None and found.problems:
            self.desk.gateway.refuse(looking, "\n".join(found.problems))
        elif looking is not None:
            order, action = looking, looking.action
            assert isinstance(action, QueueAdd) and self.changes is not None

            def then(refusal: str) -> None:
                if refusal:
                    self.desk.gateway.refuse(order, refusal)
                    return
                numbers = [entry.item.id for entry in self.queue.entries[-action.copies :]]
                self.desk.command(f"queue add {', '.join(map(str, numbers))} ({found.name}) by {order.by}")
                result: JsonValue = {"id": numbers[0], "ids": [*numbers], "revision": self.queue.revision}
                self.desk.gateway.accept(order, result)

            self.changes.put(lambda queue: added(queue, action, found, order.by), then)

    def due(self) -> QueueItem | None:
        """Return the item that may begin now; None while the queue waits. Call it only while nothing is under way."""
        if self.changes is None or self.unsettled or self.changes.broken:
            return None
        verdict = decide(self.queue, self._evidence(), clock.utc_now())
        if isinstance(verdict, StartItem):
            self._found, self._wait, self._again_s = None, f"item {verdict.item} begins", 0.0
            return self.queue.entry(verdict.item).item
        if isinstance(verdict, Look):
            if self._looking is None and not self._adds and clock.monotonic() >= self._again_s:
                self._wait = verdict.reason
                entry = self.queue.entry(verdict.item)
                self._begin_look((verdict.item, self.queue.revision), self._task(verdict.item, entry))
            return None
        self._wait, self._again_s = verdict.reason, clock.monotonic() + AGAIN_S
        if verdict.stands:
            self._attested, reason = None, verdict.reason
            self.changes.put(lambda _queue: QueueStood(reason))
        return None

    def _evidence(self) -> Evidence | None:
        found, first = self._found, self.queue.next
        if found is None or first is None:
            return None
        checks: tuple[Check, ...] = (Check("recipe", False, "; ".join(found.what.problems)),)
        if not found.what.problems:
            checks = evidence_of(self.desk, found.what, self._attested, self._busy())
        return Evidence(found.item, found.revision, checks, clock.monotonic() - found.at_s)

    def taken(self, item: QueueItem, then: Callable[[str], None]) -> None:
        """Put on record that an item begins. ``then``: as for a change."""
        assert self.changes is not None
        self.changes.put(lambda _queue: ItemTaken(item.id), then)

    def began(self, item: QueueItem, run: str) -> None:
        """Put on record that an item's run has its folder."""
        assert self.changes is not None
        self.changes.put(lambda _queue: ItemBegan(item.id, run))

    def returned(self, item: QueueItem, reason: str) -> None:
        """Put on record that an item's run did not begin."""
        assert self.changes is not None
        self._wait = ""
        self.changes.put(lambda _queue: ItemReturned(item.id, reason))

    def ended(self, item: QueueItem, end: End, reason: str, run: str, *, stands: bool) -> None:
        """Put on record how an item ended."""
        assert self.changes is not None
        self._attested, self._wait = None, ""  # from now on the last scan is the evidence
        self.changes.put(lambda _queue: ItemEnded(item.id, end, reason, run, stands))

    def recipe(self, item: QueueItem) -> str:
        """Return the path of the recipe that an item's run reads."""
        return str(run_recipe(item_folder(self.folder, item.id)))

    def _publish(self) -> None:
        """Send the queue if it has changed."""
        self._news.publish(self.queue, self._broken(), self._wait or self._busy())

    def _broken(self) -> str:
        return self.problem or (self.changes.broken if self.changes is not None else "")

