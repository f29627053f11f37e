"""Texts about devices that are silent, refuse requests or report a fault, to accompany a trip."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from drivers.canopen.sensor_node import SensorNode
from drivers.modbus import ModbusLink
from drivers.ports import LinePort
from drivers.servo import ServoDrive
from tester.machine.modbus_health import FieldDevice

SPREAD_S: Final = 0.015
"""A drive whose data are older than the others' by more than this counts as missing, s [A]: drives answer one SYNC
within 2 ms of each other.
"""


def unheard(drives: Sequence[ServoDrive]) -> str:
    """Return the drives whose data are older than the others', as text; "" if the whole bus is silent."""
    oldest = newest = drives[0].stamp_s
    for drive in drives:
        stamp_s = drive.stamp_s
        if stamp_s < oldest:
            oldest = stamp_s
        elif stamp_s > newest:
            newest = stamp_s
    if newest - oldest <= SPREAD_S:
        return ""
    behind = [drive.config for drive in drives if newest - drive.stamp_s > SPREAD_S]
    return ", ".join(f"{config.name} drive (node {config.node_id}) not heard" for config in behind)


def silent_lines(lines: Sequence[tuple[LinePort, ModbusLink]], modbus: Sequence[FieldDevice]) -> str:
    """Return the Modbus lines on which no device answers, with their devices, as text; "" = none."""
    for _, link in lines:
        for station in link.stations:
            if station.is_lost:
                return _silent(lines, modbus)
    return ""


def _silent(lines: Sequence[tuple[LinePort, ModbusLink]], modbus: Sequence[FieldDevice]) -> str:
    texts: list[str] = []
    for _, link in lines:
        there = [device for device in modbus if device.driver.link is link]
        stations = [device.driver.station for device in there]
        # One station is lost, and each other has since missed a request; those would count as lost only later.
        if any(station.is_lost for station in stations) and all(station.misses for station in stations):
            texts.append(f"no answer on line {there[0].line}: {', '.join(device.title for device in there)}")
    return "; ".join(texts)


def name_of(link: ModbusLink, modbus: Sequence[FieldDevice]) -> str:
    """Return a line's name in the rig file, with its devices."""
    there = [device for device in modbus if device.driver.link is link]
    return f"{there[0].line} ({', '.join(device.title for device in there)})" if there else "unnamed"


def refusals(drives: Sequence[ServoDrive], nodes: Sequence[SensorNode], modbus: Sequence[FieldDevice]) -> list[str]:
    """Return why devices cannot be used, a text for each."""
    texts = [f"{drive.config.name} drive (node {drive.node_id}): {drive.refused}" for drive in drives if drive.refused]
    texts += [f"{node.name} (node {node.node_id}): {node.refused}" for node in nodes if node.refused]
    return texts + [f"{device.title}: {device.driver.refused}" for device in modbus if device.driver.refused]


def fault_text(drive: ServoDrive) -> str:
    """Return a drive's fault in words."""
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
