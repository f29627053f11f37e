"""Rows of the fault catalogue that every machine on these wires has: of each drive, of the bus, of the computer.

Each machine passes the members of its own enumeration that say from when a fault can be noticed: ``always``,
``connecting``, ``drives`` (once every drive is configured), ``enabled`` (while the drives are on). Budgets are those of
docs/safety.md, with one scan at the slow rate on top.
"""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from functools import partial
from typing import Final

from drivers.canopen import objects as o
from sim.faults import can, drives, operation
from sim.faults.kinds import Expected, FaultKind

OVERCURRENT: Final = 0x2310
SCAN_S: Final = 0.05
"""The slow scan's period: what is noticed by a scan is noticed this much later at most, s."""
_TRIP: Final = Expected.TRIP


def drive_rows(axis: str, drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield what any drive can do."""
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
    """Yield how a drive leaves operation without a fault."""
    yield FaultKind(f"{axis} drive in local mode", partial(drives.local, axis), enabled, _TRIP, 0.1 + SCAN_S)
    yield FaultKind(f"{axis} drive torque off", partial(drives.torque_off, axis), enabled, _TRIP, 0.1 + SCAN_S)


def connecting_rows(axis: str, connecting: Enum) -> Iterator[FaultKind]:
    """Yield what the next connection finds."""
    yield FaultKind(f"{axis} drive of another make", partial(drives.wrong_identity, axis), connecting, _TRIP, 3.0)
    yield FaultKind(f"{axis} drive SDO abort", partial(drives.sdo_spoiled, axis, "abort"), connecting, _TRIP, 3.0)


def bus_rows(drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield how the bus and the safety inputs fail."""
    yield FaultKind("CAN adapter gone", can.adapter_gone, drives_on, _TRIP, SCAN_S)
    yield FaultKind("CAN bus off", can.bus_silent, drives_on, _TRIP, 0.2 + SCAN_S)
    yield FaultKind("safety chain opened", operation.chain_open, drives_on, _TRIP, SCAN_S)
    yield FaultKind("guard opened", operation.guard_open, enabled, _TRIP, SCAN_S)


def computer_rows(always: Enum, drives_on: Enum, enabled: Enum) -> Iterator[FaultKind]:
    """Yield what the computer and its operator do."""
    yield FaultKind("scan stalled", operation.stalled, enabled, _TRIP, 0.4 + SCAN_S, "ms", 0.4, lasts_s=0.5,
                    note="tripped by the first scan after it; a drive stops by itself after 0.2 s")
    yield FaultKind("process killed", operation.killed, always, Expected.DEVICES, 0.25)
    yield FaultKind("operator hold", partial(operation.operator, "hold"), drives_on, Expected.HOLD, SCAN_S)
    yield FaultKind("operator release", partial(operation.operator, "release"), always, Expected.RIDE, 0.0)
    for action in ("abort", "stop", "fast stop"):
        yield FaultKind(f"operator {action}", partial(operation.operator, action), drives_on, Expected.STOP,
                        SCAN_S)
