"""Rehearses the arming of a run with what was read: its drivers, its checks and its interlocks, without wires.

What prevents a run is judged in one place, by the run's own code. The readings of the watch are given to the drivers in
their order, and control looks at each of its scans, as in a run that has armed and commands nothing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from struct import pack
from typing import Final

from drivers.canopen import objects as o
from drivers.ports import CanFrame, CanWatcher, LineWatcher, Unwatch
from drivers.process_data import actual_of, tpdo1_of
from drivers.temperature_controller import TemperatureController
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, ok, warning
from tester.doctor.line_survey import UnitSurvey
from tester.machine.connect import Arming
from tester.machine.devices import DeviceList
from tester.machine.modbus_health import FieldDevice
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.run import Run
from tester.machine.run_parts import NoAttendant, RunSetup
from tester.run.kind_lookup import run_parts
from tester.store.recorder import NullRecorder

MOST_S: Final = 20.0
"""The longest time that is rehearsed, s [A]: every delay of an interlock that needs no motion is shorter."""


class NoLine:
    """A Modbus line without devices."""

    def write(self, data: bytes, now: float) -> None:
        """Drop the bytes."""

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return nothing."""
        return []

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Pass nothing to the watcher."""
        return lambda: None


class ReadDrives:
    """A CAN bus whose drives repeat what was read of them."""

    def __init__(self) -> None:
        """Repeat nothing yet."""
        self.frames: list[tuple[int, bytes]] = []

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Drop the frame."""

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Drop the frames."""

    def receive(self, now: float) -> list[CanFrame]:
        """Return a frame of each kind from each drive."""
        return [(now, can_id, data) for can_id, data in self.frames]

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Pass nothing to the watcher."""
        return lambda: None


def complete(e: Examination) -> bool:
    """Return whether everything that a run reads has been read; what is missing has its own finding."""
    states = [e.can.number(config.node_id, (o.STATUSWORD, 0)) for config in e.rig.drives().values()]
    units = [unit for line in e.lines.values() for unit in line.units.values()]
    watched = [e.watch.units.get(key) for line in e.lines.values() for key in line.units]
    return None not in states and all(answer.ok for unit in units for answer in unit.blocks) and all(
        watch is not None and watch.values for watch in watched
    )  # fmt: skip


def arming(e: Examination) -> Iterator[Finding]:
    """Report why a run of this rig would not arm, as far as that shows without motion."""
    if not complete(e):
        return
    rehearsed = _Rehearsal(e, ReadDrives())
    why = _obstacle(e, rehearsed)
    if why:
        yield fault("run", why, rehearsed.causes(why) or "what it names")
    else:
        yield ok("run", "nothing that was read prevents arming")
        engine = rehearsed.run.engine
        for doubt in engine.control.doubts(engine.ctx.readings):
            yield warning("run", doubt, "look at the sensors that it names")


def _obstacle(e: Examination, rehearsed: _Rehearsal) -> str:
    """Return why a run would not arm, or would trip before its first contact; "" where nothing was found."""
    now, period_s = rehearsed.begun_s, 1.0 / e.rig.scan.sliding_hz
    rehearsed.read(now)  # twice: a speed may come from two positions
    now += period_s
    why = rehearsed.begin(now)
    while not why and now < rehearsed.begun_s + min(MOST_S, e.watch.seconds):
        now += period_s
        why = rehearsed.scan(now, period_s)
    return why


class _Rehearsal:
    """A run on no wires, one scan after the other."""

    def __init__(self, e: Examination, can: ReadDrives) -> None:
        kind = run_parts(e.rig)
        plan = kind.plan("rehearsal of the doctor", (), (), 1)
        ports = Ports(can, {name: NoLine() for name in e.rig.lines})
        self.run: Run = kind.build(RunSetup(e.rig, plan, ports, NoAttendant(), NullRecorder(), Prompts()))
        self.units = {key: unit for line in e.lines.values() for key, unit in line.units.items()}
        self.readings = {key: deque(e.watch.units[key].values) for key in self.units}
        self.begun_s = max(readings[0][0] for readings in self.readings.values())
        devices: DeviceList = self.run.engine.devices
        self.devices, self.arming = devices, self.run.connector.arming
        for device in devices.modbus:
            device.driver.ready = True
        for drive in devices.drives:
            node, io = drive.config.node_id, drive.config.digital_io
            state = e.can.number(node, (o.STATUSWORD, 0)) or 0
            actual = e.can.number(node, actual_of(drive.config)) or 0
            inputs = e.can.number(node, (o.DIGITAL_INPUTS, 0)) or 0
            drive.finish_connect(state, actual, drive.config.io.from_drive(inputs) if io else 0)
            mapped = tpdo1_of(drive.config)
            can.frames.append((o.TPDO1_BASE + node, mapped.pack(*(state, actual, 0)[: len(mapped.fields)])))
            can.frames.append((o.HEARTBEAT_BASE + node, bytes((o.NmtState.OPERATIONAL,))))
            if io:
                can.frames.append((o.TPDO2_BASE + node, pack("<I", inputs & 0xFFFF_FFFF)))

    def begin(self, now: float) -> str:
        """Arm at ``now`` s; return why it is refused."""
        self.read(now)
        arming: Arming[DeviceList, object] = self.arming  # pyright: ignore[reportAssignmentType, reportInvalidTypeArguments]
        refused = arming.unfit(now, now) or arming.at_rest()
        if refused:
            return f"not armed: {refused}"
        return str(self.run.engine.control.start(self.run.engine.ctx.readings))

    def scan(self, now: float, period_s: float) -> str:
        """Look at the readings up to ``now`` s; return why a run would end."""
        self.read(now)
        engine = self.run.engine
        engine.control.step(engine.ctx.demand, engine.ctx.readings, period_s)
        trip = engine.control.state.trip
        return f"{trip.name}: {trip.text}" if trip is not None else self.arming.at_rest()

    def causes(self, why: str) -> str:
        """Return the causes of the interlocks that a refusal names."""
        rows = self.run.engine.control.table.rows
        return "; ".join(dict.fromkeys(row.cause for row in rows if row.name in why))

    def read(self, now: float) -> None:
        """Give the drivers what was read up to ``now`` s, and fill the process image."""
        self.devices.receive(now)
        for device in self.devices.modbus:
            self._take(device, self.units[device.name], now)
        ctx = self.run.engine.ctx
        ctx.now = now
        ctx.before_reading()
        self.devices.fill(ctx.readings, now)
        ctx.after_reading()

    def _take(self, device: FieldDevice, unit: UnitSurvey, now: float) -> None:
        """Give a device's driver its newest reading at ``now`` s, as new: its age is judged elsewhere."""
        readings = self.readings[device.name]
        while len(readings) > 1 and readings[1][0] <= now:
            readings.popleft()
        device.driver.take(0, readings[0][1], now)
        for number, answer in enumerate(unit.blocks[1:], start=1):
            device.driver.take(number, answer.data, now)
        if isinstance(device.driver, TemperatureController) and unit.switched_on:
            device.driver.output_percent = 0.0  # a connection puts it in standby
