"""Rows of the fault catalogue for every machine on these wires: faults of drives, bus, devices and computer.

Each machine passes the members of its own enumeration of the times at which a fault can be noticed: ``always``,
``connecting``, ``drives`` (once every drive is configured), ``enabled`` (while the drives are on). Budgets are those of
docs/safety.md, with one scan at the slow rate added.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum
from functools import partial
from typing import Final

from drivers.canopen import objects as o
from sim.faults import cabinet, can, drives, modbus
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultLanguage
from sim.wires.modbus_wire import Kind

OVERCURRENT: Final = 0x2310
SCAN_S: Final = 0.05
"""Period of the slow scan, s: the greatest delay until a scan notices a fault."""
_TRIP: Final = Expected.TRIP


def drive_rows(axis: str, drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield the faults that any drive can have."""
    for what, make, budget_s in (
        ("fault", partial(drives.drive_fault, axis, OVERCURRENT), 0.02),
        ("heartbeat lost", partial(drives.heartbeat_lost, axis), 0.2),
        ("off the bus", partial(can.node_cut, axis), 0.2),
        ("without supply", partial(drives.unpowered, axis), 0.2),
    ):
        yield FaultKind(f"{axis} drive {what}", make, drives_on, _TRIP, budget_s + SCAN_S)
    yield FaultKind(f"{axis} drive reboots", partial(drives.reboot, axis), drives_on, _TRIP, 0.25 + SCAN_S,
                    lasts_s=1.0, note="its boot-up message comes after 0.2 s")
    yield FaultKind(f"{axis} drive data lost", partial(can.frames_lost, axis, o.TPDO1_BASE), enabled, _TRIP,
                    0.15 + SCAN_S)


def left_operation_rows(axis: str, enabled: Enum) -> Iterator[FaultKind]:
    """Yield the ways in which a drive leaves operation without a fault."""
    yield FaultKind(f"{axis} drive in local mode", partial(drives.local, axis), enabled, _TRIP, 0.1 + SCAN_S)
    yield FaultKind(f"{axis} drive torque off", partial(drives.torque_off, axis), enabled, _TRIP, 0.1 + SCAN_S)


def connecting_rows(axis: str, connecting: Enum) -> Iterator[FaultKind]:
    """Yield the faults that the next connection finds."""
    yield FaultKind(f"{axis} drive of another make", partial(drives.wrong_identity, axis), connecting, _TRIP, 3.0)
    yield FaultKind(f"{axis} drive SDO abort", partial(drives.sdo_spoiled, axis, "abort"), connecting, _TRIP, 3.0)


_SPOILED: Final[tuple[tuple[str, Kind], ...]] = (
    ("silent", "silence"), ("CRC errors", "corrupt"), ("replies cut short", "truncate"),
)  # fmt: skip


def device_rows(device: str, needed: Enum, budget_s: float) -> Iterator[FaultKind]:
    """Yield the ways in which a Modbus device stops answering; ``needed``: when its readings begin to be needed."""
    for what, kind in _SPOILED:
        yield FaultKind(f"{device} {what}", partial(modbus.Impaired, device, kind), needed, _TRIP, budget_s)
    yield FaultKind(f"{device} without supply", partial(modbus.device_off, device), needed, _TRIP, budget_s)


def bus_rows(drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield the faults of the bus and the safety inputs."""
    yield FaultKind("CAN adapter gone", can.adapter_gone, drives_on, _TRIP, SCAN_S)
    yield FaultKind("CAN bus off", can.bus_silent, drives_on, _TRIP, 0.2 + SCAN_S)
    yield FaultKind("safety chain opened", cabinet.chain_open, drives_on, _TRIP, SCAN_S)
    yield FaultKind("guard opened", cabinet.guard_open, enabled, _TRIP, SCAN_S)


def computer_rows(always: Enum, drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield the faults of the computer and the requests of its operator."""
    yield FaultKind("scan stalled", cabinet.stalled, enabled, _TRIP, 0.4 + SCAN_S, "ms", 0.4, lasts_s=0.5,
                    note="tripped by the first scan after it; a drive stops by itself after 0.2 s")
    yield FaultKind("process killed", cabinet.killed, always, Expected.DEVICES, 0.25)
    yield FaultKind("operator hold", partial(cabinet.operator, "hold"), drives_on, Expected.HOLD, SCAN_S)
    yield FaultKind("operator release", partial(cabinet.operator, "release"), always, Expected.RIDE, 0.0)
    for action in ("abort", "stop", "fast stop"):
        yield FaultKind(f"operator {action}", partial(cabinet.operator, action), drives_on, Expected.STOP,
                        SCAN_S)


PLAIN_STEPS: Final = ("connect", "mount", "settle", "slide")
"""Names of steps that a fault can wait for."""


class PlainExposure(Enum):
    """The earliest time at which a fault can be noticed."""

    ALWAYS = "at once, once the run has begun"
    DRIVES = "at once, once every drive is configured"
    ENABLED = "while the drives are on"
    MOVING = "while something moves"


_ALWAYS, _DRIVES = PlainExposure.ALWAYS, PlainExposure.DRIVES
_ENABLED, _MOVING = PlainExposure.ENABLED, PlainExposure.MOVING


def plain_language(axes: Iterable[str], sensors: Iterable[str], *own: FaultKind) -> FaultLanguage:
    """Return the language of a plain machine's fault scripts; ``sensors``: their names for people."""
    rows = [*own, *bus_rows(_DRIVES, _ENABLED), *computer_rows(_ALWAYS, _DRIVES, _ENABLED)]
    for axis in axes:
        rows += [*drive_rows(axis, _DRIVES, _ENABLED), *left_operation_rows(axis, _ENABLED)]
        rows.append(FaultKind(f"{axis} drive jammed", partial(drives.Jammed, axis), _MOVING, _TRIP, 1.2 + SCAN_S))
    rows += [row for device in sensors for row in device_rows(device, _ENABLED, 0.3 + SCAN_S)]
    return FaultLanguage({row.phrase: row for row in rows}, PLAIN_STEPS)
