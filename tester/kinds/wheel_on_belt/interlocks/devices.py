"""The Modbus devices as such (``tester.machine.wires``), and the wheel's diameter."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import Direction, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Row
from tester.machine.row import CONTROLLED, Interlock
from tester.machine.watches import at_least
from tester.machine.wires import DEVICE_REFUSED, LINE_NOISY

LEAST_DIAMETER_MM: Final = Parameter(
    "least_diameter_mm", "mm", "78 mm", "a wheel worn below this: 2 mm of rubber are left [A]",
    direction=Direction.HIGHER, hardest="76 mm",
    because="the rubber is 8 mm on a hub of 74 mm: 1 mm is left, the depth of a contact of 100 N",
)  # fmt: skip

WHEEL_WORN: Final[Row] = Interlock(
    name="wheel worn",
    cause="wheel diameter below its least",
    watch=at_least("cold diameter < {}", lambda v: v.readings.cold_mm, LEAST_DIAMETER_MM),
    reaction=CONTROLLED,
    reset="new wheel, acknowledged",
)

ROWS: Final[tuple[Row, ...]] = (DEVICE_REFUSED, LINE_NOISY, WHEEL_WORN)
