"""The check of a night: until when the queue runs alone, when it needs a person, which order would run longer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, time, timedelta
from math import hypot
from typing import Final

from tester.base.words import local_hour
from tester.queue.items import ItemState
from tester.queue.predict import BETWEEN_S
from tester.queue.view import ItemView, QueueView, stamp

LONGER_S: Final = 300.0
"""Least gain of another order that is offered, s [A]: less is within the estimate's spread."""
MOST_ROUNDS: Final = 20
"""Greatest number of moves that are tried one after another for a better order."""
MOST_ORDERED: Final = 30
"""Number of items, the next ones, among which a better order is looked for [A]: more than a week-end of work."""


@dataclass(frozen=True, slots=True)
class Needed:
    """A person is needed: for which item and what, when it is expected, and the interval of 95 %."""

    item: int
    name: str
    text: str
    at_utc: str
    low_utc: str
    high_utc: str


@dataclass(frozen=True, slots=True)
class BetterOrder:
    """An order that runs alone for longer. ``moves``: item and the item before which it goes (0: the end), in turn."""

    order: tuple[int, ...]
    moves: tuple[tuple[int, int], ...]
    alone_until_utc: str
    gain_s: float


@dataclass(frozen=True, slots=True)
class NightCheck:
    """The check of a window. ``alone_until_utc``: when the queue first needs a person after ``from_utc``, or is at its
    end, with the interval of 95 %; ``because``: which of both, in words. ``needed``: the questions in the window, as if
    each is answered at once. ``covered``: whether the queue needs no person and has work to the end of the window.
    """

    from_utc: str
    to_utc: str
    alone_until_utc: str
    alone_low_utc: str
    alone_high_utc: str
    because: str
    covered: bool
    end_utc: str
    needed: tuple[Needed, ...] = ()
    better: BetterOrder | None = None
    standing: str = ""
    """Why the queue does not go on by itself now, "" if it does: the check then counts from a start at ``from_utc``."""


@dataclass(frozen=True, slots=True)
class _Mark:
    """A moment, s after now, with half the range of 95 % before and after it."""

    item: ItemView | None
    text: str
    at_s: float
    sooner_s: float
    later_s: float


def window(start: str, end: str, now_utc: str) -> tuple[datetime, datetime]:
    """Return the next window between two times of day, HH:MM, in this computer's time zone; it may have begun.

    Raises ValueError for other texts.
    """
    now = datetime.fromisoformat(now_utc).astimezone()
    begins, ends = (_today(text, now) for text in (start, end))
    if ends <= begins:
        ends += timedelta(days=1)
        if now < ends - timedelta(days=1):  # within a window that began yesterday
            begins, ends = begins - timedelta(days=1), ends - timedelta(days=1)
    if ends <= now:
        begins, ends = begins + timedelta(days=1), ends + timedelta(days=1)
    return begins, ends


def following(text: str, now_utc: str) -> str:
    """Return the next time at which the clock of this computer's zone shows HH:MM, as ISO 8601 text in UTC."""
    now = datetime.fromisoformat(now_utc).astimezone()
    at = _today(text, now)
    return stamp(at if at > now else at + timedelta(days=1), 0.0)


def time_of_day(text: str) -> time:
    """Return a time of day, HH:MM; raises ValueError for other texts."""
    try:
        return datetime.strptime(text, "%H:%M").time()
    except ValueError:
        raise ValueError(f'expected a time of day such as 18:00, got "{text}"') from None


def _today(text: str, now: datetime) -> datetime:
    at = time_of_day(text)
    return now.replace(hour=at.hour, minute=at.minute, second=0, microsecond=0)


def night_check(view: QueueView, now_utc: str, begins: datetime, ends: datetime) -> NightCheck:
    """Return the check of a window; a queue that is not going is taken to start when the window begins."""
    now = datetime.fromisoformat(now_utc)
    from_s, to_s = ((moment - now).total_seconds() for moment in (begins, ends))
    start_s = 0.0 if view.going else max(from_s, 0.0)
    items = [item for item in view.listed if item.state is not ItemState.SKIPPED]
    from_s = max(from_s, 0.0)
    beginning = [item for item in items if item.end_utc] if view.until_utc else items
    first, asks, end = _alone(beginning, start_s, from_s)
    if len(beginning) < len(items):
        text = f"item {items[len(beginning)].id} may last beyond {local_hour(view.until_utc)}, and does not begin"
        first, end = (replace(mark, text=text) if mark is end else mark for mark in (first, end))
    better = _better(items, start_s, from_s, to_s, first.at_s, now) if not view.until_utc else None
    needed = [
        Needed(ask.item.id, ask.item.name, ask.text, *_around(ask, now))
        for ask in asks
        if ask.item is not None and from_s <= ask.at_s <= to_s
    ]
    name = f"item {first.item.id} ({first.item.name}) asks: " if first.item is not None else ""
    at, low, high = _around(first, now)
    return NightCheck(
        stamp(begins, 0.0), stamp(ends, 0.0), at, low, high, f"{name}{first.text}", first.at_s >= to_s,
        stamp(now, end.at_s), tuple(needed), better, "" if view.going else view.state,
    )  # fmt: skip


