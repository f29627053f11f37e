"""One synchronous scan: read, decide, send, record. No awaits, no threads, no clock inside."""

from __future__ import annotations

from math import inf
from typing import Any, Final

from tester.machine.context import AnyContext
from tester.machine.control import AnyControl
from tester.machine.devices import DeviceList
from tester.machine.executor import Executor
from tester.machine.sampler import Sampler
from tester.machine.state import ACKNOWLEDGED, Mode

SOONEST_S: Final = 5e-4
"""Shortest time between two ticks, s."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_RUN: Final = Mode.RUN
_COOLDOWN: Final = Mode.COOLDOWN
_HOLD: Final = Mode.HOLD
_STOPPING: Final = Mode.STOPPING
_FAST_STOP: Final = Mode.FAST_STOP
_EMERGENCY: Final = Mode.EMERGENCY
LONGEST_S: Final = 1.0
"""Longest time that a late scan counts for, s; a leap counts whole."""
HOLD_MOVES_S: Final = 3.0
"""Time within which a hold has opened the contact, s [A]: until then scans run at the sliding rate."""
SEVERITIES: Final = {"trip": "trip", "alarm": "alarm", "warning": "warning"}
"""Severity of control's events by kind; all others are information."""


class Engine:
    """The scan of one rig and one run."""

    def __init__(
        self, devices: DeviceList, control: AnyControl, executor: Executor[Any], ctx: AnyContext, sampler: Sampler
    ) -> None:
        """Take the kind's parts; send nothing before the first ``tick``."""
        # Any: a kind's code expects its own classes here, with more fields than the common ones.
        self.devices: Any = devices
        self.control: Any = control
        self.executor: Executor[Any] = executor
        self.ctx: Any = ctx
        self.sampler = sampler
        scan = ctx.rig.scan
        self.sliding_s = 1.0 / scan.sliding_hz
        self.enabled_s = 1.0 / scan.enabled_hz
        self.idle_s = 1.0 / scan.idle_hz
        self.period_s = self.enabled_s
        self.next_scan_s = 0.0
        self.last_scan_s = -inf
        self.scans = 0
        self.finished = False
        self.leapt_s = 0.0
        """Rig time that passed without the wires: what they and the drivers call now is so much earlier."""
        self._renew_by_s = -inf
        """Time of the first scan after a leap, rig s; before it the wires renew every reading, nothing is judged."""
        self._leaps = False
        self._trip = 0
        """Number of the latched trip in the record."""

    def tick(self, now: float) -> float:
        """Do everything due at ``now`` (s) and return the latest time of the next tick."""
        devices: DeviceList = self.devices
        leapt_s = self.leapt_s
        devices.receive(now - leapt_s)
        scan = now >= self.next_scan_s - 1e-7 or self._urgent()
        if scan:
            if self._renew_by_s > -inf and not self._renewed(now):
                self.next_scan_s += self.period_s
                self.ctx.now = now  # no scan follows at once: a request is dated now, not at the leap's end
                devices.apply(self.control.state.setpoints)  # a setpoint that is not asked for is not renewed
            else:
                self._scan(now)
        deadline = devices.transmit(now - leapt_s, scan=scan, next_scan_s=self.next_scan_s - leapt_s) + leapt_s
        if deadline >= self.next_scan_s:
            return self.next_scan_s
        return min(self.next_scan_s, max(deadline, now + SOONEST_S))

    def leap(self, seconds: float, renew_s: float) -> None:
        """Let rig time pass without scans, after a scan; the next scan follows when readings were renewed for
        ``renew_s`` s.
        """
        self.leapt_s += seconds
        self.next_scan_s += seconds
        self.ctx.now += seconds  # requests that come before the next scan are dated after the leap
        self._renew_by_s = self.last_scan_s + seconds + renew_s

    @property
    def wires_s(self) -> float:
        """``ctx.now`` by the clock of wires and drivers, s: drivers stamp their data with it."""
        now: float = self.ctx.now
        return now - self.leapt_s

    @property
    def renewing(self) -> bool:
        """Whether readings are renewed after a leap."""
        return self._renew_by_s > -inf

    def _renewed(self, now: float) -> bool:
        """Return whether the first scan after a leap is due: then every device has reported anew."""
        devices: DeviceList = self.devices
        mode = self.control.state.mode
        quiet = not devices.lost and not devices.alarm() and (mode is _RUN or mode is _COOLDOWN)
        if quiet and now < self._renew_by_s - 1e-7:
            return False
        self._renew_by_s = -inf
        self._leaps = True
        control: AnyControl = self.control
        control.leap(now - self.last_scan_s - self.period_s)
        return True

    def abandon(self) -> None:
        """Command a safe state at once and send it; send nothing afterwards.

        CAN frames leave at once. A Modbus request leaves only on a free line: during a reply it would spoil both. A
        device that receives no request stops when its lease ends.
        """
        devices: DeviceList = self.devices
        control: AnyControl = self.control
        control.safe_outputs()
        devices.apply(control.state.setpoints)
        devices.transmit(self.wires_s, scan=True)

    def _urgent(self) -> bool:
        """Return whether a drive reports a fault or an emergency that should not wait until the next regular scan."""
        ctx: AnyContext = self.ctx
        return not ctx.readings.drive_fault and bool(self.devices.alarm())

    def _scan(self, now: float) -> None:
        ctx: AnyContext = self.ctx
        control: AnyControl = self.control
        devices: DeviceList = self.devices
        readings, state = ctx.readings, control.state
        dt = now - self.last_scan_s
        ctx.dt = (dt if dt <= LONGEST_S or self._leaps else LONGEST_S) if self.scans else 0.0
        self._leaps = False
        self.last_scan_s = now
        ctx.now = now
        self.scans += 1
        ctx.before_reading()
        leapt_s = self.leapt_s
        devices.fill(readings, now - leapt_s)
        if leapt_s:
            readings.later(leapt_s)
        ctx.after_reading()
        ctx.moving = False
        events = state.events
        if events:
            self._journal()  # commands since the last scan, before the executor's events of this scan
        if devices.news:
            self._journal_emergencies()
        if state.mode is _RUN:
            ctx.gate = ctx.closed_gates()
            self.executor.step(ctx)
        control.step(ctx.demand, readings, self.period_s)
        ctx.after_control()
        if events:
            self._journal()
        devices.apply(state.setpoints)
        self._choose_rate(now)
        self.sampler.record(ctx, state.setpoints)

    def _journal(self) -> None:
        """Queue control's events in order, before this scan's outputs leave."""
        control: AnyControl = self.control
        ctx: AnyContext = self.ctx
        state, journal = control.state, ctx.journal
        if not state.events:
            return
        for event in state.events:
            if event.kind == "trip" and state.trip is not None:
                compared = state.trip.compared
                self._trip = journal.trip(
                    event.at_s, state.trip.name, event.text, compared.value, compared.limit, compared.unit
                )
            elif event.kind == ACKNOWLEDGED and self._trip:
                journal.trip_acknowledged(self._trip, event.at_s, event.text)
                self._trip = 0
            journal.event(event.at_s, event.kind, event.text, SEVERITIES.get(event.kind, "info"))
        if state.mode is Mode.LATCHED and not self._trip:
            # A fast stop by a person also latches: the next operator must see it.
            self._trip = journal.trip(ctx.now, "fast stop", state.stop_requested)
        state.events.clear()

    def _journal_emergencies(self) -> None:
        """Queue the drives' own emergency reports, before the trip that they cause."""
        devices: DeviceList = self.devices
        for drive in devices.drives:
            if drive.emergency_log:
                for emergency in drive.take_emergencies():
                    text = f"{drive.config.name} drive: {emergency.text} (0x{emergency.code:04X})"
                    self.ctx.journal.event(emergency.t + self.leapt_s, "emergency", text, "alarm")

    def _choose_rate(self, now: float) -> None:
        """Set the period of the next scan, which depends on the state (docs/decisions/0003)."""
        ctx: AnyContext = self.ctx
        control: AnyControl = self.control
        state = control.state
        mode = state.mode
        # Scan fast while a level's delay runs, so that slow scans do not lengthen the delay.
        pending = state.held & ~state.tripped
        stops = mode is _STOPPING or mode is _FAST_STOP or mode is _EMERGENCY
        if pending or ctx.moving or stops or (mode is _HOLD and now - state.mode_since_s < HOLD_MOVES_S):
            self.period_s = self.sliding_s
        elif ctx.demand.enabled or not ctx.readings.drives_disabled:
            self.period_s = self.enabled_s
        else:
            self.period_s = self.idle_s
        # Deadlines are absolute: a late scan does not delay those after it; an early (urgent) scan starts the period
        # anew.
        late = now - self.next_scan_s
        self.next_scan_s = (self.next_scan_s if 0.0 <= late < self.period_s else now) + self.period_s
