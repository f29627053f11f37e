"""Heat: the rows of the rubber's surface and of the hub, in the order of their rank."""

from __future__ import annotations

from typing import Final

from tester.interlocks.hub import (
    HEAT_NOT_SHOWN,
    HEATER_LINE_OPEN,
    HEATER_STUCK,
    HEATING_AT_STANDSTILL,
    HUB_JUMP,
    HUB_NOT_VALID,
    JACKET_HOT,
    JACKET_RUNAWAY,
    JACKET_SILENT,
)
from tester.interlocks.row import Interlock
from tester.interlocks.surface import (
    SURFACE_HOT,
    SURFACE_JUMP,
    SURFACE_NOT_VALID,
    SURFACE_OFF_MODEL,
    THERMOMETER_FROZEN,
    THERMOMETER_SILENT,
)

ROWS: Final[tuple[Interlock, ...]] = (
    SURFACE_HOT, JACKET_HOT, JACKET_RUNAWAY, HEATER_STUCK, HEATER_LINE_OPEN, HEATING_AT_STANDSTILL, HUB_JUMP,
    SURFACE_JUMP, THERMOMETER_FROZEN, SURFACE_OFF_MODEL, HEAT_NOT_SHOWN, THERMOMETER_SILENT, SURFACE_NOT_VALID,
    JACKET_SILENT, HUB_NOT_VALID,
)  # fmt: skip
