"""Drivers of everything on a rig file's wires: drives, nodes and Modbus devices. Building them sends nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from drivers.canopen.master import CanMaster
from drivers.canopen.sensor_node import SensorNode
from drivers.joined_cell import JoinedCell, LoadCell
from drivers.modbus import Device, ModbusLink
from drivers.ports import LinePort
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from drivers.temperature_controller import ControllerKind, TemperatureController
from tester.inputs.rig import DeviceConfig, Rig
from tester.inputs.rig.further_sensors import further_sensors, title_of, transmitters_of
from tester.inputs.rig.profiles import profile_of
from tester.machine.modbus_health import FieldDevice
from tester.machine.rig_ports import Ports


class RigDrivers:
    """Drivers by their names in the rig file. A kind only adds its own Modbus devices to ``devices``."""

    def __init__(self, rig: Rig, ports: Ports) -> None:
        """Build the drives, the nodes and the masters of all lines."""
        self.rig, self.ports = rig, ports
        self.master = CanMaster(rig.can.node, rig.can.heartbeat_s)
        self.drives = {name: ServoDrive(axis) for name, axis in rig.drives().items()}
        self.nodes = [SensorNode(config) for config in rig.can.nodes.values()]
        for node in (*self.drives.values(), *self.nodes):
            self.master.add(node)
        self.links = {
            name: ModbusLink(line.framing, line.baud, line.parity, line.stop_bits) for name, line in rig.lines.items()
        }
        self.devices: dict[str, Device] = {}

    def sensor(self, name: str, channels: tuple[str, ...] = ()) -> Sensor | None:
        """Add the driver of one of the kind's sensors and return it; None if the rig lacks it."""
        config = self.rig.devices.get(name)
        if config is None:
            return None
        sensor = self.devices[name] = sensor_of(config, self.links, channels)
        return sensor

    def controller(self, kind: ControllerKind) -> TemperatureController:
        """Add the driver of the rig's temperature controller of this kind, and return it. The kind is also the device's
        name.
        """
        config = self.rig.devices[kind]
        controller = self.devices[kind] = TemperatureController(
            kind, profile_of(config.profile), config.unit_id, self.links[config.line]
        )
        return controller

    def further(self) -> list[Sensor]:
        """Add the further sensors and return them. They come last, so that a shared line serves the kind's own devices
        first.
        """
        further = {name: sensor_of(config, self.links) for name, config in further_sensors(self.rig).items()}
        self.devices |= further
        return list(further.values())

    def lines(self) -> list[tuple[LinePort, ModbusLink]]:
        """Return the port and the master of every line."""
        return [(self.ports.lines[name], link) for name, link in self.links.items()]

    def field_devices(self) -> list[FieldDevice]:
        """Return every Modbus device in the order of the rig file."""
        shown = {name: own.shown for name, own in self.rig.own.items() if own.shown}
        return [
            FieldDevice(name, shown.get(name, title_of(self.rig, name)), config.line, self.devices[name])
            for name, config in self.rig.devices.items()
        ]


def sensor_of(config: DeviceConfig, links: Mapping[str, ModbusLink], channels: tuple[str, ...] = ()) -> Sensor:
    """Return the driver of a sensor on its line; ``channels``: those to read, by default all of the profile."""
    return Sensor(profile_of(config.profile), config.unit_id, links[config.line], channels, config.parameters)


def load_cell_of(
    rig: Rig, links: Mapping[str, ModbusLink], channels: Sequence[str], most_skew_s: float
) -> tuple[LoadCell, dict[str, Device]]:
    """Return a rig's load cell with these channels, and its drivers by their keys in the rig file.

    ``most_skew_s``: greatest time between the parts of one reading, where several transmitters contribute.
    """
    transmitters = transmitters_of(rig, links)
    if not transmitters:
        cell = sensor_of(rig.devices["load_cell"], links, tuple(channels))
        return cell, {"load_cell": cell}
    return JoinedCell(list(transmitters.values()), channels, most_skew_s), dict[str, Device](transmitters)
