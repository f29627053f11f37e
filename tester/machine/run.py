"""One run from connection to standstill, driven by a ticker."""

from __future__ import annotations

from enum import Enum
from typing import Any, Final

from drivers.ports import BusLost
from tester.base.quantities import Quantities
from tester.inputs.recipe.plan import Plan
from tester.machine import line_speed
from tester.machine.connect import Arming, Connector, Stage
from tester.machine.context import AnyContext
from tester.machine.control import AnyControl
from tester.machine.devices import DeviceList
from tester.machine.engine import Engine
from tester.machine.executor import Executor, Procedures
from tester.machine.sampler import Sampler
from tester.machine.state import Mode, Trip

POWER_OFF_S: Final = 2.0
"""After this time a drive is released even if it has not switched its power off, s [A]."""
RELEASE_S: Final = 5.0
"""Time limit for the drives to stop watching our heartbeat, s [A]."""
LATE_NAMED_S: Final = 0.015
"""A scan as late as this is named beside an alarm, s: replies of 10 ms are then read late, and asked again."""
LATE_BEFORE_S: Final = 1.0
"""A lateness counts as long before an alarm, s: a device is asked five times before it counts as silent [A]."""
OVERLAP_S: Final = 0.05
"""A lateness may begin as long after an alarm, s: both clocks are read at different moments [A]."""
CONNECTION_S: Final = 5.0
"""The same before a connection has failed, s: its axes are stopped and released first."""
MOST_LATE: Final = 100
# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_RUN: Final = Mode.RUN
_HOLD: Final = Mode.HOLD


class Outcome(Enum):
    """How a run ended."""

    RUNNING = "running"
    DONE = "done"
    UNREACHABLE = "rig unreachable"
    FAILED = "failed"
    TRIPPED = "tripped"
    STOPPED = "stopped"


