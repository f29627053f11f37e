"""Selects the scans to record: every scan in contact, otherwise two a second."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from itertools import groupby
from operator import attrgetter, itemgetter
from typing import Any, Final, TypeAlias

from tester.base.quantities import LAST, Quantities
from tester.machine.context import BaseContext
from tester.store.recorder import Recorder

IDLE_PERIOD_S: Final = 0.5
"""Recording period out of contact (2 Hz, interface: exports)."""


Values: TypeAlias = Callable[[BaseContext[Any, Any, Any]], tuple[float, ...]]
"""Function that reads values from the context of a run."""


def values_at(sources: Sequence[str]) -> Values:
    """Return a function that reads the values at these sources (``Channel.source``), in order.

    It makes one call in C for each sequence of attributes, or of keys of the same mapping.
    """
    parts = [_stretch(holder, list(stretch)) for holder, stretch in groupby(sources, _holder)]
    return reduce(_joined, parts)


def _holder(source: str) -> str:
    """Return the mapping that contains a source; "" for an attribute."""
    holder, bracket, _ = source.partition("[")
    return holder if bracket else ""


def _stretch(holder: str, sources: list[str]) -> Values:
    if not holder:
        return _tuple_of(attrgetter(*sources), len(sources))
    keys = [source[len(holder) + 1 : -1] for source in sources]
    mapping, taken = attrgetter(holder), _tuple_of(itemgetter(*keys), len(keys))
    return lambda ctx: taken(mapping(ctx))


def _tuple_of(getter: Callable[[Any], Any], count: int) -> Callable[[Any], tuple[float, ...]]:
    return getter if count > 1 else lambda one: (getter(one),)


def _joined(first: Values, then: Values) -> Values:
    return lambda ctx: first(ctx) + then(ctx)


def row_builder(quantities: Quantities) -> Values:
    """Return a function that makes the row of a scan, without its last three channels."""
    recorded = values_at([c.source for c in quantities.recorded[: -len(LAST) - len(quantities.further)]])
    if not quantities.further:
        return recorded
    return lambda ctx: (*recorded(ctx), *ctx.readings.channels)


class Sampler:
    """Selects scans and records them as rows."""

    def __init__(self, recorder: Recorder, quantities: Quantities) -> None:
        """``recorder``: the run's; ``quantities``: the channels of a row."""
        self.recorder = recorder
        self._measured = row_builder(quantities)
        self.due_s = float("-inf")

    def record(self, ctx: BaseContext[Any, Any, Any], out: Any) -> None:
        """Record this scan if it is due."""
        if not ctx.touching() and ctx.now < self.due_s:
            return
        self.due_s = ctx.now + IDLE_PERIOD_S
        ctx.setpoints = out
        row = (*self._measured(ctx), float(ctx.gate), float(ctx.burst), float(ctx.repeat_key))
        self.recorder.sample(row)
        ctx.sample = row
