"""The queue as the fold of its events: pure functions."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Final

from tester.base.trouble import TroubleError
from tester.base.words import counted
from tester.queue.events import (
    ItemAdded,
    ItemAgreed,
    ItemBegan,
    ItemDropped,
    ItemEnded,
    ItemMoved,
    ItemReturned,
    ItemSkipped,
    ItemTaken,
    QueueEvent,
    QueueLine,
    QueueStarted,
)
from tester.queue.items import MAY_GO_ON, End, Hashes, ItemState, QueueItem

MOST_WAITING: Final = 200
"""Greatest number of items that wait or are skipped [A]: months of work; a prediction of them takes milliseconds."""
MOST_COPIES: Final = 50
"""Greatest number of copies of an item that one command adds [A]."""
AT_END: Final = "it came to its end"
NEVER_STARTED: Final = "not started yet"


class QueueError(TroubleError):
    """A change that the queue refuses; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class QueueEntry:
    """An item in the queue. ``run``: its run's name, "" before it has one; ``skip``: who skipped it, else ""."""

    item: QueueItem
    state: ItemState = ItemState.WAITING
    hashes: Hashes | None = None
    """What a person agreed to since the item was added; None: the item's own count."""
    run: str = ""
    began_utc: str = ""
    ended_utc: str = ""
    end: End | None = None
    reason: str = ""
    skip: str = ""

    @property
    def agreed(self) -> Hashes:
        """The hashes with which the item may run."""
        return self.hashes if self.hashes is not None else self.item.hashes


@dataclass(frozen=True, slots=True)
class Queue:
    """The queue. ``revision`` counts its events; ``going``: whether the next item may begin, else ``why`` not.

    ``entries``: first those that are over, as they ended; then the item under way; then those that wait, in order.
    """

    revision: int = 0
    going: bool = False
    why: str = NEVER_STARTED
    utc: str = ""
    """Time of the newest event."""
    until_utc: str = ""
    """Time by which every item has to end while the queue runs; "" for no limit."""
    entries: tuple[QueueEntry, ...] = ()

    def entry(self, number: int) -> QueueEntry:
        """Return the entry of an item; raises QueueError."""
        for entry in self.entries:
            if entry.item.id == number:
                return entry
        raise QueueError(f"the queue has no item {number}: {self._known()}")

    @property
    def under_way(self) -> QueueEntry | None:
        """The item that has the rig."""
        return next((entry for entry in self.entries if entry.state.under_way), None)

    @property
    def next(self) -> QueueEntry | None:
        """The first item that waits."""
        return next((entry for entry in self.entries if entry.state is ItemState.WAITING), None)

    @property
    def listed(self) -> tuple[QueueEntry, ...]:
        """The items that are not over, in order."""
        return tuple(entry for entry in self.entries if not entry.state.over)

    @property
    def next_id(self) -> int:
        """Number of the next item to be added."""
        return 1 + max((entry.item.id for entry in self.entries), default=0)

    def _known(self) -> str:
        numbers = [str(entry.item.id) for entry in self.listed]
        return f"it lists {', '.join(numbers)}" if numbers else "it is empty"


def fold(events: Iterable[QueueLine]) -> Queue:
    """Return the queue of all events, oldest first; raises QueueError if one of them is impossible."""
    queue = Queue()
    for event in events:
        queue = applied(queue, event)
    return queue


def check_revision(queue: Queue, revision: int) -> None:
    """Raise QueueError if a change was made for another state of the queue."""
    if revision != queue.revision:
        raise QueueError(f"the queue changed meanwhile (revision {queue.revision}, not {revision}): look at it again")


