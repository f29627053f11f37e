"""The devices of a rig as lists: drives on CAN, Modbus devices on any number of lines, and their ports.

A kind implements their readings and commands (``fill`` and ``apply`` of its devices).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan
from typing import Any, Final, Protocol

from drivers.canopen.master import CanMaster
from drivers.canopen.objects import EMERGENCY_TEXT, MACHINE_LATE
from drivers.canopen.sensor_node import SensorNode
from drivers.cia402 import Goal, State
from drivers.modbus import ModbusLink
from drivers.ports import BusLost, CanPort, ForeseeingPort, LinePort
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from tester.base.deriving import mypyc_attr
from tester.machine.image import NEVER, BaseReadings, BaseSetpoints
from tester.machine.modbus_health import FieldDevice, Inspector
from tester.machine.rig_drivers import RigDrivers
from tester.machine.silence import fault_text, name_of, refusals, silent_lines, unheard
from tester.store.recorder import Recorder

INPUT_SAFETY_CHAIN: Final = 1 << 16
INPUT_GUARD: Final = 1 << 17
"""Bits of the digital inputs 0x60FD of the drive with the safety inputs (docs/safety.md)."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_OPERATING: Final = State.OPERATION_ENABLED
_FAULT_REACTION: Final = State.FAULT_REACTION
_FAULT: Final = State.FAULT
_ENABLED: Final = Goal.ENABLED
_DISABLED: Final = Goal.DISABLED
_QUICK_STOP: Final = Goal.QUICK_STOP
_FREE: Final = Goal.FREE


class CountedInRun(Protocol):
    """A quantity that a kind of machine counts during a run."""

    def store(self, recorder: Recorder, now_s: float) -> None:
        """Store the count at ``now_s`` s."""
        ...


