"""The devices of a plain machine: a drive for each axis of the rig file, a sensor for each profile."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, nan
from typing import Final

from drivers.canopen.master import CanMaster
from drivers.canopen.sensor_node import SensorNode
from drivers.cia402 import Goal
from drivers.modbus import ModbusLink
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from tester.inputs.rig.plain import PlainRig
from tester.inputs.rig.profiles import profile_of
from tester.inputs.rig.sensors import title_of
from tester.machine.devices import NEVER, DeviceList
from tester.machine.field_device import FieldDevice
from tester.machine.plain.image import PlainReadings, PlainSetpoints
from tester.machine.ports import Ports

STANDING_SHARE: Final = 0.01
"""A drive slower than this share of its greatest speed stands [A]."""


class PlainDevices(DeviceList):
    """Drivers by their names in the rig file. ``own``: the sensors that are the machine's, as its kind says."""

    def __init__(self, rig: PlainRig, ports: Ports) -> None:
        """Build drivers on these wires; nothing is sent."""
        master = CanMaster(rig.can.node, rig.can.heartbeat_s)
        self.named = {name: ServoDrive(axis) for name, axis in rig.axes.items()}
        nodes = [SensorNode(config) for config in rig.can.nodes.values()]
        for node in (*self.named.values(), *nodes):
            master.add(node)
        links = {name: ModbusLink(line.framing, line.baud, line.parity) for name, line in rig.lines.items()}
        drivers = {
            name: Sensor(profile_of(one.profile), one.unit_id, links[one.line], (), one.parameters)
            for name, one in rig.devices.items()
        }
        self.own = {name: drivers[name] for name in rig.own if name in drivers}
        super().__init__(
            ports.can,
            master,
            list(self.named.values()),
            [(ports.lines[name], link) for name, link in links.items()],
            [
                FieldDevice(name, title_of(rig, name), one.line, drivers[name])
                for name, one in rig.devices.items()
            ],
            [driver for name, driver in drivers.items() if name not in rig.own],
            nodes,
            (next(iter(self.own.values())).link,),
        )  # fmt: skip
        self.io = next(drive for drive in self.drives if drive.config.digital_io)
        """The drive with the safety inputs."""
        self._goal = Goal.DISABLED
        self._withheld = False
        self._unknown: dict[str, Sequence[float]] = {
            name: [nan] * len(sensor.channels) for name, sensor in self.own.items()
        }

    def fill(self, r: PlainReadings, now: float) -> None:
        """Bring the readings up to date; the kind's own channels last (``PlainReadings.update``)."""
        dt = now - r.now_s
        r.now_s = now
        at_s, standing = inf, True
        for name, drive in self.named.items():
            r.drives[name] = drive.actual
            at_s = drive.stamp_s if drive.stamp_s < at_s else at_s
            standing = standing and abs(drive.actual) <= STANDING_SHARE * drive.config.max_speed
        r.drives_at_s, r.standing, r.inputs_at_s = at_s, standing, self.io.inputs_stamp_s
        self.news = any(drive.news for drive in self.drives)
        if self.news:
            for drive in self.drives:
                drive.news = drive.stands = False
            self.fill_status(r, self.io)
        r.can_heard_s = self._can_heard_s
        self.fill_unheard(r)
        self.fill_silent(r)
        r.bus_fault = self.lost or r.bus_fault
        if self.master.foreign_master:
            r.foreign_master = self.master.foreign_frame
        at_s = inf
        for name, sensor in self.own.items():
            r.sensors[name] = sensor.values if sensor.fresh(now) else self._unknown[name]
            at_s = min(at_s, sensor.stamp_s if sensor.valid else NEVER)
        r.sensors_at_s = at_s
        if r.channels:
            self.fill_channels(r.channels, now)
        if now >= self.inspector.due_s:
            self.inspector.inspect(now)
            r.device_fault, r.line_errors = self.inspector.fault, self.inspector.line_errors
            r.line_fault = self.inspector.noisy
        r.update(dt if dt <= 1.0 else 0.0)

    def apply(self, out: PlainSetpoints) -> None:
        """Hand the setpoints to the drives; the frames leave with ``transmit``."""
        wanted = Goal.ENABLED if out.enable else Goal.DISABLED
        goal = Goal.FREE if out.power_off else Goal.QUICK_STOP if out.quick_stop else wanted
        if goal is not self._goal or self.news:
            self._goal = goal
            for drive in self.drives:
                drive.goal = goal
        for name, speed in out.speeds.items():
            drive = self.named[name]
            if speed != drive.aimed:
                drive.aim(speed)
        if out.power_off is not self._withheld:
            # The last resort reaches a drive that takes no commands, too: each stops without our heartbeat.
            self._withheld = self.master.withhold_heartbeat = out.power_off