def applied(queue: Queue, recorded: QueueLine) -> Queue:
    """Return the queue after one more event; raises QueueError if it is impossible now."""
    if recorded.n != queue.revision + 1:
        raise QueueError(f"event {recorded.n} does not follow event {queue.revision}")
    what = recorded.what
    changed = _CHANGES.get(type(what), _stood)(queue, what, recorded.utc)
    if changed.going and changed.under_way is None and changed.next is None:
        changed = replace(changed, going=False, why=AT_END)  # an item added later must not begin by being added
    if not changed.going:
        changed = replace(changed, until_utc="")
    return replace(changed, revision=recorded.n, utc=recorded.utc)


def _added(queue: Queue, what: ItemAdded, utc: str) -> Queue:
    item = what.item
    if item.id != queue.next_id:
        raise QueueError(f"the next item is number {queue.next_id}, not {item.id}")
    if not 1 <= what.copies <= MOST_COPIES:
        raise QueueError(f"{what.copies} copies: expected 1 to {MOST_COPIES}")
    if len(queue.listed) + what.copies > MOST_WAITING:
        raise QueueError(f"the queue is full: it holds {counted(MOST_WAITING, 'item')}")
    if wrong := [end.value for end in item.after if end not in MAY_GO_ON]:
        raise QueueError(f"after {', '.join(wrong)} the queue always stands: expected done, short or failed")
    if what.copies == 1:
        return replace(queue, entries=(*queue.entries, QueueEntry(item)))
    copies = (QueueEntry(_copy(item, number, what.copies)) for number in range(what.copies))
    return replace(queue, entries=(*queue.entries, *copies))


def _copy(item: QueueItem, number: int, copies: int) -> QueueItem:
    """Return a copy: on a simulated rig with the next seed, as the same one would give the same run again."""
    name = f"{item.name} ({number + 1} of {copies})"
    return replace(item, id=item.id + number, name=name, seed=item.seed + number if item.simulated else item.seed)


def _moved(queue: Queue, what: ItemMoved, utc: str) -> Queue:
    entry = _pending(queue, what.id, "moved")
    entry = replace(entry, state=ItemState.WAITING, skip="")
    rest = [other for other in queue.entries if other.item.id != what.id]
    if what.before == 0:
        return replace(queue, entries=(*rest, entry))
    if what.before == what.id:
        raise QueueError(f"item {what.id} cannot go before itself")
    before = _pending(queue, what.before, "an item's place")
    at = next(place for place, other in enumerate(rest) if other.item.id == before.item.id)
    return replace(queue, entries=(*rest[:at], entry, *rest[at:]))


def _skipped(queue: Queue, what: ItemSkipped, utc: str) -> Queue:
    entry = queue.entry(what.id)
    if entry.state is ItemState.WAITING:
        return _with(queue, replace(entry, state=ItemState.SKIPPED, skip=what.by))
    if entry.state.under_way and not entry.skip:
        return _with(queue, replace(entry, skip=what.by))
    raise QueueError(f"item {what.id} is {_words(entry)}: it cannot be skipped")


def _dropped(queue: Queue, what: ItemDropped, utc: str) -> Queue:
    entry = _pending(queue, what.id, "dropped")
    gone = replace(entry, state=ItemState.DROPPED, reason=f"dropped by {what.by}", ended_utc=utc)
    return _over(queue, gone)


def _agreed(queue: Queue, what: ItemAgreed, utc: str) -> Queue:
    return _with(queue, replace(_pending(queue, what.id, "agreed to"), hashes=what.hashes))


def _taken(queue: Queue, what: ItemTaken, utc: str) -> Queue:
    first = queue.next
    if not queue.going:
        raise QueueError(f"the queue stands: {queue.why}")
    if queue.under_way is not None:
        raise QueueError(f"item {queue.under_way.item.id} is under way")
    if first is None or first.item.id != what.id:
        raise QueueError(f"item {what.id} is not the next one")
    return _with(queue, replace(first, state=ItemState.STARTING, began_utc=utc, reason=""))