def _around(mark: _Mark, now: datetime) -> tuple[str, str, str]:
    low_s = max(mark.at_s - mark.sooner_s, 0.0)
    return stamp(now, mark.at_s), stamp(now, low_s), stamp(now, mark.at_s + mark.later_s)


def _alone(items: Sequence[ItemView], start_s: float, from_s: float) -> tuple[_Mark, list[_Mark], _Mark]:
    """Return the first moment after ``from_s`` at which work needs a person or ends, every question, and the end."""
    asks: list[_Mark] = []
    at_s, sooner_s, later_s = start_s, 0.0, 0.0
    for place, item in enumerate(items):
        left_s = item.seconds if item.left_s is None else item.left_s
        begun_s = at_s + left_s - item.seconds if item.left_s is not None else at_s + (BETWEEN_S if place else 0.0)
        below_s, above_s = item.seconds - item.low_s, item.high_s - item.seconds
        for ask in item.asks:
            if begun_s + ask.at_s >= at_s or item.left_s is None:
                share = ask.at_s / item.seconds if item.seconds else 0.0
                spread = hypot(sooner_s, share * below_s), hypot(later_s, share * above_s)
                asks.append(_Mark(item, ask.text, begun_s + ask.at_s, *spread))
        at_s = begun_s + item.seconds
        share = left_s / item.seconds if item.seconds else 1.0
        sooner_s, later_s = hypot(sooner_s, share * below_s), hypot(later_s, share * above_s)
    end = _Mark(None, "the queue is at its end" if items else "the queue is empty", at_s, sooner_s, later_s)
    return next((ask for ask in asks if ask.at_s > from_s), end), asks, end


def _first_s(items: Sequence[ItemView], start_s: float, from_s: float) -> float:
    """Return the first moment of ``_alone`` without its spread, quickly: a better order takes thousands of them."""
    at_s = start_s
    for place, item in enumerate(items):
        left_s = item.seconds if item.left_s is None else item.left_s
        begun_s = at_s + left_s - item.seconds if item.left_s is not None else at_s + (BETWEEN_S if place else 0.0)
        for ask in item.asks:
            if begun_s + ask.at_s > from_s and (item.left_s is None or begun_s + ask.at_s >= at_s):
                return begun_s + ask.at_s
        at_s = begun_s + item.seconds
    return at_s


def _better(
    items: Sequence[ItemView], start_s: float, from_s: float, to_s: float, now_alone_s: float, now: datetime
) -> BetterOrder | None:
    """Return the order found by moving one item at a time, the best move first; None if none gains ``LONGER_S``."""
    order, moves, best_s = list(items[:MOST_ORDERED]), list[tuple[int, int]](), now_alone_s
    behind = items[MOST_ORDERED:]
    for _ in range(MOST_ROUNDS):
        found: tuple[float, list[ItemView], tuple[int, int]] | None = None
        for item in reversed(order):
            if item.state is not ItemState.WAITING:
                continue
            rest = [other for other in order if other.id != item.id]
            fixed = sum(other.state is not ItemState.WAITING for other in rest)
            for at in range(fixed, len(rest) + 1):
                tried = [*rest[:at], item, *rest[at:]]
                alone_s = _first_s([*tried, *behind], start_s, from_s)
                if alone_s > (found[0] if found else best_s) + 1.0:
                    found = alone_s, tried, (item.id, rest[at].id if at < len(rest) else behind[0].id if behind else 0)
        if found is None or best_s >= to_s:
            break
        best_s, order = found[0], found[1]
        moves.append(found[2])
    if best_s - now_alone_s < LONGER_S:
        return None
    numbers = tuple(item.id for item in (*order, *items[MOST_ORDERED:]))
    return BetterOrder(numbers, tuple(moves), stamp(now, best_s), round(best_s - now_alone_s, 1))
