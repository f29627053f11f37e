"""Faults of any machine on these wires: its drives, its bus, its sensors, its computer. A kind adds its own."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum
from functools import partial
from typing import Final

from sim.faults import drives, modbus
from sim.faults.common import SCAN_S, bus_rows, computer_rows, drive_rows, left_operation_rows
from sim.faults.kinds import Expected, FaultKind
from sim.faults.language import FaultLanguage
from sim.wires.modbus_wire import Kind

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


def _of_sensor(device: str) -> Iterator[FaultKind]:
    for what, kind in _SPOILED:
        yield FaultKind(
            f"{device} {what}", partial(modbus.Impaired, device, kind), _ENABLED, _TRIP, 0.3 + SCAN_S
        )
    yield FaultKind(
        f"{device} without supply", partial(modbus.device_off, device), _ENABLED, _TRIP, 0.3 + SCAN_S
    )


def plain_language(axes: Iterable[str], sensors: Iterable[str], *own: FaultKind) -> FaultLanguage:
    """Return what the scripts of a plain machine can say; ``sensors`` by the names that people use of them."""
    rows = [*own, *bus_rows(_DRIVES, _ENABLED), *computer_rows(_ALWAYS, _DRIVES, _ENABLED)]
    for axis in axes:
        rows += [*drive_rows(axis, _DRIVES, _ENABLED), *left_operation_rows(axis, _ENABLED)]
        rows.append(FaultKind(f"{axis} drive jammed", partial(drives.Jammed, axis), _MOVING, _TRIP, 1.2 + SCAN_S))
    rows += [row for device in sensors for row in _of_sensor(device)]
    return FaultLanguage({row.phrase: row for row in rows}, STEPS)
