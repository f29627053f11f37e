"""A person at the rig: a question comes only once the rig is safe; the run resumes only once the person has left."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.process_image import NAN
from tester.kinds.wheel_on_belt.procedures.lift_check import loaded
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Turn
from tester.kinds.wheel_on_belt.procedures.thermal_steps import CoolDown
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED, TOUCH
from tester.machine.motions import Ask, Move, Power, Sequence
from tester.machine.prompts import DONE, Prompt

STILL_WARM_K: Final = 5.0
"""Greatest rise of a stopped hub's reading over that while turning without a warning, K [A]."""
PROOF_S: Final = 20.0
"""Time for which the heater's contactor is closed without output, s [A]: "heater stuck" takes 16 s, a relay that sticks
may do so every eight."""
NO_HEAT_C: Final = -40.0
"""Demand of a surface temperature at which the jacket gets its least setpoint, degC: colder than any room."""


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


class FreeWheel(Move):
    """Wait until the load cell, without tare, shows a free wheel: a person may have left it on the belt."""

    limit_s = 30.0  # [A]; a person may still touch the wheel
    name = "waiting for a load cell that shows a free wheel"

    def step(self, ctx: Context) -> bool:
        """Done when a fresh reading is within the limit for an unloaded cell."""
        r = ctx.readings
        fresh = r.cell_valid and r.now_s - r.cell_at_s <= ctx.rig.interlocks.speeds_old_s
        shown = [value + zero for value, zero in zip(r.cell, ctx.cell.tare, strict=True)]
        return fresh and not loaded(shown, ctx.rig)


class HeaterProof:
    """Close the heater's contactor with no output, while the wheel turns slowly and unloaded.

    A relay that has welded, or sticks, then heats the hub, and "heater stuck" trips; behind the open contactor it would
    show only after the contactor also welds. Afterwards "contactor welded" trips unless the contactor opens again.
    """

    def __init__(self, creep_m_s: float) -> None:
        """``creep_m_s``: speed of both lines."""
        self.moves = Sequence(Power(True), Lift(), Turn(creep_m_s, creep_m_s))
        self.turning = False
        self.closed_s = self.open_s = inf
        """Time since which the contactor has been closed, or open although heat is demanded."""

    def resume(self, ctx: Context) -> None:
        """Prove it again."""
        self.moves.resume(ctx)
        self.closed_s = self.open_s = inf

    def step(self, ctx: Context) -> bool:
        """Done when the contactor has been closed for PROOF_S, or has stayed open for so long: no heat passes it."""
        if not self.turning:
            self.turning = self.moves.step(ctx)
            return False
        ctx.progress.phase = "heater off before a person comes near"
        ctx.demand.surface_c, ctx.demand.freeze_heat = NO_HEAT_C, False
        closed = ctx.readings.contactor_closed
        self.closed_s = min(self.closed_s, ctx.now) if closed else inf
        self.open_s = inf if closed else min(self.open_s, ctx.now)
        if ctx.now - min(self.closed_s, self.open_s) < PROOF_S:
            return False
        ctx.demand.surface_c = NAN
        return True


class AskAtRest:
    """Ask a question about the wheel once it is cool enough, lifted and standing, with heat and drives off.

    A hot wheel keeps turning slowly, unloaded, until its hub may be touched, or reached with a tool: a standing wheel
    would bake in one spot.
    After heat the heater's relay and contactor are proved before the wheel stands.
    """

    def __init__(self, text: str, hub_below_c: float = TOUCH.hub_below_c, *, unit: str = "") -> None:
        """``text``: the question; ``hub_below_c``: hub temperature from which it is put, degC, above that of a touch
        only for a tool that keeps hands off the wheel; ``unit``: of a quantity that it asks for."""
        self.text = text
        self.unit = unit
        self.by_itself = DONE
        """The answer without a person."""
        self.cool = Cool(INSERTED, hub_below_c)
        self.moves: list[CoolDown | HeaterProof | Sequence] = []
        self.ask: Ask | None = None
        self.answered = False
        self.free = Sequence(FreeWheel())

    def resume(self, ctx: Context) -> None:
        """Resume cooling, or stopping."""
        self.free.resume(ctx)
        for move in self.moves:
            move.resume(ctx)

    def step(self, ctx: Context) -> bool:
        """Done when it is answered, the person has gone and the wheel is free."""
        ctx.demand.surface_c = NAN  # HeaterProof alone demands another
        if self.ask is None:
            if not self._at_rest(ctx):
                return False
            self.ask = Ask(self._question(ctx), unit=self.unit)
            self.ask.by_itself = self.by_itself
        self.answered = self.answered or self.ask.step(ctx)
        return self.answered and self.free.step(ctx)

    def prompt(self, ctx: Context) -> Prompt:
        """Return the question as it was last put; only after it has been."""
        assert self.ask is not None
        return self.ask.prompt(ctx)

    def _at_rest(self, ctx: Context) -> bool:
        if not self.moves:
            creep_m_s = ctx.rig.interlocks.cooldown_speed_m_s
            if not ctx.readings.hub_c < self.cool.hub_below_c:
                self.moves.append(CoolDown(self.cool, creep_m_s))
            if ctx.heat.put_j > 0.0:
                self.moves.append(HeaterProof(creep_m_s))
            self.moves.append(_stand())
        if self.moves[0].step(ctx):
            self.moves.pop(0)
        return not self.moves

    def _question(self, ctx: Context) -> str:
        hub_c, most_c = ctx.readings.hub_c, self.cool.hub_below_c
        by_tool = most_c > TOUCH.hub_below_c
        if hub_c < (TOUCH.hub_below_c if by_tool else most_c + STILL_WARM_K):
            return self.text
        if hub_c < most_c + STILL_WARM_K:
            return f"{self.text} (HOT: the hub is at {hub_c:.0f} degC; with the tool only, keep your hands off)"
        return f"{self.text} (do not touch: the hub is still at {hub_c:.0f} degC)"


def _stand() -> Sequence:
    return Sequence(Lift(), Turn(0.0, 0.0), Power(False), Standing())
