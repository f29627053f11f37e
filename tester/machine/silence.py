"""Who is silent, refuses or is at fault, in words: what stands beside whatever trips."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from drivers.canopen.sensor_node import SensorNode
from drivers.modbus import ModbusLink
from drivers.ports import LinePort
from drivers.servo import ServoDrive
from tester.machine.field_device import FieldDevice

SPREAD_S: Final = 0.015
"""Drives answer one SYNC, within 2 ms of each other: one that is further behind the others is missing, s [A]."""


def unheard(drives: Sequence[ServoDrive]) -> str:
    """Name the drives that are behind the others: of a bus that is silent as a whole, none."""
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
    return ", ".join(f"{one.name} drive (node {one.node_id}) not heard" for one in behind)


def silent_lines(lines: Sequence[tuple[LinePort, ModbusLink]], modbus: Sequence[FieldDevice]) -> str:
    """Name the Modbus lines on which no device answers, with the devices; "" = none."""
    for _, link in lines:
        for station in link.stations:
            if station.is_lost:
                return _silent(lines, modbus)
    return ""


def _silent(lines: Sequence[tuple[LinePort, ModbusLink]], modbus: Sequence[FieldDevice]) -> str:
    found: list[str] = []
    for _, link in lines:
        there = [one for one in modbus if one.driver.link is link]
        stations = [one.driver.station for one in there]
        # One is lost, and the others have not answered since: their own loss takes as long again.
        if any(one.is_lost for one in stations) and all(one.misses for one in stations):
            found.append(f"nobody answers on line {there[0].line}: {', '.join(one.title for one in there)}")
    return "; ".join(found)


def name_of(link: ModbusLink, modbus: Sequence[FieldDevice]) -> str:
    """Return a line's name in the rig file, with the devices on it."""
    there = [one for one in modbus if one.driver.link is link]
    return f"{there[0].line} ({', '.join(one.title for one in there)})" if there else "unnamed"


def refusals(drives: Sequence[ServoDrive], nodes: Sequence[SensorNode], modbus: Sequence[FieldDevice]) -> list[str]:
    """Return why devices cannot be used, a text each."""
    said = [f"{one.config.name} drive (node {one.node_id}): {one.refused}" for one in drives if one.refused]
    said += [f"{one.name} (node {one.node_id}): {one.refused}" for one in nodes if one.refused]
    return said + [f"{one.title}: {one.driver.refused}" for one in modbus if one.driver.refused]


def fault_text(drive: ServoDrive) -> str:
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
