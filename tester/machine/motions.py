"""Moves of any machine: one after the other, drives on and off, waiting, asking. Stepped once a scan.

An activity's ``step`` writes the demand it needs and returns True in the scan in which it is done. It keeps its
state in plain attributes: a running activity can be copied.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Any, Final

from tester.machine.activity import Activity, MoveFailedError
from tester.machine.context import AnyContext

GUARD_OPEN: Final = "answered with the guard open: close it, then the question is put again"
AGAIN: Final = "the guard is closed now, go on?"


class Move:
    """An activity that has to end in a time of its own."""

    limit_s: float = inf
    """Longest time the move may take, s."""
    name: str = "move"


class Sequence:
    """Activities one after the other; a move among them that overruns its time raises MoveFailedError."""

    def __init__(self, *parts: Activity[Any]) -> None:
        """Take the parts in order."""
        self.parts = list(parts)
        self.since_s = float("nan")

    def resume(self, ctx: AnyContext) -> None:
        """Give the current part its whole time again."""
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
    """Enable or disable the drives, and wait until they say so."""

    limit_s = 20.0  # [A]; a drive needs well under a second
    name = "switching the drives"

    def __init__(self, on: bool) -> None:
        """``on``: what is wanted."""
        self.on = on

    def step(self, ctx: AnyContext) -> bool:
        """Wait for every drive."""
        ctx.demand.enabled = self.on
        ctx.moving = True
        return ctx.readings.drives_enabled if self.on else ctx.readings.drives_disabled


class Wait:
    """Let time pass (s)."""

    def __init__(self, seconds: float) -> None:
        """How long."""
        self.seconds = seconds
        self.began_s = float("nan")

    def step(self, ctx: AnyContext) -> bool:
        """Done when the time is over."""
        if self.began_s != self.began_s:
            self.began_s = ctx.now
        return ctx.now - self.began_s >= self.seconds - 1e-9


class Ask:
    """Put a question and wait for its answer.

    It moves nothing: whoever asks has brought the rig to where a person may go near. An answer counts with the guard
    closed; one that was given with the guard open is asked for again then, so that closing it starts nothing.
    """

    def __init__(self, text: str, *, near: bool = True) -> None:
        """The question as a person reads it; ``near``: it asks a person to come near the machine."""
        self.text = text
        self.near = near
        self.number = 0
        self.record = 0
        self.heard = False

    def step(self, ctx: AnyContext) -> bool:
        """Done when it is answered; question and answer are journalled."""
        if not self.number:
            self._put(ctx, self.text)
        asked = ctx.prompts.asked[self.number - 1]
        answer = asked.answer
        alone = ctx.prompts.answers_itself(near=self.near)
        ctx.demand.attended = not alone
        if answer is None:
            return False
        # Where nobody is asked, an open guard is a fault: it trips with the next drive switched on.
        closed = ctx.readings.guard_closed or alone
        if not self.heard:
            self.heard = True
            ctx.journal.prompt_answered(self.record, ctx.now, answer, asked.by)
            if closed:
                ctx.demand.attended = False
                return True
            ctx.progress.phase = GUARD_OPEN
        elif closed:
            self._put(ctx, f"{self.text}: {AGAIN}")
        return False

    def _put(self, ctx: AnyContext, text: str) -> None:
        self.number = ctx.prompts.ask(ctx.now, text, near=self.near).number
        self.record = ctx.journal.prompt(ctx.now, text)
        self.heard = False


class Settle:
    """Wait at the fast scan rate for ``seconds``."""

    def __init__(self, seconds: float) -> None:
        """How long, s."""
        self.seconds = seconds
        self.left_s = seconds

    def step(self, ctx: AnyContext) -> bool:
        """Done when the time is over."""
        ctx.moving = True
        self.left_s -= ctx.dt
        return self.left_s <= 0.0
