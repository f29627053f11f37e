"""The interlock table of this machine: the rows of every subject, in the order of their importance."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import Parameter
from tester.kinds.wheel_on_belt.interlocks import friction, hub, load, motion, operation, stops, surface, witness
from tester.machine import wires
from tester.machine.interlock_table import InterlockSheet, InterlockTable

TABLE: Final = InterlockTable(
    (
        *wires.ROWS, *motion.ROWS, *load.ROWS, *witness.ROWS, *friction.ROWS, *surface.ROWS, *hub.ROWS,
        wires.DEVICE_REFUSED, wires.LINE_NOISY, surface.WHEEL_WORN, *stops.ROWS, *wires.WARNINGS,
    ),
    operation.PARAMETERS,
)  # fmt: skip
PARAMETERS: Final[tuple[Parameter, ...]] = TABLE.parameters
"""Every key of the rig file's section ``interlocks``, in its order."""
SHEET: Final = InterlockSheet(TABLE.rows, operation.PARAMETERS, operation.ABOUT)
