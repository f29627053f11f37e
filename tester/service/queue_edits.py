"""Clients' changes of the queue as events of its record: pure functions, called with the queue as it is on the disk."""

from __future__ import annotations

from tester.base import clock
from tester.queue.assess import Assessment
from tester.queue.events import ItemAdded, ItemDropped, ItemMoved, ItemSkipped, QueueEvent, QueueStood
from tester.queue.fold import Queue, QueueError, check_revision
from tester.queue.items import End, QueueItem, Unanswered
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueOrder, QueueSkip


def stood(queue: Queue, by: str) -> QueueEvent:
    """Return the event that stops a running queue; raises QueueError if it does not run."""
    if not queue.going:
        raise QueueError("the queue is not running")
    return QueueStood(by)


def edited(queue: Queue, action: QueueOrder, by: str) -> QueueEvent:
    """Return the event of a change of one item; raises QueueError if the queue has changed since its sender saw it."""
    assert isinstance(action, QueueMove | QueueSkip | QueueDrop)
    check_revision(queue, action.revision)
    if isinstance(action, QueueMove):
        return ItemMoved(action.id, action.before, by)
    return ItemSkipped(action.id, by) if isinstance(action, QueueSkip) else ItemDropped(action.id, by)


def added(queue: Queue, action: QueueAdd, found: Assessment, by: str) -> ItemAdded:
    """Return the event that adds an item, or copies of it. ``found``: what a look at its recipe has found."""
    unanswered = None
    if action.answer_within_s is not None:
        unanswered = Unanswered(action.answer_within_s, action.unanswered == "skip")
    item = QueueItem(
        queue.next_id, found.name, found.text, found.sha256, found.origin, found.rig, found.simulated, found.hashes,
        found.needs, by, clock.utc_now(), action.overrides, action.seed, action.speed, action.yes, action.operator,
        action.notes, tuple(End(end) for end in action.after), unanswered,
    )  # fmt: skip
    return ItemAdded(item, action.copies)
