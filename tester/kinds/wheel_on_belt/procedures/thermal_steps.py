"""Steps that wait for a temperature: soak, heat, rest, cool."""

from __future__ import annotations

from math import isfinite, nan
from typing import Final, NamedTuple

from tester.inputs.recipe.plan import Soak
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, Turn, Yaw, near, straight
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, Rest
from tester.kinds.wheel_on_belt.run.past_runs import KIND, LEAST_J, LEAST_RISE_K, heating_data
from tester.machine.activity import Activity
from tester.machine.motions import Ask, Power, Sequence
from tester.machine.soak import SHOW_S, SoakWait
from tester.machine.trend import TemperatureTrend

NEAR_AMBIENT_K: Final = 3.0
"""A setpoint within this of ambient is reached slowly, by heating or cooling: the soak only reaches the band [A]."""
HEAT_LOAD_N: Final = 200.0
"""Highest load for heating up in rolling contact [A]: the paper's reference load."""
HEAT_AT_MOST_S: Final = 5400.0
"""Longest time of heating up to a temperature [A]."""
COOL_AT_MOST_S: Final = 3 * 3600.0
"""Longest cooling of a hub for a person's touch; a prompt then shows its temperature [A]."""


def roll(wheel_speed_m_s: float, load_n: float) -> Sequence:
    """Return the moves into rolling contact: drives on, straight, matched speeds, load; little friction heat."""
    return Sequence(Power(True), Straighten(), Turn(wheel_speed_m_s, wheel_speed_m_s), Load(load_n))


class Straighten:
    """Bring the positioned axes to zero; lift first if they are not at zero."""

    def __init__(self) -> None:
        """Begin without data before the first scan."""
        self.moves: Sequence | None = None

    def step(self, ctx: Context) -> bool:
        """Done when all are zero."""
        if self.moves is None:
            r = ctx.readings
            self.moves = Sequence(Yaw()) if near(r, straight(r)) else Sequence(Lift(), Yaw())
        return self.moves.step(ctx)


def soak_within_k(soak: Soak, setpoint_c: float, ambient_c: float, band_k: float) -> float:
    """Return the tolerance of a soak, K: the recipe's value, or the band near ambient."""
    return band_k if abs(setpoint_c - ambient_c) <= NEAR_AMBIENT_K else soak.within_k


class SoakTo(SoakWait):
    """The wait for the surface's temperature."""

    def step(self, ctx: Context) -> bool:
        """Done when soaked or given up; ``reached`` shows which."""
        ctx.demand.surface_c = self.target_c
        ctx.demand.freeze_heat = False
        return self.over(ctx, "soak", ctx.gates.surface.slow_c)


class HeatUp:
    """Bring the surface near a temperature in rolling contact, so that conditions at it only need a soak."""

    def __init__(self, step: Heat, wheel_speed_m_s: float, load_n: float, within_k: float, offset_k: float) -> None:
        """``offset_k``: distance of rolling below the setpoint (slip pulses then rise through the setpoint)."""
        self.target_c = step.temperature_c
        self.soak = SoakTo(step.temperature_c - offset_k, within_k, 0.0, HEAT_AT_MOST_S)
        self.rolling_at = (wheel_speed_m_s, min(load_n, HEAT_LOAD_N))
        self.moves = roll(*self.rolling_at)
        self.rolling = False
        self.start: _Heat | None = None

    def resume(self, ctx: Context) -> None:
        """Touch and roll again."""
        self.moves = roll(*self.rolling_at)
        self.rolling = False
        self.start = None

    def step(self, ctx: Context) -> bool:
        """Done when near enough, or out of time."""
        ctx.demand.surface_c = self.soak.target_c
        ctx.demand.freeze_heat = False
        if not self.rolling:
            self.rolling = self.moves.step(ctx)
            if self.rolling:
                self.start = _heat(ctx)
            return False
        if not self.soak.step(ctx):
            return False
        if not self.soak.reached:
            ctx.journal.event(ctx.now, "heat", f"{self.target_c:g} degC not reached in time", "warning")
        else:
            self._note_balance(ctx)
        return True

    def _note_balance(self, ctx: Context) -> None:
        """Record this heating as evidence on ``observer.thermal``: heat put in over heat shown, if it is large enough.

        A heating with a hold, or with a person at the wheel, is not comparable and not recorded. Later runs use the
        event's data as evidence (tester.kinds.wheel_on_belt.run.past_runs).
        """
        start, end = self.start, _heat(ctx)
        if start is None or end is None or start.begun != end.begun:
            return
        put_j, shown_j, rise_k = end.put_j - start.put_j, end.shown_j - start.shown_j, end.hub_c - start.hub_c
        if shown_j >= LEAST_J and rise_k >= LEAST_RISE_K:
            text = f"heat balance: {1e-3 * put_j:.1f} kJ put in, {put_j / shown_j:.2f} of what the temperatures show"
            ctx.journal.event(ctx.now, KIND, text, data=heating_data(ctx.rig, put_j, shown_j, rise_k))


