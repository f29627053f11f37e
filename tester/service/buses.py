"""The devices and buses of a run as clients see them: states, ages, errors."""

from __future__ import annotations

from math import inf

from drivers.canopen.sensor_node import SensorNode
from drivers.servo import ServoDrive
from tester.inputs.rig import Rig
from tester.machine.devices import DeviceList
from tester.machine.modbus_health import FieldDevice
from tester.service.state_view import BusView, DeviceView


class BusWatch:
    """Reads the devices of one run."""

    def __init__(self, devices: DeviceList, rig: Rig) -> None:
        """Only read: send nothing."""
        self.devices = devices
        self.rig = rig
        self._emergencies: dict[str, int] = {}

    def count_emergency(self, text: str) -> None:
        """Count an emergency for the drive whose name begins its text."""
        name = text.partition(" drive")[0]
        self._emergencies[name] = self._emergencies.get(name, 0) + 1

    def device_views(self, now: float) -> tuple[DeviceView, ...]:
        """Return the view of every device at ``now`` s by the clock of the wires: leaps have no part in it."""
        hours = max(now, 60.0) / 3600.0
        drives = [self._drive(drive, now, hours) for drive in self.devices.drives]
        nodes = [self._node(node, now, hours) for node in self.devices.nodes]
        return (*drives, *nodes, *(self._reader(device, now, hours) for device in self.devices.modbus))

    def _drive(self, drive: ServoDrive, now: float, hours: float) -> DeviceView:
        name = drive.config.name
        errors = drive.malformed + self._emergencies.get(name, 0)
        detail = drive.refused or ("heartbeat lost" if drive.lost else "")
        if not detail and drive.emergency is not None:
            detail = f"{drive.emergency.text} (0x{drive.emergency.code:04X})"
        state = drive.state.name.lower().replace("_", " ")
        return DeviceView(name, "drive", "can", drive.config.node_id, state, drive.online,
                          _age(now, drive.stamp_s), 0, errors, errors / hours, detail)  # fmt: skip

    def _node(self, node: SensorNode, now: float, hours: float) -> DeviceView:
        state = "refused" if node.refused else "lost" if node.lost else "operational" if node.online else "set up"
        detail = node.refused or ("heartbeat lost" if node.lost else "")
        return DeviceView(node.name, "sensor", "can", node.node_id, state, node.online,
                          _age(now, node.stamp_s), 0, node.malformed, node.malformed / hours, detail)  # fmt: skip

    def _reader(self, listed: FieldDevice, now: float, hours: float) -> DeviceView:
        device, title = listed.driver, listed.title
        counters = device.station.counters
        exceptions = sum(counters.exceptions.values())
        errors = counters.timeouts + counters.crc_errors + counters.garbage + counters.late + exceptions
        state = "refused" if device.refused else "lost" if device.is_lost else "ready" if device.ready else "set up"
        detail = device.refused or ""
        if errors and not detail:
            detail = f"time-outs {counters.timeouts}, CRC {counters.crc_errors}, late {counters.late}"
            detail += f", garbage {counters.garbage}, exceptions {exceptions}"
        return DeviceView(title, title, listed.line, device.station.unit_id, state, device.ready and not device.is_lost,
                          _age(now, device.stamp_s), counters.requests, errors, errors / hours, detail)  # fmt: skip

    def bus_views(self) -> tuple[BusView, ...]:
        """Return the view of every bus."""
        busy = getattr(self.devices.can, "load", None)  # a share of time; only a simulated bus reports it
        load = 100.0 * busy if isinstance(busy, float) else None
        errors = sum(drive.malformed for drive in self.devices.drives) + sum(self._emergencies.values())
        views = [BusView("can", "can", load, errors, f"{self.rig.can.bitrate // 1000} kbit/s")]
        for (name, config), (_, link) in zip(self.rig.lines.items(), self.devices.lines, strict=True):
            failed = sum(
                s.counters.timeouts + s.counters.crc_errors + s.counters.garbage + s.counters.late
                for s in link.stations
            )
            views.append(BusView(name, "modbus", None, failed + link.garbage, f"{config.baud} baud, {config.framing}"))
        return tuple(views)


def _age(now: float, at_s: float) -> float | None:
    """Return the age of data in s; None if there are none."""
    return None if at_s == -inf else max(now - at_s, 0.0)
