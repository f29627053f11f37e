"""The interlock table of this machine, in the order of importance."""

from __future__ import annotations

from typing import Final

from tester.kinds.specimen_on_track.interlocks import chamber, force, height, motion, stops
from tester.machine import wires
from tester.machine.interlock_table import InterlockSheet, InterlockTable

TABLE: Final = InterlockTable(
    (
        *wires.ROWS, *motion.ROWS, *force.ROWS, *height.ROWS, *chamber.ROWS, wires.DEVICE_REFUSED, wires.LINE_NOISY,
        *stops.ROWS, *wires.WARNINGS,
    ),
    stops.OPERATION,
)  # fmt: skip
SHEET: Final = InterlockSheet(TABLE.rows, TABLE.operation, stops.ABOUT)
