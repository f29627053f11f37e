"""A person at the rig: a question comes only once the rig is safe; the run resumes only once the person has left."""

from __future__ import annotations

from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import NAN
from tester.kinds.wheel_on_belt.procedures.lift_check import loaded
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Turn
from tester.kinds.wheel_on_belt.procedures.thermal_steps import CoolDown
from tester.kinds.wheel_on_belt.recipe.wheel_change import TOUCH
from tester.machine.activity import Activity
from tester.machine.motions import Ask, Move, Power, Sequence

STILL_WARM_K: Final = 5.0
"""Greatest rise of a stopped hub's reading over that while turning without a warning, K [A]."""


class Standing(Move):
    """Wait until wheel and belt stand, no drive applies torque and the heater's contactor is open."""

    limit_s = 10.0  # [A]; drives that are off stop much sooner
    name = "coming to a stand for a person to go near"

    def step(self, ctx: Context) -> bool:
        """Done when all these states are measured, not just commanded."""
        r = ctx.readings
        ctx.moving = True
        still_m_s = ctx.rig.interlocks.standing_m_s
        return (
            r.drives_disabled
            and abs(r.wheel_speed_m_s) <= still_m_s
            and abs(r.belt_speed_m_s) <= still_m_s
            and not r.contactor_closed
        )


class Free(Move):
    """Wait until the load cell, without tare, shows a free wheel: a person may have left it on the belt."""

    limit_s = 30.0  # [A]; a person may still touch the wheel
    name = "waiting for a load cell that shows a free wheel"

    def step(self, ctx: Context) -> bool:
        """Done when a fresh reading is within the limit for an unloaded cell."""
        r = ctx.readings
        fresh = r.cell_valid and r.now_s - r.cell_at_s <= ctx.rig.interlocks.speeds_old_s
        shown = [value + zero for value, zero in zip(r.cell, ctx.cell.tare, strict=True)]
        return fresh and not loaded(shown, ctx.rig)


class AskAtRest:
    """Ask a question about the wheel once it is cool enough to touch, lifted and standing, with heat and drives off.

    A hot wheel keeps turning slowly, unloaded, until its hub may be touched: a standing wheel would bake in one spot.
    """

    def __init__(self, text: str) -> None:
        """Store the question's text for the person."""
        self.text = text
        self.cool: CoolDown | None = None
        self.moves: Activity[Context] = Sequence()
        self.ask: Ask | None = None
        self.answered = False
        self.free = Sequence(Free())

    def resume(self, ctx: Context) -> None:
        """Resume cooling, or stopping."""
        self.free.resume(ctx)
        if isinstance(self.moves, CoolDown | Sequence):
            self.moves.resume(ctx)

    def step(self, ctx: Context) -> bool:
        """Done when it is answered, the person has gone and the wheel is free."""
        ctx.demand.surface_c = NAN
        if self.ask is None:
            if not self._at_rest(ctx):
                return False
            self.ask = Ask(self._question(ctx))
        self.answered = self.answered or self.ask.step(ctx)
        return self.answered and self.free.step(ctx)

    def _at_rest(self, ctx: Context) -> bool:
        if self.cool is None:
            self.cool = CoolDown(TOUCH, ctx.rig.interlocks.cooldown_speed_m_s)
            touchable = ctx.readings.hub_c < TOUCH.hub_below_c
            self.moves = _stand() if touchable else self.cool
        if not self.moves.step(ctx):
            return False
        if self.moves is not self.cool:
            return True
        self.moves = _stand()
        return False

    def _question(self, ctx: Context) -> str:
        hub_c = ctx.readings.hub_c
        if hub_c < TOUCH.hub_below_c + STILL_WARM_K:
            return self.text
        return f"{self.text} (do not touch: the hub is still at {hub_c:.0f} degC)"


def _stand() -> Sequence:
    return Sequence(Lift(), Turn(0.0, 0.0), Power(False), Standing())
