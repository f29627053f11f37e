"""The queue and its night check in lines for people."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import datetime
from typing import TYPE_CHECKING

from tester.base.words import counted, rough_duration

if TYPE_CHECKING:
    from tester.queue.check import NightCheck
    from tester.queue.view import ItemView, QueueView


def local(utc: str) -> str:
    """Return a time as weekday, hour and minute in this computer's zone; "" for none."""
    return datetime.fromisoformat(utc).astimezone().strftime("%a %H:%M") if utc else ""


def queue_lines(view: QueueView) -> Iterator[str]:
    """Yield the queue: its state, then a line for each item."""
    yield f"queue    {view.state}"
    for item in view.items:
        yield _item_line(item)
    if view.end_utc:
        start = "" if view.going else ", if it starts now"
        yield f"end      {_expected(view.end_utc, view.end_low_utc, view.end_high_utc)}{start}"


def _item_line(item: ItemView) -> str:
    what = f"{item.id:>4}  {item.end.value if item.end is not None else item.state.value:<8}  {item.name}"
    what += f", {counted(item.conditions, 'condition')}, {rough_duration(item.seconds)}"
    if item.state.over:
        why = f": {item.reason}" if item.reason else ""
        return f"{what}{why}" + (f"  ({item.run})" if item.run else "")
    if item.end_utc:
        what += f", ends {_expected(item.end_utc, item.end_low_utc, item.end_high_utc)}"
    asks = f", asks {counted(len(item.asks), 'time')}" if item.asks else ""
    return f"{what}{asks}, added by {item.by}" + (f": {item.reason}" if item.reason else "")


def _expected(at: str, low: str, high: str) -> str:
    return f"{local(at)} ({local(low)} to {local(high)})"


def check_lines(found: NightCheck) -> Iterator[str]:
    """Yield the night check in lines."""
    yield f"window   {local(found.from_utc)} to {local(found.to_utc)}"
    if found.standing:
        yield f"queue    {found.standing}; the check counts from a start at the window's begin"
    alone = _expected(found.alone_until_utc, found.alone_low_utc, found.alone_high_utc)
    yield f"alone    until {alone}: {found.because}"
    for one in found.needed:
        yield f"person   {_expected(one.at_utc, one.low_utc, one.high_utc)}: item {one.item} ({one.name}): {one.text}"
    if found.better is not None:
        moves = "; ".join(
            f"item {item} before item {before}" if before else f"item {item} to the end"
            for item, before in found.better.moves
        )
        until = local(found.better.alone_until_utc)
        yield f"order    {moves} would run alone until {until} ({rough_duration(found.better.gain_s)} longer)"
    yield "result   " + ("runs alone to the end of the window" if found.covered else "does not fill the window alone")