class Run:
    """Connects a rig, executes a recipe, stops, and waits for standstill."""

    def __init__(self, connector: Connector, engine: Engine) -> None:
        """Send nothing before the first ``tick``."""
        self.connector = connector
        self.engine = engine
        self.outcome = Outcome.RUNNING
        self.finished = False
        self.reason = ""
        self.stays_latched = False
        """Whether the run waits for the acknowledgement after a trip. Otherwise a trip ends it, and a new run must be
        started.
        """
        self._ended_s: float | None = None
        self._started = False
        self._refused = False
        self._trip: Trip | None = None
        self._releasing = False
        self._late_scans: list[tuple[float, float]] = []
        """The latest late scans: time and lateness, s."""

    @property
    def connected(self) -> bool:
        """Whether every device has answered and its settings were read back; the recipe is then under way, or over."""
        return self._started

    @property
    def waiting(self) -> bool:
        """Whether a prompt waits for its answer."""
        return self.engine.ctx.prompts.waiting is not None and not self.engine.control.state.stop_requested

    # A request is possible at any time, any number of times; it returns "", or the reason why it had no effect.

    def request_stop(self, why: str, *, fast: bool = False, cool: bool = True) -> None:
        """Stop the run, controlled or fast. ``cool``: keep turning, unloaded, while it is too hot to stop."""
        self.reason = self.reason or why
        if not self._started:
            self.outcome = Outcome.STOPPED
            self.connector.abort(why)
            self.finished = self.connector.finished
            return
        self.engine.control.request_stop(self.engine.ctx.now, why, fast=fast, cool=cool)

    def request_hold(self, why: str = "held by the operator") -> str:
        """Hold: open the contact, keep the heat. The repeat under way is measured again."""
        engine = self.engine
        if not self._started:
            return "the rig is not up yet"
        held = engine.control.state.mode is Mode.HOLD
        refused = engine.control.request_hold(engine.ctx.demand, engine.ctx.now, why)
        if not refused and not held:
            engine.executor.hold(engine.ctx)
        return refused

    def request_release(self, why: str = "released by the operator") -> str:
        """Resume after a hold."""
        engine = self.engine
        refused = engine.control.request_release(engine.ctx.now, why)
        if not refused:
            engine.executor.resume(engine.ctx)
        return refused

    def request_ack(self, by: str = "") -> str:
        """Acknowledge a trip: drives reset their faults, and IDLE follows once every cause is gone."""
        engine = self.engine
        refused = engine.control.request_ack(engine.ctx.now, by)
        if not refused:
            for drive in engine.devices.drives:
                drive.reset_fault()
        return refused

    def abandon(self) -> None:
        """Leave the rig at once, because the program cannot continue: send safe outputs once, without reading.

        No scan follows. A drive or device that an output does not reach stops by its own watchdog (``Engine.abandon``).
        """
        self.engine.abandon()

    def tick(self, now: float) -> float:
        """Do everything due at ``now``; return the latest time of the next call (s)."""
        if self._started:
            due = self.engine.tick(now)
            self._supervise(now)
            return due
        try:
            return self._connect(now)
        except BusLost as lost:
            self._lose(lost)
            return now

    def _connect(self, now: float) -> float:
        due = self.connector.tick(now)
        if self.connector.stage is Stage.FAILED:
            if self.outcome is Outcome.RUNNING:
                late = self.engine.devices.machine_late(now - CONNECTION_S, now)
                self.outcome = Outcome.UNREACHABLE
                self.reason = f"{self.connector.failure}; {late}" if late else self.connector.failure
            self.finished = True
        elif self.connector.stage is Stage.READY:
            self._arm(now, due)
        return due

    def _arm(self, now: float, due: float) -> None:
        """Enter RUN, or refuse if a level of the interlock table holds."""
        engine = self.engine
        engine.next_scan_s = due
        ctx: AnyContext = engine.ctx
        ctx.now = now
        ctx.before_reading()
        engine.devices.fill(ctx.readings, now)
        devices: DeviceList = engine.devices
        measured = (line_speed.described(devices),) if devices.real_lines() else ()
        for line in (self.connector.shown, *engine.devices.without(), *measured, *ctx.known(), *ctx.counted_on):
            ctx.journal.event(now, "arming", line)
        self._started = True
        refused = engine.control.start(ctx.readings)
        if refused:
            self._refused, self.reason = True, refused
            ctx.journal.event(now, "arming", refused, "alarm")

    def _lose(self, lost: BusLost) -> None:
        """End the run: nothing reaches the drives any more, and moving drives stop because our heartbeat is missing.

        A lost serial line is not handled here: in that case the connector fails and stops the drives.
        """
        self.outcome, self.finished = Outcome.UNREACHABLE, True
        self.reason = f"bus lost: {lost}" if "lost" not in str(lost) else str(lost)

    def _supervise(self, now: float) -> None:
        engine = self.engine
        state = engine.control.state
        if state.last_late_s > LATE_NAMED_S and state.trip is None:
            self._late_scans.append((state.last_s, state.last_late_s))
            del self._late_scans[:-MOST_LATE]
        self._trip = state.trip or self._trip
        mode = state.mode
        if mode is _RUN or mode is _HOLD:
            # A recipe does not end in a hold, but manual mode may have ended there.
            if engine.executor.finished:
                engine.control.request_stop(now, engine.executor.failed or "recipe finished")
            return
        if mode not in (Mode.IDLE, Mode.LATCHED) or (mode is Mode.LATCHED and self.stays_latched):
            return
        devices: DeviceList = engine.devices
        if self._ended_s is None:
            self._ended_s = now
        elif not self._releasing:
            if devices.all_off() or now - self._ended_s > POWER_OFF_S:
                self._releasing = True
                for drive in devices.drives:
                    devices.master.start(drive, drive.release())
        elif not any(devices.master.busy(drive) for drive in devices.drives) or now - self._ended_s > RELEASE_S:
            self._finish()

    def _late(self, at_s: float) -> str:
        """Return which computer was late before ``at_s``, in words, "" if none.

        A computer that is late looks like a cable or a device: both sides are therefore named beside the alarm.
        """
        devices: DeviceList = self.engine.devices
        machine = devices.machine_late(at_s - LATE_BEFORE_S, at_s + OVERLAP_S)
        late_s = [late_s for scan_s, late_s in self._late_scans if at_s - LATE_BEFORE_S <= scan_s <= at_s + OVERLAP_S]
        controller = f"; this computer was late by {1e3 * max(late_s):.0f} ms" if late_s else ""
        return controller + (f"; {machine}" if machine else "")

    def _finish(self) -> None:
        engine = self.engine
        trip = self._trip
        if self._refused:
            self.outcome = Outcome.UNREACHABLE
        elif trip is not None:
            self.outcome, self.reason = Outcome.TRIPPED, f"{trip.name}: {trip.text}"
            self.reason += self._late(trip.at_s)
        elif engine.executor.failed:
            self.outcome, self.reason = Outcome.FAILED, engine.executor.failed
        elif engine.executor.finished:
            self.outcome, self.reason = Outcome.DONE, ""
        else:
            self.outcome = Outcome.STOPPED
        self.finished = True


def run_of(
    plan: Plan, devices: DeviceList, control: AnyControl, ctx: AnyContext, arming: Arming[Any, Any],
    procedures: Procedures[Any], quantities: Quantities, listen_s: float,
) -> Run:  # fmt: skip
    """Return a run of a kind's parts, ready to be ticked; ``listen_s``: required silence on the bus before it
    begins.
    """
    sampler = Sampler(ctx.journal, quantities)
    ctx.readings.silences = devices.silences
    return Run(
        Connector(devices, ctx.rig, arming, listen_s),
        Engine(devices, control, Executor(plan, procedures), ctx, sampler),
    )
