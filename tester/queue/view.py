"""The queue as clients see it: the message ``queue``, and what `tester queue list` prints."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Final

from tester.queue.fold import Queue, QueueEntry
from tester.queue.items import End, ItemState, PersonAsk, Unanswered
from tester.queue.predict import Times, beginning, planned, predicted

OVER_SHOWN: Final = 20
"""Number of items that are over in a view, the newest."""


@dataclass(frozen=True, slots=True)
class ItemView:
    """An item. Durations in s of wall time; ``start_utc`` and the ends are predicted, "" for an item that is over or
    skipped, or does not begin before the queue stands. 95 % of queues end it between ``end_low_utc`` and
    ``end_high_utc``. ``asks``: questions to a person, s after the item's start.
    """

    id: int
    name: str
    state: ItemState
    by: str
    utc: str
    sha256: str
    origin: str
    conditions: int
    seconds: float
    low_s: float
    high_s: float
    asks: tuple[PersonAsk, ...]
    after: tuple[End, ...]
    end: End | None = None
    reason: str = ""
    run: str = ""
    began_utc: str = ""
    ended_utc: str = ""
    start_utc: str = ""
    end_utc: str = ""
    end_low_utc: str = ""
    end_high_utc: str = ""
    operator: str = ""
    overrides: tuple[str, ...] = ()
    left_s: float | None = None
    """Seconds to the end of the item under way; None for others, and while unknown."""
    unanswered: Unanswered | None = None
    """What ends a question that a person does not answer; None: it waits as long as it takes."""


@dataclass(frozen=True, slots=True)
class QueueView:
    """The queue. ``going``: the next item begins by itself; ``state``: what the queue does or waits for, in words,
    never empty. Predicted times count from ``at_utc``; if the queue is not going, from a start at that time.

    ``items``: those that are over first, then in order. ``problem``: why the record cannot be used, "" if it can.
    """

    revision: int
    going: bool
    state: str
    at_utc: str
    items: tuple[ItemView, ...] = ()
    end_utc: str = ""
    end_low_utc: str = ""
    end_high_utc: str = ""
    problem: str = ""
    until_utc: str = ""
    """No item begins that may not have ended by then; "" for no limit."""

    @property
    def listed(self) -> tuple[ItemView, ...]:
        """The items that are not over."""
        return tuple(item for item in self.items if not item.state.over)


def view_of(queue: Queue, state: str, now_utc: str, left_s: float | None = None, problem: str = "") -> QueueView:
    """Return the view of a queue. ``now_utc``: ISO 8601 with a time zone; ``left_s``: as for ``planned``."""
    now, items_to_come = datetime.fromisoformat(now_utc), planned(queue, left_s)
    foreseen = predicted(items_to_come)
    if queue.until_utc:
        until_s = (datetime.fromisoformat(queue.until_utc) - now).total_seconds()
        foreseen = beginning(items_to_come, foreseen, until_s)
    times = {one.id: one for one in foreseen}
    over = [entry for entry in queue.entries if entry.state.over][-OVER_SHOWN:]
    items = tuple(_item(entry, times.get(entry.item.id), now, left_s) for entry in (*over, *queue.listed))
    last = max(times.values(), key=lambda one: one.end_s, default=None)
    end, low, high = _ends(last, now)
    return QueueView(
        queue.revision, queue.going, state or "unknown", now_utc, items, end, low, high, problem, queue.until_utc
    )


def _item(entry: QueueEntry, times: Times | None, now: datetime, left_s: float | None) -> ItemView:
    item, needs = entry.item, entry.item.needs
    start = "" if times is None else entry.began_utc or stamp(now, times.start_s)
    end, low, high = _ends(times, now)
    return ItemView(
        item.id, item.name, entry.state, item.by, item.utc, item.sha256, item.origin, needs.conditions,
        round(needs.seconds, 1), round(needs.low_s, 1), round(needs.high_s, 1), needs.asks, item.after, entry.end,
        entry.reason, entry.run, entry.began_utc, entry.ended_utc, start, end, low, high, item.operator, item.overrides,
        left_s if entry.state.under_way else None, item.unanswered,
    )  # fmt: skip


def _ends(times: Times | None, now: datetime) -> tuple[str, str, str]:
    if times is None:
        return "", "", ""
    return stamp(now, times.end_s), stamp(now, times.low_s), stamp(now, times.high_s)


def next_ask(view: QueueView) -> tuple[str, str] | None:
    """Return when the first item that waits will ask a person, and what; None if none will.

    While the queue stands with items that wait, a person is needed from ``at_utc`` on to start it. A question of the
    item under way is left to its run, which knows it better.
    """
    waiting = [item for item in view.listed if item.state is ItemState.WAITING]
    if not view.going:
        return (view.at_utc, f"the queue waits for a person: {view.state}") if waiting else None
    for item in waiting:
        if item.asks and item.start_utc:
            at_utc = stamp(datetime.fromisoformat(item.start_utc), item.asks[0].at_s)
            return at_utc, f"item {item.id}, {item.name}: {item.asks[0].text}"
    return None


def stamp(now: datetime, seconds: float) -> str:
    """Return the time ``seconds`` after ``now``, to the nearest second, as ISO 8601 text in UTC."""
    return (now + timedelta(seconds=seconds + 0.5)).astimezone(UTC).isoformat(timespec="seconds").replace("+00:00", "Z")
