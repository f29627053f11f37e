"""A load cell as the rig file describes it: one transmitter with every channel, or several that are part of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from drivers.joined_cell import JoinedCell, LoadCell, Transmitter
from drivers.modbus import Device, ModbusLink
from drivers.sensor import Sensor
from tester.inputs.rig import DeviceConfig, LineConfig, Rig
from tester.inputs.rig.profiles import profile_of
from tester.inputs.rig.sensors import parts_of, title_of


def link_of(config: LineConfig) -> ModbusLink:
    """Return the master of a line."""
    return ModbusLink(config.framing, config.baud, config.parity)


def sensor_of(
    config: DeviceConfig, links: Mapping[str, ModbusLink], channels: tuple[str, ...] = ()
) -> Sensor:
    """Return the driver of a sensor, on its line; ``channels``: the wanted ones, all of the profile by default."""
    return Sensor(profile_of(config.profile), config.unit_id, links[config.line], channels, config.parameters)


def load_cell_of(
    rig: Rig, links: Mapping[str, ModbusLink], channels: Sequence[str], most_skew_s: float
) -> tuple[LoadCell, dict[str, Device]]:
    """Return a rig's load cell with these channels, and its drivers by their keys in the rig file.

    ``most_skew_s``: how far the parts of a reading may lie apart, where it has several transmitters.
    """
    parts = parts_of(rig, "load_cell")
    if not parts:
        cell = sensor_of(rig.devices["load_cell"], links, tuple(channels))
        return cell, {"load_cell": cell}
    found = {
        name: Transmitter(
            title_of(rig, name), profile_of(one.profile), one.unit_id, links[one.line], one.channels, one.parameters
        )
        for name, one in parts.items()
    }
    return JoinedCell(list(found.values()), channels, most_skew_s), dict[str, Device](found)
