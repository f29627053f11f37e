"""Manual mode: a person moves the rig in bounded steps. Control's limits and interlocks apply as in a run.

A terminal cannot detect a released key, so a key press is one step, and no motion continues by itself. The mode ends by
itself after a minute without a key press, and when the client that armed it is gone.
"""

from __future__ import annotations

from math import isfinite
from typing import Any, Final

from tester.inputs.recipe.plan import Plan
from tester.machine.context import AnyContext
from tester.machine.executor import Executor, Procedures
from tester.machine.hand import Hand

NAME: Final = "manual mode"
ARMED_S: Final = 60.0
"""Manual mode disarms after this long without a step."""
STEPS_PER_S: Final = 5.0
"""More key presses a second are refused [A]: an auto-repeating key makes 30."""
MOVING_S: Final = 2.0
"""After a step scans come at the sliding rate for this long, s [A]."""


class ManualExecutor(Executor[Any]):
    """Replaces the executor: its demand follows a person's requests."""

    def __init__(self, hand: Hand) -> None:
        """Begin with the drives enabled, at rest and lifted."""
        super().__init__(Plan(NAME, (), (), 1), Procedures())
        self.hand = hand
        self.used_s = float("nan")
        self.pressed_s = float("-inf")
        self.moved_s = float("-inf")

    def left_s(self, now: float) -> float:
        """Return for how many seconds the mode still stays armed."""
        return ARMED_S if not isfinite(self.used_s) else max(ARMED_S - (now - self.used_s), 0.0)

    def step(self, ctx: AnyContext) -> None:
        """Write the demand; the run ends after a minute without a request."""
        if not isfinite(self.used_s):
            self.used_s = ctx.now
            ctx.progress.title = NAME
        self.expire(ctx.now)
        if self.finished:
            return
        ctx.demand.enabled = True
        ctx.moving = ctx.now - self.moved_s < MOVING_S
        self.hand.follow(ctx)

    def expire(self, now: float) -> None:
        """End the mode after a minute without a request, even in a hold."""
        if self.left_s(now) <= 0.0:
            self.disarm()

    def disarm(self) -> None:
        """End the mode: a controlled stop follows."""
        self.finished = True

    # -- requests ---------------------------------------------------------------------------------------------

    def jog(self, ctx: AnyContext, axis: str, direction: int) -> str:
        """Take one step; return "", or the reason for refusing."""
        refusal = self._busy(ctx)
        if refusal:
            return refusal
        if ctx.now - self.pressed_s < 1.0 / STEPS_PER_S:
            return f"no more than {STEPS_PER_S:g} steps a second"
        refusal = self.hand.step(ctx, axis, float(direction))
        if not refusal:
            self.used_s = self.pressed_s = self.moved_s = ctx.now
        return refusal

    def tare(self, ctx: AnyContext) -> str:
        """Begin a tare; return "", or the reason for refusing."""
        refusal = self._busy(ctx) or self.hand.tare(ctx)
        if not refusal:
            self.used_s = ctx.now
        return refusal

    def _busy(self, ctx: AnyContext) -> str:
        return self.hand.busy if ctx.readings.drives_enabled else "the drives are not on yet"
