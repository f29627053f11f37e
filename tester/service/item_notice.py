"""Words for the notice of an item's end: how it ended, and what the queue does next."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from tester.queue.fold import Queue, goes_on
from tester.queue.items import End
from tester.queue.recover import end_of
from tester.service.notifier import ItemEnd
from tester.service.state_view import RunView
from tester.store.run_folders import RunStatus

BEGINS: Final = "item {next} begins once the rig is checked"
EMPTY: Final = "the queue is empty; nothing begins"
HOLDS: Final = "the queue waits for a person; nothing begins by itself"
LOOK: Final = "see why, then `tester queue start`"
READ: Final = "look at the results (`tester show {run}`)"


def item_end(queue: Queue, view: RunView, *, latched: bool) -> ItemEnd | None:
    """Return the words for the end of a run; None for a run that the queue has not begun."""
    entry = queue.under_way
    if entry is None or entry.run != view.name:
        return None
    end = end_of(RunStatus(view.outcome))
    title = f"item {entry.item.id} of the queue, {entry.item.name}: {end.value}"
    text = title + (f": {view.reason}" if view.reason else "")
    if not (queue.going and goes_on(replace(entry, end=end), stands=latched)):
        return ItemEnd(text, HOLDS, LOOK)
    todo = READ.format(run=view.name) if end is End.DONE else f"see why: `tester show {view.name}`"
    follows = EMPTY if queue.next is None else BEGINS.format(next=queue.next.item.id)
    return ItemEnd(text, follows, todo)
