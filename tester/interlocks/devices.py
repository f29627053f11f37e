"""The Modbus devices as such, and the wheel's diameter."""

from __future__ import annotations

from typing import Final

from tester.interlocks.inputs import Inputs
from tester.interlocks.parameter import NOT_NEGATIVE, SHARE, Direction, Parameter
from tester.interlocks.row import ACK, CONTROLLED, REPAIR, Interlock


def _device_refuses(v: Inputs) -> bool:
    return v.readings.device_fault != ""


DEVICE_REFUSED: Final = Interlock(
    name="device refused",
    cause="a Modbus device refuses a request, or misses our commands",
    level="exception 01 to 03, or its lease ran out",
    condition=_device_refuses,
    reaction=CONTROLLED,
    reset=REPAIR,
)

LINE_ERRORS: Final = Parameter(
    "line_errors", "1", "0.3", "share of failed requests to a Modbus device over 2 s or more ... [A]", SHARE,
    direction=Direction.LOWER, hardest="0.5",
    because="a line on which every second request fails reaches its devices half as often as was planned",
)  # fmt: skip
LINE_ERRORS_DELAY_S: Final = Parameter(
    "line_errors_delay_s", "s", "3 s", "... for this long [A]", NOT_NEGATIVE,
    direction=Direction.LOWER, hardest="10 s",
    because="the values' own ages are watched besides: this row only names the line",
)  # fmt: skip


def _line_noisy(v: Inputs) -> bool:
    return not (v.readings.line_errors <= v.parameters[LINE_ERRORS])


LINE_NOISY: Final = Interlock(
    name="line noisy",
    cause="a Modbus device answers badly (CRC, time-outs, late replies)",
    level="failed requests > line_errors",
    condition=_line_noisy,
    parameters=(LINE_ERRORS,),
    delay=LINE_ERRORS_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

LEAST_DIAMETER_MM: Final = Parameter(
    "least_diameter_mm", "mm", "78 mm", "a wheel worn below this: 2 mm of rubber are left [A]",
    direction=Direction.HIGHER, hardest="76 mm",
    because="the rubber is 8 mm on a hub of 74 mm: 1 mm is left, the depth of a contact of 100 N",
)  # fmt: skip


def _wheel_worn(v: Inputs) -> bool:
    return not (v.readings.cold_mm >= v.parameters[LEAST_DIAMETER_MM])


WHEEL_WORN: Final = Interlock(
    name="wheel worn",
    cause="wheel diameter below its least",
    level="cold diameter < least_diameter",
    condition=_wheel_worn,
    parameters=(LEAST_DIAMETER_MM,),
    reaction=CONTROLLED,
    reset="new wheel, acknowledged",
)

ROWS: Final[tuple[Interlock, ...]] = (DEVICE_REFUSED, LINE_NOISY, WHEEL_WORN)
