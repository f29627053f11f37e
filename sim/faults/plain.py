"""Faults of any machine on these wires: its drives, its bus, its sensors, its computer. A kind adds its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum
from functools import partial
from typing import Final

from drivers.canopen import objects as o
from sim.faults import actuators, can, drives, modbus, operator_faults
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultLanguage
from sim.wires.modbus_wire import Kind

OVERCURRENT: Final = 0x2310
SCAN_S: Final = 0.05
"""The slow scan's period: what is noticed by a scan is noticed this much later at most, s."""
STEPS: Final = ("connect", "mount", "settle", "slide")
"""Names of steps that a fault can wait for."""


class PlainExposure(Enum):
    """When a fault can be noticed at all."""

    ALWAYS = "at once, once the run has begun"
    DRIVES = "at once, once every drive is configured"
    ENABLED = "while the drives are on"
    MOVING = "while something moves"


_ALWAYS, _DRIVES = PlainExposure.ALWAYS, PlainExposure.DRIVES
_TRIP: Final = Expected.TRIP
_SPOILED: Final[tuple[tuple[str, Kind], ...]] = (("silent", "silence"), ("CRC errors", "corrupt"))
_ENABLED, _MOVING = PlainExposure.ENABLED, PlainExposure.MOVING


def _of_drive(axis: str) -> Iterator[FaultKind]:
    yield FaultKind(f"{axis} drive fault", partial(drives.DriveFault, axis, OVERCURRENT), _DRIVES, _TRIP, 0.02 + SCAN_S)
    yield FaultKind(f"{axis} drive heartbeat lost", partial(drives.HeartbeatLost, axis), _DRIVES, _TRIP, 0.2 + SCAN_S)
    yield FaultKind(f"{axis} drive off the bus", partial(can.NodeCut, axis), _DRIVES, _TRIP, 0.2 + SCAN_S)
    yield FaultKind(
        f"{axis} drive data lost", partial(can.FramesLost, axis, o.TPDO1_BASE), _ENABLED, _TRIP, 0.2 + SCAN_S
    )
    yield FaultKind(f"{axis} drive in local mode", partial(drives.Local, axis), _ENABLED, _TRIP, 0.1 + SCAN_S)
    yield FaultKind(f"{axis} drive jammed", partial(drives.Jammed, axis), _MOVING, _TRIP, 1.2 + SCAN_S)


def _of_sensor(device: str) -> Iterator[FaultKind]:
    for what, kind in _SPOILED:
        yield FaultKind(
            f"{device} {what}", partial(modbus.Impaired, device, kind), _ENABLED, _TRIP, 0.3 + SCAN_S
        )
    yield FaultKind(
        f"{device} without supply", partial(modbus.DeviceOff, device), _ENABLED, _TRIP, 0.3 + SCAN_S
    )


def _of_the_rest() -> Iterator[FaultKind]:
    yield FaultKind("CAN adapter gone", can.AdapterGone, _DRIVES, _TRIP, SCAN_S)
    yield FaultKind("CAN bus off", can.BusSilent, _DRIVES, _TRIP, 0.2 + SCAN_S)
    yield FaultKind("safety chain opened", actuators.ChainOpen, _DRIVES, _TRIP, SCAN_S)
    yield FaultKind("guard opened", actuators.GuardOpen, _ENABLED, _TRIP, SCAN_S)
    yield FaultKind(
        "scan stalled", operator_faults.Stall, _ENABLED, _TRIP, 0.4 + SCAN_S, "ms", 0.4, lasts_s=0.5
    )
    yield FaultKind("process killed", operator_faults.Killed, _ALWAYS, Expected.DEVICES, 0.25)
    for action, reaction in (("hold", Expected.HOLD), ("release", Expected.RIDE), ("stop", Expected.STOP),
                             ("fast stop", Expected.STOP)):  # fmt: skip
        yield FaultKind(f"operator {action}", partial(operator_faults.Operator, action), _DRIVES, reaction, SCAN_S)


def plain_language(axes: Iterable[str], sensors: Iterable[str], *own: FaultKind) -> FaultLanguage:
    """Return what the scripts of a plain machine can say; ``sensors`` by the names that people use of them."""
    rows = [*own, *_of_the_rest()]
    rows += [row for axis in axes for row in _of_drive(axis)]
    rows += [row for device in sensors for row in _of_sensor(device)]
    return FaultLanguage({row.phrase: row for row in rows}, STEPS)
