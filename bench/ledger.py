"""Time by part: the running part is charged until another takes over."""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from typing import Any

from bench.stopwatch import wall_ns

PARTS = (
    "plant",
    "nodes: drives",
    "nodes: drives, on a frame",
    "nodes: Modbus slaves",
    "bus: CAN",
    "bus: Modbus",
    "twin",
    "drivers: receive",
    "drivers: image",
    "drivers: apply",
    "drivers: transmit",
    "control",
    "executor",
    "engine",
    "recorder",
)
"""Parts of a scan's time; the text before a colon is a group."""

_OUTSIDE = len(PARTS)
_TRIALS = 2000
_ROUNDS = 25


class Ledger:
    """Own time in ns of every part, and the number of wrapped calls to and from it, since the last ``take``."""

    __slots__ = ("called", "calls", "inner_ns", "mark", "outer_ns", "part", "times")

    def __init__(self) -> None:
        """Determine the cost of measuring on this machine."""
        self.inner_ns = self.outer_ns = 0.0
        self._reset()
        self._calibrate()

    def _reset(self) -> None:
        self.times = [0] * (_OUTSIDE + 1)
        self.called = [0] * (_OUTSIDE + 1)
        self.calls = [0] * (_OUTSIDE + 1)
        self.part = _OUTSIDE
        self.mark = wall_ns()

    def wrap(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return a function that does the same and charges its own time to the part ``name``."""
        part = PARTS.index(name)
        book, clock = self, wall_ns

        def measured(*arguments: Any, **named: Any) -> Any:
            t = clock()
            outer = book.part
            book.times[outer] += t - book.mark
            book.calls[outer] += 1
            book.called[part] += 1
            book.part = part
            book.mark = clock()
            try:
                return function(*arguments, **named)
            finally:
                t = clock()
                book.times[part] += t - book.mark
                book.part = outer
                book.mark = clock()

        return measured

    def take(self) -> tuple[float, ...]:
        """Return the us of every part since the last call, without the cost of measuring, and reset."""
        inner, outer = self.inner_ns, self.outer_ns
        found = tuple(
            max(0.0, t - inner * called - outer * calls) * 1e-3
            for t, called, calls in zip(
                self.times[:_OUTSIDE], self.called[:_OUTSIDE], self.calls[:_OUTSIDE], strict=True
            )
        )
        self._reset()
        return found

    def _calibrate(self) -> None:
        """Wrap a function that does nothing: the charge beyond the bare call is the wrapper's."""
        caller, callee = PARTS.index("engine"), PARTS.index("plant")

        def nothing(one: object, two: object) -> None:
            pass

        wrapped = self.wrap("plant", nothing)

        def loop(function: Callable[..., Any]) -> None:
            for _ in range(_TRIALS):
                function(self, None)

        def empty() -> None:
            for _ in range(_TRIALS):
                pass

        timed_loop = self.wrap("engine", loop)
        inner: list[float] = []
        outer: list[float] = []
        for _ in range(_ROUNDS):
            t0 = wall_ns()
            empty()
            t1 = wall_ns()
            loop(nothing)
            t2 = wall_ns()
            self._reset()
            timed_loop(wrapped)
            bare = ((t2 - t1) - (t1 - t0)) / _TRIALS
            inner.append(self.times[callee] / _TRIALS - bare)
            outer.append((self.times[caller] - (t1 - t0)) / _TRIALS)
        self.inner_ns, self.outer_ns = median(inner), median(outer)
        self._reset()
