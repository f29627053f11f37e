"""The activities of a plain machine: mount a specimen, zero the sensors, measure a condition in repeats."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import nan
from typing import Final

from tester.analysis.blocks import BlockCounter
from tester.analysis.judge import ALONE
from tester.analysis.reduce import collected
from tester.base.axes import Setpoint
from tester.base.quantities import Quantities
from tester.base.units import SHORE_A
from tester.inputs.recipe.plain_recipe import Mount, PlainPart
from tester.inputs.recipe.plan import ConditionStep, Step
from tester.machine.activity import Activity, MoveFailedError
from tester.machine.condition import MeasureCondition
from tester.machine.executor import Procedures
from tester.machine.hardness import with_hardness
from tester.machine.measured import Ending, MeasuredRepeat
from tester.machine.motions import Ask, ZeroOfCell
from tester.machine.plain.context import PlainContext
from tester.machine.plain.image import PlainReadings
from tester.machine.result_keeping import StoredResults

MOVE_AT_MOST_S: Final = 15.0
"""Longest time for drives to reach their speed, or standstill, s [A]."""
BLIND_S: Final = 20.0
"""Longest time of a repeat without a counted block, s [A]."""
ZERO_S: Final = 1.0
"""Averaging time of a zero, s [A]."""

SpeedsOf = Callable[[Setpoint, PlainReadings], Mapping[str, float]]
"""Function that returns the speeds that a condition demands of the drives, at the start of each repeat."""


class Standstill:
    """Switches the drives on or off, and waits for standstill."""

    def __init__(self, *, enabled: bool) -> None:
        """``enabled``: whether the drives are to have power."""
        self.enabled = enabled
        self.since_s = nan

    def step(self, ctx: PlainContext) -> bool:
        """Return True when standstill is measured; raises MoveFailedError after ``MOVE_AT_MOST_S``."""
        ctx.moving, r = True, ctx.readings
        ctx.demand.enabled = self.enabled
        ctx.demand.speeds.clear()
        self.since_s = ctx.now if self.since_s != self.since_s else self.since_s
        if r.standing and (r.drives_enabled if self.enabled else r.drives_disabled):
            return True
        if ctx.now - self.since_s > MOVE_AT_MOST_S:
            raise MoveFailedError(f"not at a stand with drives {'on' if self.enabled else 'off'}: {r.drive_fault}")
        return False


class PutOn:
    """Brings the drives to standstill without power, asks a person to mount a specimen, then zeroes the sensors."""

    def __init__(self, step: Mount) -> None:
        """The step's title is the question to the person."""
        self.mount = step
        self.stand = Standstill(enabled=False)
        self.ask = Ask(with_hardness(step.title), unit=SHORE_A) if step.hardness else Ask(step.title)
        self.answered = False
        self.zeros: dict[str, ZeroOfCell] = {}
        """The zeros of the sensors that are zeroed, by sensor name."""

    def resume(self, ctx: PlainContext) -> None:
        """Resume after a hold: come to standstill again."""
        self.stand = Standstill(enabled=False)

    def step(self, ctx: PlainContext) -> bool:
        """Return True when the specimen is mounted and the sensors are zeroed."""
        if not self.answered:
            if self.mount.hardness:
                self.ask.by_itself = ctx.hardness.by_itself(self.mount.piece, self.mount.compound)
            if not self.stand.step(ctx) or not self.ask.step(ctx):
                return False
            self.answered = True
            self._put_on(ctx)
        return self._zero(ctx)

    def _put_on(self, ctx: PlainContext) -> None:
        ctx.attendant.install(self.mount.specimen, self.mount.compound)
        ctx.mount(self.mount, self.ask.prompt(ctx))
        ctx.readings.slid_m = 0.0
        zeroed = (name for name, sensor in ctx.sensors.items() if sensor.profile.tare)
        self.zeros = {name: ZeroOfCell(ZERO_S, name.replace("_", " ")) for name in zeroed}

    def _zero(self, ctx: PlainContext) -> bool:
        done = True
        for name, zero in self.zeros.items():
            sensor = ctx.sensors[name]
            done &= zero.averaged(ctx, sensor.stamp_s, sensor.raw, valid=sensor.valid)
            if zero.failed:
                raise MoveFailedError(zero.failed)
        if not done:
            return False
        for name, zero in self.zeros.items():
            sensor = ctx.sensors[name]
            readings = zero.zero([0.0] * len(sensor.raw))
            sensor.set_tare(readings)
            words = ", ".join(f"{key} {value:.4g}" for key, value in zip(sensor.channels, readings, strict=True))
            ctx.journal.event(ctx.now, "tare", f"{name}: {words}")
        return True


