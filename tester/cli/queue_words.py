"""The queue and its night check in lines for people."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from tester.base.words import counted, local_hour, rough_duration

if TYPE_CHECKING:
    from tester.queue.check import NightCheck
    from tester.queue.view import ItemView, QueueView


def queue_lines(view: QueueView) -> Iterator[str]:
    """Yield the queue: its state, then a line for each item."""
    yield f"queue    {view.state}"
    for item in view.items:
        yield _item_line(item)
    if view.end_utc:
        start = "" if view.going else ", if it starts now"
        yield f"end      {_expected(view.end_utc, view.end_low_utc, view.end_high_utc)}{start}"
    if view.until_utc:
        yield f"until    {local_hour(view.until_utc)}: no item begins that may last longer"


def _item_line(item: ItemView) -> str:
    what = f"{item.id:>4}  {item.end.value if item.end is not None else item.state.value:<8}  {item.name}"
    what += f", {counted(item.conditions, 'condition')}, {rough_duration(item.seconds)}"
    if item.state.over:
        why = f": {item.reason}" if item.reason else ""
        return f"{what}{why}" + (f"  ({item.run})" if item.run else "")
    if item.end_utc:
        what += f", ends {_expected(item.end_utc, item.end_low_utc, item.end_high_utc)}"
    asks = f", asks {counted(len(item.asks), 'time')}" if item.asks else ""
    if item.asks and item.unanswered is not None:
        asks += f", {item.unanswered.words()}"
    return f"{what}{asks}, added by {item.by}" + (f": {item.reason}" if item.reason else "")


def _expected(at: str, low: str, high: str) -> str:
    return f"{local_hour(at)} ({local_hour(low)} to {local_hour(high)})"


def check_lines(found: NightCheck) -> Iterator[str]:
    """Yield the night check in lines."""
    yield f"window   {local_hour(found.from_utc)} to {local_hour(found.to_utc)}"
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
        until = local_hour(found.better.alone_until_utc)
        yield f"order    {moves} would run alone until {until} ({rough_duration(found.better.gain_s)} longer)"
    yield "result   " + ("runs alone to the end of the window" if found.covered else "does not fill the window alone")
