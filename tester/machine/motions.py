"""Motions of any machine: sequences, drives on and off, waiting, asking, zeroing a cell. Each is stepped once a scan.

An activity's ``step`` writes the demand it needs and returns True in the scan in which it is done. It keeps its state
in plain attributes, so that a running activity can be copied.
"""

from __future__ import annotations

from collections.abc import Collection
from math import inf, isfinite, nan
from typing import Any, Final

from tester.machine.activity import Activity, MoveFailedError
from tester.machine.context import AnyContext
from tester.machine.prompts import DONE, Prompt
from tester.machine.safety_inputs import InputStates

GUARD_OPEN: Final = "answered with the guard or a door open: close it, then the question is put again"
AGAIN: Final = "the guard is closed now, go on?"


class Move:
    """An activity with a time limit."""

    limit_s: float = inf
    """Longest time the move may take, s."""
    name: str = "move"


class Sequence:
    """Activities one after another; a move among them that exceeds its time limit raises MoveFailedError."""

    def __init__(self, *parts: Activity[Any]) -> None:
        """Take the parts in order."""
        self.parts = list(parts)
        self.since_s = float("nan")

    def resume(self, ctx: AnyContext) -> None:
        """Resume after a hold: restart the time limit of the current part."""
        self.since_s = float("nan")

    def step(self, ctx: AnyContext) -> bool:
        """Step the current part."""
        if not self.parts:
            return True
        part = self.parts[0]
        if not isfinite(self.since_s):
            self.since_s = ctx.now
        if part.step(ctx):
            self.parts.pop(0)
            self.since_s = float("nan")
        elif isinstance(part, Move) and ctx.now - self.since_s > part.limit_s:
            raise MoveFailedError(f"{part.name} not done after {part.limit_s:g} s")
        return not self.parts


class Power(Move):
    """Switches the drives on or off, and waits until they confirm it."""

    limit_s = 20.0  # [A]; a drive needs well under a second
    name = "switching the drives"

    def __init__(self, on: bool) -> None:
        """``on``: whether the drives are to be on."""
        self.on = on

    def step(self, ctx: AnyContext) -> bool:
        """Return True when every drive has confirmed."""
        ctx.demand.enabled = self.on
        ctx.moving = True
        return ctx.readings.drives_enabled if self.on else ctx.readings.drives_disabled


class Ask:
    """Asks a question and waits for the answer.

    It moves nothing: the activity before it has made it safe to come near. An answer counts only while the guard, and
    every door among the safety inputs, is closed. After an answer with one open the question is asked again, so that
    closing it starts nothing.
    """

    def __init__(self, text: str, *, near: bool = True, unit: str = "") -> None:
        """``text``: the question; ``near``: whether it asks a person to come near the machine; ``unit``: of a quantity
        that it asks for.
        """
        self.text = text
        self.near = near
        self.unit = unit
        self.by_itself = DONE
        """The answer without a person, from the activity that knows a better one."""
        self.number = 0
        self.record = 0
        self.recorded = False

    def step(self, ctx: AnyContext) -> bool:
        """Return True once the question is answered; journal question and answer."""
        if not self.number:
            self._put(ctx, self.text)
        asked = self.prompt(ctx)
        answer = asked.answer
        alone = ctx.prompts.answers_itself(near=self.near)
        ctx.demand.attended = not alone
        if answer is None:
            return False
        # With automatic answers no person closes the guard: an open guard is a fault, which trips when the next drive
        # is switched on.
        r = ctx.readings
        closed = alone or (r.guard_closed and not InputStates(ctx.rig).open_door(r.channels))
        if not self.recorded:
            self.recorded = True
            ctx.journal.prompt_answered(self.record, ctx.now, answer, asked.by)
            if closed:
                ctx.demand.attended = False
                return True
            ctx.progress.phase = GUARD_OPEN
        elif closed:
            self._put(ctx, f"{self.text}: {AGAIN}")
        return False

    def prompt(self, ctx: AnyContext) -> Prompt:
        """Return the question as it was last put."""
        return ctx.prompts.asked[self.number - 1]

    def _put(self, ctx: AnyContext, text: str) -> None:
        asked = ctx.prompts.ask(ctx.now, text, near=self.near, unit=self.unit, by_itself=self.by_itself)
        self.number = asked.number
        self.record = ctx.journal.prompt(ctx.now, text)
        self.recorded = False


class Settle:
    """Waits at the fast scan rate for ``seconds``."""

    def __init__(self, seconds: float) -> None:
        """``seconds``: duration of the wait."""
        self.seconds = seconds
        self.left_s = seconds

    def step(self, ctx: AnyContext) -> bool:
        """Return True when the time is over."""
        ctx.moving = True
        self.left_s -= ctx.dt
        return self.left_s <= 0.0


LEAST: Final = 10
"""Smallest number of readings that a zero averages."""
SILENT_S: Final = 5.0
"""A zero that still lacks readings this long after its averaging time is abandoned, s [A]."""


class ZeroOfCell:
    """Averages readings over a time. A kind's activity inherits from it; its ``step`` decides whether to take the
    zero.
    """

    def __init__(self, seconds: float, name: str = "load cell") -> None:
        """``seconds``: averaging time; ``name``: the sensor's name for people."""
        self.seconds = seconds
        self.name = name
        self.began_s: float = nan
        self.stamp_s: float = -inf
        self.sums: list[float] = []
        self.count = 0
        self.failed = ""
        """Why the zero is not trustworthy; "" if it is."""

    def step(self, ctx: Any) -> bool:
        """Return True when the zero is taken, or ``failed`` is set."""
        raise NotImplementedError

    def averaged(self, ctx: AnyContext, at_s: float, values: Collection[float], *, valid: bool) -> bool:
        """Add the reading taken at ``at_s``; return whether there are enough. Set ``failed`` if readings do not
        arrive.
        """
        ctx.moving = True
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        if valid and at_s > self.stamp_s and at_s > self.began_s:
            self.stamp_s = at_s
            before = self.sums or [0.0] * len(values)
            self.sums = [total + value for total, value in zip(before, values, strict=True)]
            self.count += 1
        late_s = ctx.now - self.began_s - self.seconds
        if late_s >= 0.0 and self.count >= LEAST:
            return True
        if late_s > SILENT_S:
            self.failed = f"the {self.name} gave {self.count} valid readings in {ctx.now - self.began_s:.0f} s"
        return False

    def zero(self, tare: Collection[float]) -> tuple[float, ...]:
        """Return the zero in the cell's own readings: the mean, with the present ``tare`` added back."""
        return tuple(old + total / self.count for old, total in zip(tare, self.sums, strict=True))