class SteadyRepeat(MeasuredRepeat):
    """One repeat: reach speed, settle, count samples."""

    def __init__(self, step: ConditionStep, speeds: Mapping[str, float], settle_s: float, table: Quantities) -> None:
        """``speeds``: of the drives; ``settle_s``: time from reaching speed to the first sample that counts."""
        super().__init__(BlockCounter(table))
        self.condition = step
        self.speeds = speeds
        self.settle_s = settle_s
        self._since_s = self._settled_s = nan

    def step(self, ctx: PlainContext) -> bool:
        """Advance by one scan; return True when the repeat has its samples, or can get none."""
        ctx.moving = True
        ctx.demand.speeds.update(self.speeds)
        if self._since_s != self._since_s:
            self._since_s = ctx.now
        if not ctx.burst:
            return self._settle(ctx)
        if self.counter.add(ctx.sample) is not None:
            self._since_s = ctx.now
            window, alone = self.condition.window, self.condition.repeats <= ALONE
            if collected(self.counter, window, alone=alone):
                self.ending = Ending.COMPLETE
        if self.ending is None and ctx.now - self._since_s > BLIND_S:
            self.ending, self.detail = Ending.INCOMPLETE, f"nothing has counted for {BLIND_S:g} s"
        ctx.progress.revolutions = float(len(self.counter.blocks))
        return self.ending is not None

    def _settle(self, ctx: PlainContext) -> bool:
        ctx.progress.phase = "settle"
        if not ctx.at_speed():
            self._settled_s = nan
            if ctx.now - self._since_s > MOVE_AT_MOST_S:
                raise MoveFailedError("the drives do not get to their speed")
            return False
        if self._settled_s != self._settled_s:
            self._settled_s = ctx.now
        if ctx.now - self._settled_s >= self.settle_s:
            ctx.burst, ctx.progress.burst, ctx.progress.phase, self._since_s = 1, 1, "slide", ctx.now
        return False


class MeasureSteady(MeasureCondition[PlainContext, ConditionStep, SteadyRepeat]):
    """The measurement of one condition: its repeats, from standstill to standstill."""

    def __init__(
        self, step: ConditionStep, results: StoredResults[PlainContext], speeds: SpeedsOf, settle_s: float
    ) -> None:
        """``speeds``: returns the speeds that the condition demands of the drives."""
        super().__init__(step, results)
        self.speeds = speeds
        self.settle_s = settle_s
        self.stand = Standstill(enabled=True)

    def resume(self, ctx: PlainContext) -> None:
        """Resume after a hold: come to standstill again."""
        super().resume(ctx)
        self.stand = Standstill(enabled=True)

    def ready(self, ctx: PlainContext) -> bool:
        """Return whether the drives are on and at rest."""
        return self.stand.step(ctx)

    def begin(self, ctx: PlainContext, attempt: int) -> SteadyRepeat:
        """Return the repeat, at the kind's speeds for its setpoint."""
        step = self.condition
        ctx.attendant.begin_repeat(step.row, self.repeat, attempt)
        return SteadyRepeat(step, self.speeds(step.setpoint, ctx.readings), self.settle_s, ctx.quantities)

    def finish(self, ctx: PlainContext, measured: SteadyRepeat) -> None:
        """Come to standstill while the repeat is committed."""
        super().finish(ctx, measured)
        ctx.demand.speeds.clear()
        self.stand = Standstill(enabled=True)


class PlainProcedures(Procedures[PlainContext]):
    """The activities of the steps."""

    def __init__(self, part: PlainPart, results: StoredResults[PlainContext], speeds: SpeedsOf) -> None:
        """``speeds``: returns the speeds that a condition demands."""
        self.part = part
        self.results = results
        self.speeds = speeds

    def activity(self, step: Step, to_come: Sequence[Step], ctx: PlainContext) -> Activity[PlainContext]:
        """Return the activity of a step."""
        if isinstance(step, Mount):
            return PutOn(step)
        if isinstance(step, ConditionStep):
            return MeasureSteady(step, self.results, self.speeds, self.part.settle_s)
        raise TypeError(f"{step.kind}: no step of this machine")