def _began(queue: Queue, what: ItemBegan, utc: str) -> Queue:
    entry = queue.entry(what.id)
    if entry.state is not ItemState.STARTING:
        raise QueueError(f"item {what.id} is {_words(entry)}: it does not begin now")
    return _with(queue, replace(entry, state=ItemState.RUNNING, run=what.run, began_utc=utc))


def _returned(queue: Queue, what: ItemReturned, utc: str) -> Queue:
    entry = queue.entry(what.id)
    if entry.state is not ItemState.STARTING:
        raise QueueError(f"item {what.id} is {_words(entry)}: it cannot go back")
    state = ItemState.SKIPPED if entry.skip else ItemState.WAITING
    queue = _with(queue, replace(entry, state=state, began_utc="", reason=what.reason))
    if entry.skip:
        return queue
    return replace(queue, going=False, why=f"item {what.id} did not begin: {what.reason}")


def _ended(queue: Queue, what: ItemEnded, utc: str) -> Queue:
    entry = queue.entry(what.id)
    if not entry.state.under_way:
        raise QueueError(f"item {what.id} is {_words(entry)}: it cannot end now")
    over = replace(entry, state=ItemState.ENDED, end=what.end, reason=what.reason, run=what.run, ended_utc=utc)
    queue = _over(queue, over)
    if goes_on(over, stands=what.stands):
        return queue
    because = f": {what.reason}" if what.reason else ""
    return replace(queue, going=False, why=f"item {what.id} {_ENDED[what.end]}{because}")


def goes_on(entry: QueueEntry, *, stands: bool) -> bool:
    """Return whether the queue continues after an ended item. ``stands``: nothing may loosen that it stands."""
    if stands or entry.end is None or entry.end is End.TRIPPED:
        return False
    return bool(entry.skip) if entry.end is End.STOPPED else entry.end in entry.item.after


def _started(queue: Queue, what: QueueStarted, utc: str) -> Queue:
    if queue.going:
        raise QueueError("the queue is started already")
    if queue.next is None:
        raise QueueError("no item waits: add one, or move one that is skipped")
    return replace(queue, going=True, why="", until_utc=what.until_utc)


def _stood(queue: Queue, what: QueueEvent, utc: str) -> Queue:
    reason = str(getattr(what, "reason", ""))
    if not reason:
        raise QueueError("the queue stands only with a reason")
    return replace(queue, going=False, why=reason)


_CHANGES: Final[dict[type[QueueEvent], Callable[..., Queue]]] = {
    ItemAdded: _added,
    ItemMoved: _moved,
    ItemSkipped: _skipped,
    ItemDropped: _dropped,
    ItemAgreed: _agreed,
    ItemTaken: _taken,
    ItemBegan: _began,
    ItemReturned: _returned,
    ItemEnded: _ended,
    QueueStarted: _started,
}
_ENDED: Final = {
    End.DONE: "is done",
    End.SHORT: "came out short",
    End.FAILED: "failed",
    End.TRIPPED: "tripped",
    End.STOPPED: "was stopped",
}


def _pending(queue: Queue, number: int, what: str) -> QueueEntry:
    """Return an item that waits or is skipped; raises QueueError."""
    entry = queue.entry(number)
    if entry.state not in (ItemState.WAITING, ItemState.SKIPPED):
        raise QueueError(f"item {number} is {_words(entry)}: it cannot be {what}")
    return entry


def _words(entry: QueueEntry) -> str:
    return entry.end.value if entry.end is not None else entry.state.value


def _with(queue: Queue, entry: QueueEntry) -> Queue:
    """Return the queue with an entry in the place of the one with its number."""
    same = entry.item.id
    return replace(queue, entries=tuple(entry if other.item.id == same else other for other in queue.entries))


def _over(queue: Queue, entry: QueueEntry) -> Queue:
    """Return the queue with an entry that is over, after those that were over before it."""
    rest = [other for other in queue.entries if other.item.id != entry.item.id]
    at = sum(other.state.over for other in rest)
    return replace(queue, entries=(*rest[:at], entry, *rest[at:]))
