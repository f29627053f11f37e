"""The rig's devices as one object: five servo drives on CAN, three Modbus devices on two lines.

Inputs fill the process image from the drivers, outputs hand setpoints to them. Nothing here decides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, inf, pi, sin
from typing import Final

from drivers.canopen.master import CanMaster
from drivers.cia402 import Goal, State
from drivers.ir_thermometer import IrThermometer
from drivers.jacket import HeatingJacket
from drivers.load_cell import LoadCell
from drivers.modbus import ModbusLink
from drivers.ports import BusLost, CanPort, ForeseeingPort, LinePort
from drivers.servo import ServoDrive
from tester.engine.inspection import Inspector
from tester.process import NEVER, Readings, Setpoints

INPUT_SAFETY_CHAIN: Final = 1 << 16
INPUT_GUARD: Final = 1 << 17
INPUT_CONTACTOR: Final = 1 << 18
OUTPUT_CONTACTOR: Final = 1 << 16
"""Bits of the press drive's digital inputs 0x60FD and outputs 0x60FE (docs/safety.md)."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_OPERATING: Final = State.OPERATION_ENABLED
_FAULT_REACTION: Final = State.FAULT_REACTION
_FAULT: Final = State.FAULT
_ENABLED: Final = Goal.ENABLED
_DISABLED: Final = Goal.DISABLED
_QUICK_STOP: Final = Goal.QUICK_STOP
_FREE: Final = Goal.FREE
_RADIANS_PER_DEGREE: Final = pi / 180.0
_TURN: Final = 2.0 * pi


@dataclass(slots=True)
class Axes:
    """The five drives. A manual axis is None: a person sets it."""

    wheel: ServoDrive
    belt: ServoDrive
    press: ServoDrive
    sideslip: ServoDrive | None
    camber: ServoDrive | None

    def present(self) -> tuple[ServoDrive, ...]:
        """Return the drives that exist, in node order."""
        axes = (self.wheel, self.belt, self.press, self.sideslip, self.camber)
        return tuple(axis for axis in axes if axis is not None)


