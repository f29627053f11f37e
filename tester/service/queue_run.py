"""An item of the queue as a run: its options, its note, its work."""

from __future__ import annotations

from collections.abc import Callable

from tester.queue.assess import same_rig
from tester.queue.fold import QueueEntry
from tester.queue.items import QueueItem
from tester.run.session_options import SessionOptions
from tester.service.queue_desk import QueueRig
from tester.service.running import ServiceSession


def options_of(item: QueueItem, rig: QueueRig, recipe: str) -> SessionOptions:
    """Return the options of an item's run; ``recipe``: the path that it reads."""
    overrides = (*rig.overrides, *item.overrides)
    who = item.operator or item.by
    return SessionOptions(recipe, rig.rig, overrides, rig.accept_risk, rig.runs, item.seed, item.speed, operator=who)


def note_of(item: QueueItem) -> str:
    """Return the note for the record of an item's run."""
    return "; ".join(text for text in (item.notes, f"item {item.id} of the queue, added by {item.by}") if text)


def work_of(entry: QueueEntry) -> Callable[[ServiceSession], int]:
    """Return the work of an item's run: it begins only on the rig that was looked at, which is read again."""

    def work(session: ServiceSession) -> int:
        session.accepts = lambda plan: same_rig(entry.agreed, plan.work.rig)
        return session.run()

    return work
