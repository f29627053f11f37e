"""One repeat: whole revolutions inside the gates, collected in as many bursts as it needs.

Straight running: the wheel stays in rolling contact, and the belt brings the slip in and takes it out again (a slip
pulse). With sideslip there is no matched speed, so every burst lifts, yaws, touches, counts and lifts again
(docs/decisions/0013). Without slip a repeat is one window of rolling.
"""

from __future__ import annotations

from math import isnan
from typing import Final

from tester.analysis.blocks import BlockCounter
from tester.analysis.judge import ALONE
from tester.analysis.reduce import collected
from tester.base.quantities import Quantities
from tester.kinds.wheel_on_belt.context import Context
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.burst_state import FEW_REVOLUTIONS, BurstNotes, CentredBursts, Phase, RunIn
from tester.kinds.wheel_on_belt.procedures.motions import Lift, Load, TakeTare, Turn, Yaw
from tester.kinds.wheel_on_belt.procedures.thermal_steps import roll
from tester.kinds.wheel_on_belt.procedures.zero_check import deeper
from tester.kinds.wheel_on_belt.recipe.constants import COOL_LIFTED_S, LIFT_TO_COOL_S
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelCondition
from tester.machine.measured import Ending
from tester.machine.motions import Power, Sequence, Settle

TARE_S: Final = 1.0
"""Averaging time of the zero before each repeat, s [A]: about three turns."""
TARE_WAIT_S: Final = 0.4
"""Time for the cell to settle after lifting, s [A]."""
TARE_FRESH_S: Final = 110.0
"""Age from which the zero is renewed before the first burst, s: it must be at most 120 s old at the first counted
sample, some seconds later (the cell's zero moves by 0.1 N/K with its temperature).
"""
OFFSET_BEYOND_BAND_K: Final = 1.5
"""Greatest distance of a burst's start below the band, K [A]: it warms up before the first sample counts."""
EMPTY_BURSTS: Final = 3
"""Number of bursts in a row without a whole turn, started as low as possible, that end a condition [A]."""


# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_TARE: Final = Phase.TARE
_ROLL: Final = Phase.ROLL
_READY: Final = Phase.READY
_COOL: Final = Phase.COOL
_MOVE_IN: Final = Phase.MOVE_IN
_RUN_IN: Final = Phase.RUN_IN
_COUNT: Final = Phase.COUNT
_MOVE_OUT: Final = Phase.MOVE_OUT


