"""Selects the scans to record: every scan in contact, otherwise two a second."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Final, TypeAlias

from tester.base.quantities import FURTHER, LAST, Quantities
from tester.machine.context import BaseContext
from tester.store.recorder import Recorder

IDLE_PERIOD_S: Final = 0.5
"""Recording period out of contact (2 Hz, interface: exports)."""


Values: TypeAlias = Callable[[BaseContext[Any, Any, Any]], tuple[float, ...]]
"""Function that reads values from the context of a run."""


def values_at(sources: Sequence[str], *more: str) -> Values:
    """Return a function that reads the values at these sources (``Channel.source``), in order.

    It is one expression, written as text: calls, even in C, take three times as long in every scan. ``more``: further
    items of that expression, of the context ``ctx``.
    """
    holders: dict[str, str] = {}
    items: list[str] = []
    for source in sources:
        path, bracket, key = source.partition("[")
        holder, _, name = (path, "", "") if bracket else path.rpartition(".")
        place = holders.setdefault(holder, f"holder_{len(holders)}") if holder else "ctx"
        items.append(f"{place}[{key[:-1]!r}]" if bracket else f"{place}.{name}")
    lines = [f" {place} = ctx.{holder}" for holder, place in holders.items()]
    names: dict[str, Any] = {}
    exec("\n".join(("def values(ctx):", *lines, f" return ({', '.join((*items, *more))},)")), names)
    values: Values = names["values"]
    return values


def row_builder(quantities: Quantities) -> Values:
    """Return a function that makes the row of a scan."""
    further = (f"*ctx.{FURTHER}",) if quantities.further else ()
    measured = [channel.source for channel in quantities.recorded]
    last = [f"float(ctx.{source})" for source in measured[-len(LAST) :]]
    return values_at(measured[: -len(LAST) - len(quantities.further)], *further, *last)


class Sampler:
    """Selects scans and records them as rows."""

    def __init__(self, recorder: Recorder, quantities: Quantities) -> None:
        """``recorder``: the run's; ``quantities``: the channels of a row."""
        self.recorder = recorder
        self._row_of = row_builder(quantities)
        self.due_s = float("-inf")

    def record(self, ctx: BaseContext[Any, Any, Any], out: Any) -> None:
        """Record this scan if it is due."""
        if not ctx.touching() and ctx.now < self.due_s:
            return
        self.due_s = ctx.now + IDLE_PERIOD_S
        ctx.setpoints = out
        row_of = self._row_of  # an attribute that is called as a method is looked up anew (CPython 3.11)
        row = row_of(ctx)
        self.recorder.sample(row)
        ctx.sample = row