@mypyc_attr(allow_interpreted_subclasses=True)
class DeviceList:
    """Drivers and their ports. A kind inherits from this class and implements ``fill`` and ``apply``.

    ``lines``: ports and links in the order of the rig file. ``modbus``: the devices on them in that order, including
    the further sensors (``sensors``). The channels of these sensors and of the ``nodes`` on the CAN bus are recorded.
    ``news``: a drive's state, an input or an emergency is new in this scan. ``lost``: why a wire is gone; it is never
    used again, because its queued requests must not be sent later.
    """

    def __init__(
        self,
        drivers: RigDrivers,
        prompts: Sequence[ModbusLink],
        retracting: ServoDrive | None = None,
        creeping: ServoDrive | None = None,
    ) -> None:
        """Take the drivers, including those of the kind's own devices.

        ``prompts``: the links that may request extra ticks between two scans; ``retracting``: a drive that stays in
        operation during a quick stop of the others; ``creeping``: the one that alone has power in a cool-down.
        """
        self.can: CanPort = drivers.ports.can
        self.master: CanMaster = drivers.master
        self.drives: tuple[ServoDrive, ...] = tuple(drivers.drives.values())
        self.lines: list[tuple[LinePort, ModbusLink]] = drivers.lines()
        self.sensors: tuple[Sensor, ...] = tuple(drivers.further())
        self.modbus: tuple[FieldDevice, ...] = tuple(drivers.field_devices())
        self.nodes: tuple[SensorNode, ...] = tuple(drivers.nodes)
        self.io = next(drive for drive in self.drives if drive.config.digital_io)
        """The drive with the safety inputs."""
        self.news = True
        self.lost = ""
        self.counted: list[CountedInRun] = []
        """Further counts of a run, stored with the counters of the buses."""
        self.inspector = Inspector(self.modbus)
        self._prompts = tuple(prompts)
        self.can_alive = True
        """Whether commands still reach the drives."""
        self._can_heard_s = NEVER
        self._retracting, self._creeping = retracting, creeping
        self._creeps = False
        self._goal: Goal = _DISABLED
        self._wanted: Goal = _DISABLED
        self._withheld = False
        self._lines: tuple[tuple[LinePort, ModbusLink, ForeseeingPort | None], ...] = ()
        self._watched: tuple[tuple[ModbusLink, ForeseeingPort | None], ...] = ()
        self._foresee()

    def _foresee(self) -> None:
        self._lines = tuple(
            (port, link, port if isinstance(port, ForeseeingPort) else None) for port, link in self.lines
        )
        self._watched = tuple((link, port) for _, link, port in self._lines if link in self._prompts)

    def rewire(self, can: CanPort, lines: Sequence[LinePort]) -> None:
        """Use other ports from now on; ``lines`` in the same order as the present ones."""
        self.can = can
        self.lines = [(port, link) for port, (_, link) in zip(lines, self.lines, strict=True)]
        self._foresee()

    def fill(self, r: Any, now: float) -> None:
        """Update the kind's readings at ``now`` s."""
        raise NotImplementedError

    def apply(self, out: Any) -> None:
        """Pass the kind's setpoints to the drivers; ``transmit`` sends the frames."""
        raise NotImplementedError

    def fill_common(self, r: BaseReadings, now: float) -> None:
        """Fill the readings of every machine: the state of drives and wires, the safety inputs, the further sensors."""
        self.news = False
        for drive in self.drives:
            if drive.news:
                drive.news = drive.stands = False
                self.news = True
        if self.news:
            self._fill_status(r)
        r.inputs_at_s = self.io.inputs_stamp_s
        r.can_heard_s = self._can_heard_s
        if self.lost:
            r.bus_fault = self.lost
        if self.master.foreign_master:
            r.foreign_master = self.master.foreign_frame
        if r.channels:
            self.fill_channels(r.channels, now)
        inspector = self.inspector
        if now >= inspector.due_s:
            inspector.inspect(now)
            r.device_fault, r.line_errors, r.line_fault = inspector.fault, inspector.line_errors, inspector.noisy

    def apply_common(self, out: BaseSetpoints) -> None:
        """Set the goal of every drive. As the last resort, withhold our heartbeat."""
        wanted = _ENABLED if out.enable else _DISABLED
        goal = _FREE if out.power_off or out.voltage_off else _QUICK_STOP if out.quick_stop else wanted
        if goal is not self._goal or wanted is not self._wanted or out.creeps is not self._creeps or self.news:
            self._goal, self._wanted, self._creeps = goal, wanted, out.creeps
            for drive in self.drives:
                if out.creeps and drive is not self._creeping:
                    drive.goal = _FREE
                else:
                    drive.goal = wanted if goal is _QUICK_STOP and drive is self._retracting else goal
        if out.power_off is not self._withheld:
            # Without the heartbeat every drive stops by its own watchdog, even a drive that ignores commands.
            self._withheld = self.master.withhold_heartbeat = out.power_off

    def _fill_status(self, r: BaseReadings) -> None:
        enabled = disabled = True
        fault = ""
        for drive in self.drives:
            state = drive.state
            if state is _OPERATING:
                disabled = False
            else:
                enabled = enabled and self._creeps and drive is not self._creeping
                if not fault and (state is _FAULT or state is _FAULT_REACTION):
                    fault = fault_text(drive)
            if not fault and (
                drive.lost or drive.rebooted or drive.emergency is not None or (drive.connected and not drive.remote)
            ):
                fault = fault_text(drive)
        r.drives_enabled, r.drives_disabled, r.drive_fault = enabled, disabled, fault
        inputs = self.io.inputs
        r.safety_chain = inputs & INPUT_SAFETY_CHAIN != 0
        r.guard_closed = inputs & INPUT_GUARD != 0

    def receive(self, now: float) -> None:
        """Process everything that has arrived; from then on ignore a wire that is lost (``lost`` has the reason)."""
        try:
            frames = self.can.receive(now)
        except BusLost as error:
            self._lose_can(error)
        else:
            # A wire that was lost and has come back is still read, but its data are not trusted.
            if frames and self.can_alive:
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
        self.can_alive = False

    def _lose_line(self, link: ModbusLink, error: BusLost, now: float) -> None:
        """Stop using a line: its values are no longer valid."""
        self.lost = self.lost or f"line lost: {name_of(link, self.modbus)}: {error}"
        self._lines = tuple(entry for entry in self._lines if entry[1] is not link)
        self._watched = tuple((other, None if other is link else port) for other, port in self._watched)
        for station in link.stations:
            station.owner.lost(now)
        link.deadline = inf  # the line is no longer served, and must not ask for extra ticks

    def transmit(self, now: float, *, scan: bool, next_scan_s: float = NEVER) -> float:
        """Send everything due; return the next time at which a driver needs a call. ``next_scan_s``: the next scan, if
        known.
        """
        deadline = inf
        if self.can_alive:
            try:
                if scan:
                    self.master.scan(self.can, now, next_scan_s)
                else:
                    self.master.service(self.can, now)
            except BusLost as error:
                self._lose_can(error)
            else:
                deadline = self.master.deadline
        if scan and next_scan_s > now:
            for link in self._prompts:
                link.scan_s = next_scan_s - now
        self.transmit_lines(now, scan=scan)
        # Only the load cell's lines may ask for an extra tick (a retry has to fit into a scan); the next request on
        # any other line can wait for the next scan. A simulated line knows whether the reply will be in time.
        for watch, wire in self._watched:
            wish = watch.deadline
            if wish >= deadline or wish >= next_scan_s > now:
                continue
            if wire is None or not watch.only_watches or wire.arrives_s > wish:
                deadline = wish
        return deadline

    def transmit_lines(self, now: float, *, scan: bool = True) -> None:
        """Send everything due on the Modbus lines."""
        for port, link, _ in self._lines:
            if now >= link.wants_s:
                try:
                    link.service(port, now, scan=scan)
                except BusLost as error:
                    self._lose_line(link, error, now)

    def fill_channels(self, channels: list[float], now: float) -> None:
        """Update the readings of the further sensors, in place: NaN for a sensor that is not fresh and valid."""
        place = 0
        for sensor in self.sensors:
            fresh = sensor.fresh(now)
            for value in sensor.values:
                channels[place] = value if fresh else nan
                place += 1
        for node in self.nodes:
            fresh = node.fresh(now)
            for value in node.values:
                channels[place] = value if fresh else nan
                place += 1

    def periods_s(self) -> list[float]:
        """Return the periods in which devices are read, s, without those read in every scan."""
        return [period_s for _, link in self.lines for period_s in link.periods_s()]

    def silences(self) -> tuple[str, str]:
        """Return the drives that send no new data while others do, and the Modbus lines on which no device answers, as
        text; "" = none.
        """
        return unheard(self.drives), silent_lines(self.lines, self.modbus)

    def busy(self) -> bool:
        """Return whether an exchange with a node of the CAN bus is under way."""
        return any(self.master.busy(node) for node in self.master.nodes)

    def refused(self) -> str:
        """Return why devices cannot be used, naming all of them; "" if all can."""
        return "; ".join(refusals(self.drives, self.nodes, self.modbus))

    def refused_by_lines(self) -> bool:
        """Return whether the devices that cannot be used are all on Modbus lines."""
        return bool(self.refused()) and not refusals(self.drives, self.nodes, ())

    def without(self) -> list[str]:
        """Return the objects that drives lack, with the consequence, a line each."""
        return [f"{drive.config.name} drive: {text}" for drive in self.drives for text in drive.plan.without]

    def alarm(self) -> bool:
        """Return whether a drive reports something that should not wait until the next regular scan."""
        for drive in self.drives:
            if drive.stands or drive.state >= State.FAULT_REACTION or drive.lost or drive.rebooted:
                return True
            if drive.emergency is not None:
                return True
        return False

    def machine_late(self, from_s: float, to_s: float) -> str:
        """Return that a simulated machine's own computer was late in this time, in words; "" if none reports so."""
        most_ms = 0
        for drive in self.drives:
            for at_s, late_ms in drive.machine_late:
                # The report arrives at the end of the lateness.
                if late_ms > most_ms and at_s >= from_s and at_s - 1e-3 * late_ms <= to_s:
                    most_ms = late_ms
        return f"{EMERGENCY_TEXT[MACHINE_LATE]} by {most_ms} ms" if most_ms else ""

    def bus_silent(self, now: float, longest_s: float) -> bool:
        """Return whether no frame has arrived on the CAN bus for longer than ``longest_s``."""
        return not (now - self._can_heard_s <= longest_s)

    def all_off(self) -> bool:
        """Return whether every drive's power stage is off."""
        return all(drive.state <= State.READY_TO_SWITCH_ON or drive.lost for drive in self.drives)

    def real_lines(self) -> bool:
        """Return whether some Modbus line is real, so that the arrival of its bytes is unpredictable."""
        return any(foreseen is None for _, _, foreseen in self._lines)

    def answering(self) -> bool:
        """Return whether every Modbus device, and every node that measures, has reported a valid value."""
        if any(node.stamp_s == -inf for node in self.nodes):
            return False
        return all(device.driver.stamp_s > -inf and device.driver.valid for device in self.modbus)

    def missing(self) -> list[str]:
        """Return the names of devices that have not answered."""
        names = [node.name for node in self.master.nodes if self.master.busy(node) or not node.online]
        return names + [device.title for device in self.modbus if not device.driver.valid]