class _Heat(NamedTuple):
    """The heat balance at a time: heat put in and shown, J, since its ``begun``-th restart, and the hub, degC."""

    begun: int
    put_j: float
    shown_j: float
    hub_c: float


def _heat(ctx: Context) -> _Heat | None:
    heat, r = ctx.heat, ctx.readings
    if not r.jacket_valid:
        return None
    return _Heat(heat.begun, heat.put_j, heat.shown_j, r.hub_c)


class RestStep:
    """Stand lifted, with heat and drives off, for a time and until the surface is cool."""

    def __init__(self, step: Rest, *, ask_when_late: bool) -> None:
        """``ask_when_late``: a real rig asks a person once the longest time is over."""
        self.rest = step
        self.moves = Sequence(Lift(), Turn(0.0, 0.0), Power(False))
        self.standing = False
        self.began_s = nan
        self.shown_s = float("-inf")
        self.late: Activity[Context] | None = None
        self.ask_when_late = ask_when_late
        self.trend = TemperatureTrend()

    def resume(self, ctx: Context) -> None:
        """Resume standing, or stopping."""
        self.moves.resume(ctx)

    def step(self, ctx: Context) -> bool:
        """Done when rested."""
        ctx.demand.surface_c = nan
        if not self.standing:
            self.standing = self.moves.step(ctx)
            return False
        if not isfinite(self.began_s):
            self.began_s = ctx.now
        waited = ctx.now - self.began_s
        surface, until = ctx.readings.surface_c, self.rest.until_c
        self.trend.follow(surface)
        if ctx.now >= self.shown_s:
            self.shown_s = ctx.now + SHOW_S
            minutes = f"{waited / 60:.0f} of {self.rest.at_least_s / 60:.0f} min"
            ctx.progress.phase = f"rest {minutes}, surface {surface:.1f} degC"
        # Resting only cools: a surface colder than `until`, in a cold laboratory, is no reason to wait.
        cool = until is None or surface <= until + self.rest.within_k
        if waited >= self.rest.at_least_s and cool:
            ctx.wheel.size_up(ctx.readings, ctx.rig.wear)
            return True
        if waited < self.rest.at_most_s:
            return False
        if self.late is None:
            text = f"after {waited / 60:.0f} min of rest the surface is at {surface:.1f} degC, not at {until} degC"
            ctx.journal.event(ctx.now, "rest", f"not reached: {text}", "warning")
            self.late = Ask(f"{text}: go on?", near=False) if self.ask_when_late else Sequence()
        return self.late.step(ctx)

    def waits_s(self, ctx: Context) -> float:
        """Return the rig time for which the rest surely continues, s: its least time, then while the surface is far
        from cool.
        """
        waited, until = ctx.now - self.began_s, self.rest.until_c
        if not waited >= self.rest.at_least_s:
            return self.rest.at_least_s - waited if isfinite(waited) else 0.0
        warm = until is not None and self.trend.far(self.trend.last_c - until - self.rest.within_k)
        return self.rest.at_most_s - waited if warm and self.late is None else 0.0


class CoolDown:
    """Turn unloaded, with heat off, until the hub is cool enough to touch."""

    def __init__(self, step: Cool, creep_m_s: float) -> None:
        """``creep_m_s``: line speed while cooling."""
        self.below_c = step.hub_below_c
        self.moves = Sequence(Power(True), Lift(), Turn(creep_m_s, creep_m_s))
        self.turning = False
        self.began_s = nan
        self.shown_s = float("-inf")
        self.trend = TemperatureTrend()

    def resume(self, ctx: Context) -> None:
        """Resume turning, or starting to turn."""
        self.moves.resume(ctx)

    def step(self, ctx: Context) -> bool:
        """Done when cool, or out of time (the following prompt to install shows the temperature)."""
        ctx.demand.surface_c = nan
        if not self.turning:
            self.turning = self.moves.step(ctx)
            return False
        if not isfinite(self.began_s):
            self.began_s = ctx.now
        if ctx.now >= self.shown_s:
            self.shown_s = ctx.now + SHOW_S
            ctx.progress.phase = f"cool to {self.below_c:.0f} degC, hub {ctx.readings.hub_c:.1f} degC"
        self.trend.follow(ctx.readings.hub_c)
        over = ctx.readings.hub_c < self.below_c or ctx.now - self.began_s > COOL_AT_MOST_S
        if over:
            ctx.wheel.size_up(ctx.readings, ctx.rig.wear)
        return over

    def waits_s(self, ctx: Context) -> float:
        """Return the rig time for which the hub surely stays too hot, s."""
        hot = self.turning and self.trend.far(self.trend.last_c - self.below_c)
        return COOL_AT_MOST_S - (ctx.now - self.began_s) if hot else 0.0