class MeasureRepeat(CentredBursts):
    """The activity of one repeat."""

    # Slots: CPython 3.11 looks the methods of an object with more than 30 attributes up anew in every scan.
    __slots__ = (
        "cooling_since_s", "moves", "phase", "ready_since_s", "reference", "rolling_since_s", "run_in", "tare",
        "tared_s",
    )  # fmt: skip

    def __init__(
        self,
        step: WheelCondition,
        reference_tare: list[float],
        offset_k: float,
        quantities: Quantities = QUANTITIES,
        *,
        reversed_slip: bool = False,
        run_in_m: float = 0.0,
    ) -> None:
        """``offset_k``: distance of its bursts' start below the setpoint, from the previous repeat; ``quantities``: the
        run's table of channels; ``reversed_slip``: slide with reversed slip; ``run_in_m``: distance to slide before
        samples count."""
        held = held_by(step.setpoint)
        super().__init__(step, held.reversed() if reversed_slip else held, offset_k, BlockCounter(quantities))
        self.run_in = RunIn(run_in_m)
        self.reference = reference_tare
        self.phase = Phase.TARE
        self.moves = Sequence()
        self.tare: TakeTare | None = None
        self.tared_s = float("-inf")
        self.ready_since_s = float("nan")
        """Start of the wait for the next burst; NaN outside a wait."""
        self.rolling_since_s = float("nan")
        self.cooling_since_s = float("nan")

    def step(self, ctx: Context) -> bool:
        """Advance by one scan; done when lifted with ``ending`` set."""
        self._show(ctx)
        phase = self.phase
        if phase is _COUNT:
            self._count(ctx)
        elif phase is _READY:
            self._ready(ctx)
        elif phase is _ROLL:
            self._demand_heat(ctx)
            if self.moves.step(ctx):
                self._to_ready(ctx)
        elif phase is _TARE:
            self._tare(ctx)
        elif phase is _COOL:
            self._cool(ctx)
        elif phase is _MOVE_IN:
            ctx.demand.freeze_heat = True
            if self.moves.step(ctx):
                if self.run_in.left_m > 0.0:
                    self._begin_run_in(ctx)
                else:
                    self._begin_burst(ctx)
        elif phase is _RUN_IN:
            self._run_in(ctx)
        elif phase is _MOVE_OUT:
            if self.moves.step(ctx):
                self._to_ready(ctx)
        elif self.moves.step(ctx):
            return True
        return False

    # -- phases -----------------------------------------------------------------------------------------------

    def _tare(self, ctx: Context) -> None:
        if self.tare is None:
            self.tare = TakeTare(TARE_S, self.reference)
            wheel = self.setpoint.wheel_speed_m_s
            self.moves = Sequence(Power(True), Lift(), Turn(wheel, wheel), Settle(TARE_WAIT_S), self.tare)
        self._demand_heat(ctx)
        if not self.moves.step(ctx):
            return
        if self.tare.failed:
            self._end(ctx, Ending.ZERO_DRIFT, self.tare.failed)
            return
        self.tared_s = ctx.now
        self._roll()

    def _tare_again(self) -> None:
        """Renew the zero after a long wait for the temperature, in which the cell's temperature changed."""
        self.phase = Phase.TARE
        self.tare = None

    def _roll(self) -> None:
        self.phase = Phase.ROLL
        self.moves = roll(self.setpoint.wheel_speed_m_s, self.setpoint.load_n)

    def _to_ready(self, ctx: Context) -> None:
        self.phase = Phase.READY
        if isnan(self.ready_since_s):
            self.ready_since_s = ctx.now
        self.rolling_since_s = ctx.now
        self.mark_s, self.mark_c = ctx.now, float("inf")

    def _ready(self, ctx: Context) -> None:
        self._demand_heat(ctx)
        surface, target = ctx.gates.surface.now_c, self.setpoint.temperature_c
        waited = ctx.now - self.ready_since_s
        if waited > self.condition.soak.at_most_s:
            self._end(ctx, Ending.NOT_REACHED, f"surface at {surface:.1f} degC after {waited / 60:.0f} min")
        elif self._start_now(ctx, surface, target):
            if self.bursts == 0 and ctx.now - self.tared_s > TARE_FRESH_S:
                self._tare_again()
            else:
                self._slip_in()
        elif deeper(ctx):
            self.phase = Phase.ROLL
            self.moves = Sequence(Lift(), roll(self.setpoint.wheel_speed_m_s, self.setpoint.load_n))
        elif surface > target and ctx.now - self.rolling_since_s > LIFT_TO_COOL_S:
            self.phase = Phase.COOL
            self.cooling_since_s = ctx.now
            self.moves = Sequence(Lift())

    def _cool(self, ctx: Context) -> None:
        """Turn lifted until the surface is back at its temperature, then touch again; this time counts as waiting."""
        self._demand_heat(ctx)
        self.moves.step(ctx)
        surface, target = ctx.gates.surface.now_c, self.setpoint.temperature_c
        if surface <= target - self.offset_k or ctx.now - self.cooling_since_s > COOL_LIFTED_S:
            self._roll()

    def _slip_in(self) -> None:
        sp = self.setpoint
        self.phase = Phase.MOVE_IN
        self.ready_since_s = float("nan")
        if self.yawed:
            self.moves = Sequence(
                Lift(),
                Yaw(sp.positions),
                Turn(sp.wheel_speed_m_s, sp.belt_speed_m_s),
                Load(sp.load_n, percent=5.0, for_s=0.0, quick=True),
            )
        else:
            # The belt's ramp is part of the burst: the gates say when samples count.
            self.moves = Sequence()

    def _begin_run_in(self, ctx: Context) -> None:
        """Bring the slip in for a pulse of the run-in: its samples belong to no burst."""
        self.phase = Phase.RUN_IN
        ctx.demand.belt_speed_m_s = self.belt_m_s
        self._aim(ctx)
        self.run_in.pulses += 1

    def _run_in(self, ctx: Context) -> None:
        ctx.moving = True
        run_in = self.run_in
        done = run_in.slide(ctx.readings.slip_m_s * ctx.dt)
        if not done and ctx.gates.surface.now_c < self.target_c + self.band_k:
            return
        if not done and run_in.pulses >= self.condition.max_bursts:
            self._end(ctx, Ending.CANNOT_HOLD, f"{run_in.left_m:.1f} m of run-in left after {run_in.pulses} pulses")
            return
        self._move_out()

    def _begin_burst(self, ctx: Context) -> None:
        self.phase = Phase.COUNT
        self.bursts += 1
        self.burst = BurstNotes(
            ctx.now,
            blocks_before=self.revolutions,
            counted_s=ctx.now,
            sum_before_k=self.surface_sum_k,
            count_before=self.surface_count,
        )
        ctx.burst = self.bursts
        demand = ctx.demand
        demand.freeze_heat = not self.rolling_only
        demand.belt_speed_m_s = self.belt_m_s
        self._aim(ctx)
        self._count(ctx)

    def _count(self, ctx: Context) -> None:
        r, burst = ctx.readings, self.burst
        ctx.moving = not self.rolling_only
        done = self.counter.add(ctx.sample) is not None
        trend = ctx.gates.surface
        surface, rate = trend.now_c, trend.rate_k_s
        if rate > burst.peak_rate_k_s:
            burst.peak_rate_k_s = rate
        if isnan(burst.slid_s) and r.slip_m_s >= 0.5 * self.slip_m_s:
            burst.slid_s, burst.slid_c = ctx.now, r.surface_c
        if ctx.gate == 0:
            if isnan(burst.began_c):
                burst.began_c = surface
            burst.counted_s = ctx.now
            self.surface_sum_k += r.surface_c - self.target_c
            self.surface_count += 1
        if done and self._complete(ctx):
            self._learn_offset(FEW_REVOLUTIONS, self.offset_k)
            self._end(ctx, Ending.COMPLETE, "")
        elif self._burst_over(ctx, surface, rate):
            self._end_burst(ctx)

    def _complete(self, ctx: Context) -> bool:
        """Return whether the repeat is complete; a single repeat must also show that its drift is small."""
        window = self.condition.window
        alone = self.condition.repeats <= ALONE and not self.rolling_only
        return collected(self.counter, window, alone=alone)

    def _end_burst(self, ctx: Context) -> None:
        gained = self.revolutions - self.burst.blocks_before
        ctx.burst = 0
        self.empty = 0 if gained else self.empty + 1
        furthest = self.condition.temperature_band_k + OFFSET_BEYOND_BAND_K
        if self.empty >= EMPTY_BURSTS and self.offset_k >= furthest:
            self._end(ctx, Ending.CANNOT_HOLD, self._band_needed(ctx))
            return
        self._learn_offset(gained, furthest)
        if self.bursts >= self.condition.max_bursts:
            enough = self.revolutions >= (self.condition.window.revolutions or 0.0) and self.revolutions > 0
            self._end(
                ctx,
                Ending.COMPLETE if enough else Ending.CANNOT_HOLD if gained == 0 else Ending.INCOMPLETE,
                f"{self.revolutions} revolutions in {self.bursts} bursts; {self._band_needed(ctx)}",
            )
            return
        self._move_out()

    def _move_out(self) -> None:
        self.phase = Phase.MOVE_OUT
        wheel = self.setpoint.wheel_speed_m_s
        if self.yawed:
            self.moves = Sequence(Lift(), Yaw(), Turn(wheel, wheel), Load(self.setpoint.load_n))
        else:
            self.moves = Sequence(Turn(wheel, wheel))

    def _end(self, ctx: Context, ending: Ending, detail: str) -> None:
        ctx.burst = 0
        self.ending = ending
        self.detail = detail
        self.phase = Phase.LIFT
        wheel = self.setpoint.wheel_speed_m_s
        first = () if self.yawed else (Turn(wheel, wheel),)
        self.moves = Sequence(*first, Lift(), Turn(wheel, wheel))

    # -- shared -----------------------------------------------------------------------------------------------

    def _aim(self, ctx: Context) -> None:
        """Point the gates at this condition."""
        target, sp = ctx.gates.target, self.setpoint
        target.load_n = sp.load_n
        target.wheel_speed_m_s = sp.wheel_speed_m_s
        target.belt_speed_m_s = self.belt_m_s
        target.slip_m_s = self.slip_m_s
        target.temperature_c = sp.temperature_c
        target.band_k = self.condition.temperature_band_k

    def _show(self, ctx: Context) -> None:
        progress = ctx.progress
        progress.phase = self.phase._value_
        progress.burst = self.bursts
        progress.revolutions = float(len(self.counter.blocks))