@dataclass(slots=True)
class Devices:
    """Drivers and the ports they speak through."""

    can: CanPort
    master: CanMaster
    axes: Axes
    lines: list[tuple[LinePort, ModbusLink]]
    cell: LoadCell
    thermometer: IrThermometer
    jacket: HeatingJacket
    drives: tuple[ServoDrive, ...] = field(init=False)
    manual_sideslip_deg: float = 0.0
    manual_camber_deg: float = 0.0
    news: bool = True
    """A drive's state, an input or an emergency is new in this scan."""
    _withheld: bool = False
    _contactor_closed: bool = False
    """Its feedback, as it was last read."""
    lost: str = ""
    """Why a wire is gone. It is never used again: what waits in its queues must not be sent later."""
    _can_alive: bool = True
    _can_heard_s: float = NEVER
    _cell_counts: tuple[int, int, int, int] = (0, 0, 0, 0)
    _surface_counts: int = 0
    _inspector: Inspector = field(init=False)
    _goal: Goal = Goal.DISABLED
    _press_goal: Goal = Goal.DISABLED
    _last_angle_s: float = NEVER
    _lines: tuple[tuple[LinePort, ModbusLink, ForeseeingPort | None], ...] = field(init=False)
    _foreseeing: ForeseeingPort | None = field(init=False)

    def __post_init__(self) -> None:
        """Fix the drives' order, and see which lines are simulated ones."""
        self.drives = self.axes.present()
        self._inspector = Inspector(self.cell, self.thermometer, self.jacket)
        self._foresee()

    def _foresee(self) -> None:
        self._lines = tuple(
            (port, link, port if isinstance(port, ForeseeingPort) else None) for port, link in self.lines
        )
        self._foreseeing = next((port for _, link, port in self._lines if link is self.cell.link), None)

    def rewire(self, can: CanPort, lines: Sequence[LinePort]) -> None:
        """Speak through other ports from now on; ``lines`` in the order of the ones in use."""
        self.can = can
        self.lines = [(port, link) for port, (_, link) in zip(lines, self.lines, strict=True)]
        self._foresee()

    def receive(self, now: float) -> None:
        """Take in everything that arrived; a wire that is lost is left alone from then on (``lost`` says why)."""
        try:
            frames = self.can.receive(now)
        except BusLost as error:
            self._lose_can(error)
        else:
            # What comes over a wire that was lost and came back is taken off it, and not believed.
            if frames and self._can_alive:
                self._can_heard_s = frames[-1][0]
                self.master.feed(frames, now)
        for port, link, foreseen in self._lines:
            if foreseen is None or foreseen.arrives_s <= now:
                try:
                    chunks = port.read(now)
                except BusLost as error:
                    self._lose_line(link, error, now)
                    continue
                if chunks:
                    link.feed(chunks, now)

    def _lose_can(self, error: BusLost) -> None:
        self.lost = self.lost or f"bus lost: {error}"
        self._can_alive = False

    def _lose_line(self, link: ModbusLink, error: BusLost, now: float) -> None:
        """Go on without a line: what it carried is not valid any more."""
        self.lost = self.lost or f"line lost: {error}"
        self._lines = tuple(entry for entry in self._lines if entry[1] is not link)
        if link is self.cell.link:
            self._foreseeing = None
        for station in link.stations:
            station.owner.lost(now)
        link.deadline = inf  # nobody serves it any more, and it must not ask for that either

    def transmit(self, now: float, *, scan: bool, next_scan_s: float = NEVER) -> float:
        """Send what is due and return the next time a driver wants to be served; ``next_scan_s`` if it is known."""
        deadline = inf
        if self._can_alive:
            try:
                if scan:
                    self.master.scan(self.can, now, next_scan_s)
                else:
                    self.master.service(self.can, now)
            except BusLost as error:
                self._lose_can(error)
            else:
                deadline = self.master.deadline
        self.transmit_lines(now, scan=scan)
        # Only the load cell's line may ask for a tick of its own (its retry has to fit into a scan); the slow
        # line's next request can wait for the next scan. A simulated line knows that the reply will be in time.
        watch = self.cell.link
        wish = watch.deadline
        if wish >= deadline or wish >= next_scan_s > now:
            return deadline
        wire = self._foreseeing
        return deadline if wire is not None and watch.only_watches and wire.arrives_s <= wish else wish

    def transmit_lines(self, now: float, *, scan: bool = True) -> None:
        """Send what is due on the Modbus lines alone."""
        for port, link, _ in self._lines:
            if now >= link.wants_s:
                try:
                    link.service(port, now, scan=scan)
                except BusLost as error:
                    self._lose_line(link, error, now)

    def fill(self, r: Readings, now: float) -> None:
        """Bring the process image up to date; the wheel's diameters in it are (``WheelLife.show``)."""
        r.now_s = now
        self._fill_motion(r, self.axes)
        self.news = False
        for drive in self.drives:
            if drive.news:
                drive.news = drive.stands = False
                self.news = True
        if self.news:
            self._fill_status(r)
        r.can_heard_s = self._can_heard_s
        if self.lost:
            r.bus_fault = self.lost
        if self.master.foreign_master:
            r.foreign_master = self.master.foreign_frame
        cell = self.cell
        r.force_x_n, r.force_y_n, r.force_z_n, r.moment_z_nm = cell.fx_n, cell.fy_n, cell.fz_n, cell.mz_nm
        r.cell_valid, r.cell_at_s = cell.valid, cell.stamp_s
        r.cell_silent = not cell.ready
        if cell.counts != self._cell_counts:
            self._cell_counts = cell.counts
            r.cell_changed_s = cell.stamp_s
        thermometer = self.thermometer
        r.surface_c, r.surface_valid, r.surface_at_s = thermometer.surface_c, thermometer.valid, thermometer.stamp_s
        r.surface_silent = not thermometer.ready
        if thermometer.counts != self._surface_counts:
            self._surface_counts = thermometer.counts
            r.surface_changed_s = thermometer.stamp_s
        jacket = self.jacket
        r.hub_c, r.heat_percent = jacket.hub_c, jacket.output_percent
        r.jacket_valid, r.jacket_at_s, r.jacket_silent = jacket.valid, jacket.stamp_s, not jacket.ready
        if now >= self._inspector.due_s:
            self._inspector.inspect(r, now)

    def _fill_motion(self, r: Readings, axes: Axes) -> None:
        wheel, belt, press = axes.wheel, axes.belt, axes.press
        r.wheel_rad_s = wheel_rad_s = wheel.actual
        r.wheel_speed_m_s = wheel_m_s = wheel_rad_s * r.diameter_mm * 0.5e-3
        r.drive_torque_nm = wheel.torque_nm
        r.wheel_at_s = stamp_s = wheel.stamp_s
        if stamp_s > self._last_angle_s:
            if self._last_angle_s != NEVER:
                r.wheel_angle_rev += wheel_rad_s * (stamp_s - self._last_angle_s) / _TURN
            self._last_angle_s = stamp_s
        r.belt_speed_m_s = belt_m_s = belt.actual
        r.belt_torque_nm, r.belt_at_s = belt.torque_nm, belt.stamp_s
        r.press_mm, r.press_torque_nm, r.press_at_s = press.actual, press.torque_nm, press.stamp_s
        r.inputs_at_s = press.inputs_stamp_s
        sideslip, camber = axes.sideslip, axes.camber
        reached = True
        if sideslip is not None:
            r.sideslip_deg, r.sideslip_at_s = sideslip.actual, sideslip.stamp_s
            reached = sideslip.reached
        else:
            r.sideslip_deg, r.sideslip_at_s = self.manual_sideslip_deg, r.now_s
        if camber is not None:
            r.camber_deg, r.camber_at_s = camber.actual, camber.stamp_s
            reached = reached and camber.reached
        else:
            r.camber_deg, r.camber_at_s = self.manual_camber_deg, r.now_s
        r.yaw_reached = reached
        angle = r.sideslip_deg * _RADIANS_PER_DEGREE
        along = wheel_m_s - belt_m_s * cos(angle)
        across = belt_m_s * sin(angle)
        r.slip_m_s = (along * along + across * across) ** 0.5

    def _fill_status(self, r: Readings) -> None:
        enabled = disabled = True
        fault = ""
        for drive in self.drives:
            state = drive.state
            if state is _OPERATING:
                disabled = False
            else:
                enabled = False
                if not fault and (state is _FAULT or state is _FAULT_REACTION):
                    fault = _fault_text(drive)
            if not fault and (
                drive.lost or drive.rebooted or drive.emergency is not None or (drive.connected and not drive.remote)
            ):
                fault = _fault_text(drive)
        r.drives_enabled, r.drives_disabled, r.drive_fault = enabled, disabled, fault
        inputs = self.axes.press.inputs
        r.safety_chain = inputs & INPUT_SAFETY_CHAIN != 0
        r.guard_closed = inputs & INPUT_GUARD != 0
        r.contactor_closed = self._contactor_closed = inputs & INPUT_CONTACTOR != 0

    def apply(self, out: Setpoints) -> None:
        """Hand the setpoints to the drivers; the frames leave with ``transmit``."""
        axes = self.axes
        wanted = _ENABLED if out.enable else _DISABLED
        goal = _FREE if out.power_off else _QUICK_STOP if out.quick_stop else wanted
        # A quick-stopped press would stay in contact: it keeps its own retraction, as long as it is to have power.
        press_goal = wanted if goal is _QUICK_STOP else goal
        wheel, belt, press, sideslip, camber = axes.wheel, axes.belt, axes.press, axes.sideslip, axes.camber
        if goal is not self._goal or press_goal is not self._press_goal or self.news:
            self._goal, self._press_goal = goal, press_goal
            for drive in self.drives:
                drive.goal = press_goal if drive is press else goal
        if out.wheel_rad_s != wheel.aimed:
            wheel.aim(out.wheel_rad_s)
        if out.belt_m_s != belt.aimed:
            belt.aim(out.belt_m_s)
        if out.press_mm_s != press.aimed:
            press.aim(out.press_mm_s)
        if sideslip is not None and out.sideslip_deg != sideslip.aimed:
            sideslip.aim(out.sideslip_deg)
        if camber is not None and out.camber_deg != camber.aimed:
            camber.aim(out.camber_deg)
        press.outputs = OUTPUT_CONTACTOR if out.contactor else 0
        press.outputs_unanswered = out.contactor is not self._contactor_closed
        if out.power_off is not self._withheld:
            # The last resort reaches a drive that takes no commands, too: each stops without our heartbeat.
            self._withheld = self.master.withhold_heartbeat = out.power_off
        jacket = self.jacket
        jacket.enable(out.heat)
        if not out.jacket_silent:
            jacket.set_setpoint(out.hub_c)

    def poll_cell_every(self, seconds: float) -> None:
        """Poll the load cell at this period, s; 0 = with every scan."""
        if self.cell.period_s != seconds:
            self.cell.period_s = seconds

    def refused(self) -> str:
        """Return why a device cannot be used, or ""."""
        for drive in self.drives:
            if drive.refused:
                return f"{drive.config.name} drive (node {drive.config.node_id}): {drive.refused}"
        for name, device in (("load cell", self.cell), ("thermometer", self.thermometer), ("jacket", self.jacket)):
            if device.refused:
                return f"{name}: {device.refused}"
        return ""

    def alarm(self) -> bool:
        """Tell whether a drive has something to report that the next regular scan should not wait for."""
        for drive in self.drives:
            if drive.stands or drive.state >= State.FAULT_REACTION or drive.lost or drive.rebooted:
                return True
            if drive.emergency is not None:
                return True
        return False

    def all_off(self) -> bool:
        """Tell whether no drive's power stage is on."""
        return all(drive.state <= State.READY_TO_SWITCH_ON or drive.lost for drive in self.drives)

    def can_alive(self) -> bool:
        """Tell whether drives can still be told anything."""
        return self._can_alive

    def answering(self) -> bool:
        """Tell whether every Modbus device has reported a valid value."""
        devices = (self.cell, self.thermometer, self.jacket)
        return all(device.stamp_s > -inf and device.valid for device in devices)


def _fault_text(drive: ServoDrive) -> str:
    """Describe what is wrong with a drive."""
    name = f"{drive.config.name} drive"
    if drive.lost:
        return f"{name}: heartbeat lost"
    if drive.rebooted:
        return f"{name}: rebooted"
    if drive.emergency is not None:
        return f"{name}: {drive.emergency.text} (0x{drive.emergency.code:04X})"
    if drive.connected and not drive.remote:
        return f"{name}: under local control"
    return f"{name}: fault"
