"""Items and records for tests of the queue."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256

from tester.base.screen import Check
from tester.queue.decide import NEEDED, Evidence
from tester.queue.events import QueueEvent, QueueLine
from tester.queue.fold import Queue, applied
from tester.queue.items import GO_ON, End, Hashes, Needs, PersonAsk, QueueItem

UTC = "2024-02-21T18:00:00.000Z"
HASHES = Hashes("aa", "bb", (("compound 1#", "cc"),))


def item(
    number: int,
    *,
    name: str = "",
    seconds: float = 3600.0,
    share: float = 0.1,
    asks: tuple[PersonAsk, ...] = (),
    after: tuple[End, ...] = GO_ON,
    speed: float | None = 1.0,
) -> QueueItem:
    """Return an item; ``share``: half its range of time, as a share of ``seconds``."""
    text = f"recipe: {name or f'recipe {number}'}\n"
    needs = Needs(seconds, (1.0 - share) * seconds, (1.0 + share) * seconds, 4, 1_000_000, 0.4, 1, asks)
    return QueueItem(
        number, name or f"recipe {number}", text, sha256(text.encode()).hexdigest(), "", "a rig", True, HASHES, needs,
        "anna", UTC, after=after, speed=speed,
    )  # fmt: skip


def queue_of(*events: QueueEvent, start: Queue | None = None) -> Queue:
    """Return the queue after events."""
    queue = start or Queue()
    for event in events:
        queue = applied(queue, QueueLine(queue.revision + 1, UTC, event))
    return queue


def evidence_for(queue: Queue, *, lacks: str = "", fails: str = "", age_s: float = 1.0) -> Evidence:
    """Return evidence that lets the next item begin, except for one missing or failed check."""
    first = queue.next
    checks: Iterable[Check] = (Check(name, name != fails, "as it must be") for name in NEEDED if name != lacks)
    return Evidence(first.item.id if first is not None else 0, queue.revision, tuple(checks), age_s)
