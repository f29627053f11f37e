"""The classes of the axes' keys on this kind of rig (tester.inputs.rig.key_classes), where they depend on the axis."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from tester.inputs.rig.key_classes import HIGHER, LOWER, Bounded, Classes
from tester.inputs.rig.section_classes import AXIS

_VELOCITY: Final[Mapping[str, Classes]] = {
    **AXIS,
    "rpdo_deadline": Bounded(
        LOWER, "250 ms", "without it a drive that receives no setpoint costs 3# 45 J; harm is 40 J", zero_is_off=True
    ),
}
WHEEL: Final[Mapping[str, Classes]] = {
    **_VELOCITY,
    "max_speed": Bounded(LOWER, "40", "rad/s; the greatest limits.wheel_speed at the least diameter", own=True),
    "quick_stop_deceleration": Bounded(HIGHER, "200", "rad/s2; at 178 a jammed belt costs 3# 45 J; harm is 40 J"),
    "speed_zero": Bounded(HIGHER, "0.1", "rad/s; 0 is off: a jam costs 3# 77 J; harm is 40 J"),
}
BELT: Final[Mapping[str, Classes]] = {
    **_VELOCITY,
    "max_speed": Bounded(LOWER, "1.6", "m/s; a belt that runs away may get as fast", own=True),
    "quick_stop_deceleration": Bounded(HIGHER, "9", "m/s2; as the wheel's"),
    "speed_zero": Bounded(HIGHER, "0.005", "m/s; as the wheel's"),
}
PRESS: Final[Mapping[str, Classes]] = {
    **_VELOCITY,
    "acceleration": Bounded(
        HIGHER, "600", "mm/s2; with 40 mm/s a wheel in local mode costs 3# 39.5 J; harm is 40 J"
    ),
    "max_speed": (
        Bounded(HIGHER, "40", "mm/s, of a fast stop; as axes.press.acceleration"),
        Bounded(LOWER, "100", "mm/s; a screw of 5 mm turns 20 times a second", own=True),
    ),
    "quick_stop_deceleration": Bounded(HIGHER, "100", "mm/s2; from 10 mm/s it comes 0.5 mm further"),
}  # fmt: skip
