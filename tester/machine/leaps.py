"""Leaps: on a simulated rig in virtual time, time in which only heat flows passes without scans.

Every axis is then at rest, or turns unloaded at a constant speed. ``Leaps.hindered`` decides and gives the reason.
Wires, drives and drivers do not notice a leap: their clock stands still. The plant's heat flows, controllers run their
loops, and each device draws the noise of the readings that it was not asked for. A leap lasts a common multiple of the
periods in which devices are read: after it each is where it would have been, and noise belongs to a moment.

After a leap the wires run for ``RENEW_S`` before the next scan, so that it finds readings of every device.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import floor, inf, lcm
from typing import Final, Protocol

from tester.machine.activity import Waits
from tester.machine.context import AnyContext
from tester.machine.control import AnyControl
from tester.machine.engine import Engine
from tester.machine.executor import Executor
from tester.machine.state import Mode
from tester.store.journal_records import LEAP

LOOP_S: Final = 1.0
"""Common multiple of the cycles of simulated controllers (``sim.nodes.control_loop``), and of what turns in a
cool-down, s.
"""
USUAL_S: Final = 9.0
"""A leap lasts so many common periods as fit in this, s [A]: filters of readings restart after ten seconds."""
MOST_S: Final = 20.0
"""Longest leap, s [A]; no leap where the periods of scans and devices have no common multiple as short."""
RENEW_S: Final = 1.0
"""Time after a leap in which only the wires run and renew every reading, s [A]: several periods of each device."""
MOST_K: Final = 1.0
"""No leap while a temperature changes by more in its time, K [A]: a chamber at full output moves by 0.9 K in 9 s."""
_TINY_S: Final = 1e-6
_RUN: Final = Mode.RUN
_COOLDOWN: Final = Mode.COOLDOWN


class LeapingWorld(Protocol):
    """A simulated rig that can leap (``sim.rig``)."""

    def count_readings(self) -> None:
        """Begin to count how often each device is read."""
        ...

    def readings_since(self) -> dict[str, dict[int, int]]:
        """Return how often each device was read since then, by the blocks of its profile."""
        ...

    def leap(self, seconds: float, each: Mapping[str, Mapping[int, int]]) -> None:
        """Let ``seconds`` pass on the plant alone."""
        ...


class Leaps:
    """Decides after each tick whether time is leapt, and leaps."""

    def __init__(self, engine: Engine, world: LeapingWorld) -> None:
        """``world``: the rig of the engine's wires."""
        self.engine = engine
        self.world = world
        self.leapt_s = 0.0
        """Rig time leapt in the present step of the plan, s; reported when the step is over, or the run is
        held or stops."""
        self._step = -1
        self._period_s = self._leap_s = 0.0
        self._calm_s = inf
        """Since when readings are counted, while nothing but heat changes, rig s."""
        self._before: dict[str, dict[int, int]] = {}
        self._each: dict[str, dict[int, int]] = {}
        """The readings of each device in the time of a leap, once two such times have had as many: after a change it
        takes the lines some seconds to repeat themselves.
        """
        self._before_s = 0.0
        self._before_c: tuple[float, ...] = ()
        """An earlier moment and its temperatures, for their rates."""

    def after(self, now: float, later: float) -> float:
        """Leap if only heat flows; return the time of the next tick. ``later``: that time without a leap, rig s."""
        engine = self.engine
        ctx: AnyContext = engine.ctx
        control: AnyControl = engine.control
        mode = control.state.mode
        if mode is not _RUN and mode is not _COOLDOWN:
            self._report()  # a run that stops here begins no other step
        if ctx.progress.step != self._step:
            self._report()
            self._step = ctx.progress.step
            self._calm_s = inf  # the new step's setpoints are not sent yet: a leap would hold them back
        if engine.last_scan_s != now or engine.renewing:
            return later
        if engine.period_s != self._period_s:
            self._calm_s, self._leap_s = inf, 0.0
        if engine.period_s <= engine.sliding_s or self.stirred():
            self._calm_s = inf
            return later
        if self._calm_s == inf:
            self._begin(now, ctx.calm())
        if not self._each and now - self._calm_s >= self._leap_s - _TINY_S:
            self._count(now)
        if self.hindered(now):
            return later
        self._before_s, self._before_c = now, ctx.calm()
        self.world.leap(self._leap_s, self._each)
        engine.leap(self._leap_s, RENEW_S)
        self.leapt_s += self._leap_s
        return floor((later + self._leap_s) * 1e6 + 0.5) / 1e6

    def stirred(self) -> str:
        """Return why readings may not be counted for a leap, since more than heat may change; "" if they may."""
        engine = self.engine
        ctx: AnyContext = engine.ctx
        control: AnyControl = engine.control
        state = control.state
        if ctx.moving or ctx.repeat_key:
            return "something moves or is measured"
        if state.mode is not _RUN and state.mode is not _COOLDOWN:
            return f"the rig is in {state.mode.value}"
        if state.trip is not None:
            return "the rig has tripped"
        if state.held:
            return "a row of the interlock table holds"
        if ctx.prompts.waiting is not None:
            return "a person is asked"
        if not ctx.calm():
            return "an axis moves or is loaded, heat is on, or this kind of machine makes every scan"
        if engine.devices.busy() or engine.devices.lost or engine.devices.alarm():
            return "a drive is being set up, or reports something"
        return ""

    def hindered(self, now: float) -> str:
        """Return why time may not be leapt at ``now``, rig s; "" if it may."""
        stirred = self.stirred()
        if stirred:
            return stirred
        if not self._each:
            return "readings are still being counted"
        if self._leap_s > MOST_S:
            return "the periods of the devices have no short common multiple"
        ctx: AnyContext = self.engine.ctx
        if self._waits_s(ctx) < self._leap_s + RENEW_S + self._period_s:
            return "the step of the plan, or the cool-down, may act"
        if not self._slow(now, ctx.calm()):
            return "a temperature changes fast"
        return ""

    def _waits_s(self, ctx: AnyContext) -> float:
        """Return the rig time for which neither the step of the plan nor control acts, s."""
        control: AnyControl = self.engine.control
        if control.state.mode is _COOLDOWN:
            return control.cools_s()
        executor: Executor[AnyContext] = self.engine.executor
        activity = executor.activity
        return activity.waits_s(ctx) if isinstance(activity, Waits) else 0.0

    def _begin(self, now: float, temperatures_c: tuple[float, ...]) -> None:
        """Begin to count the readings, for the time of a leap."""
        self._calm_s = self._before_s = now
        self._before_c = temperatures_c
        self._period_s = self.engine.period_s
        periods_s = [self._period_s, LOOP_S, *self.engine.devices.periods_s()]
        common_s = lcm(*[round(1e6 * period_s) for period_s in periods_s]) / 1e6  # a third of a second has none
        self._leap_s = common_s * max(1, int(USUAL_S / common_s))
        self._before, self._each = {}, {}
        self.world.count_readings()

    def _count(self, now: float) -> None:
        """Take the readings that were counted, if they are as many as before; else count anew."""
        readings = self.world.readings_since()
        if readings == self._before:
            self._each = readings
            return
        self._before, self._calm_s = readings, now
        self.world.count_readings()

    def _slow(self, now: float, temperatures_c: tuple[float, ...]) -> bool:
        """Return whether every temperature changes slowly enough for a leap."""
        share = self._leap_s / (now - self._before_s) if now > self._before_s else inf
        pairs = zip(temperatures_c, self._before_c, strict=True)
        return all(abs(c - before_c) * share <= MOST_K for c, before_c in pairs)

    def _report(self) -> None:
        """Record how much of a step was leapt."""
        if self.leapt_s:
            ctx: AnyContext = self.engine.ctx
            text = f"{self.leapt_s:.0f} s in which only heat flowed were leapt, without scans"
            ctx.journal.event(ctx.now, LEAP, text, data=f"{self.leapt_s:.3f}")
        self.leapt_s = 0.0
