"""What became of an item that was under way when its service ended: its run tells."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from tester.queue.events import ItemEnded, ItemReturned, QueueEvent, QueueStood
from tester.queue.fold import Queue
from tester.queue.items import End
from tester.queue.places import item_folder, run_recipe
from tester.results.run_results import results_of
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, run_folders
from tester.store.run_reader import RunReader

NEWEST: Final = 50
"""Number of newest runs in which to search for an item's run [A]: the item was the last that the service began."""
SAME: Final = 5
"""Last parts of a recipe's path that name the item: the folder of the runs may have moved."""
ANEW: Final = "the service was started anew"

_ENDS: Final = {
    RunStatus.DONE: End.DONE,
    RunStatus.INCOMPLETE: End.SHORT,
    RunStatus.TRIPPED: End.TRIPPED,
    RunStatus.STOPPED: End.STOPPED,
    RunStatus.INTERRUPTED: End.STOPPED,
}


def end_of(status: RunStatus) -> End:
    """Return how an item ended whose run has this status."""
    return _ENDS.get(status, End.FAILED)


def recovery(queue: Queue, folder: Path, runs: Path) -> Iterator[QueueEvent]:
    """Yield the events with which a queue begins after its service ended: the item under way is over or waits again,
    and the queue stands. ``folder``: the queue's.
    """
    entry = queue.under_way
    if entry is not None:
        found = run_of(folder, entry.item.id, runs)
        if found is None and not entry.run:
            yield ItemReturned(entry.item.id, "the service ended before its run began")
            return
        name, status, reason = found or (entry.run, RunStatus.FAILED, "its run cannot be found")
        if status is RunStatus.INTERRUPTED:
            reason = f"the service ended while it ran: `tester resume {name}` continues it"
        yield ItemEnded(entry.item.id, end_of(status), reason, name, stands=True)
    elif queue.going:
        yield QueueStood(ANEW)


def run_of(folder: Path, item: int, runs: Path) -> tuple[str, RunStatus, str] | None:
    """Return name, status and reason of an item's run; None if it has none."""
    recipe = run_recipe(item_folder(folder, item)).absolute().parts[-SAME:]
    for run in list(run_folders(runs))[: -NEWEST - 1 : -1]:
        with suppress(StoreError, OSError, sqlite3.Error), RunReader(run) as reader:
            if Path(reader.run().info.recipe_source).parts[-SAME:] == recipe:
                results = results_of(reader)
                return run.name, results.status, results.run.reason
    return None
