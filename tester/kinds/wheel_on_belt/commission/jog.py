"""The wheel rig's axes for jogging (tester.machine.commission.jog_axis)."""

from __future__ import annotations

from math import degrees, pi
from typing import Final

from tester.machine.commission.jog_axis import JoggedAxis
from tester.machine.commission.jogging import JogSpeeds

AXES: Final = (
    JoggedAxis("wheel", JogSpeeds(0.4, 0.4, 1.0, 2.0 * pi), "deg", "a protractor, or marks on the tread and beside it",
         "so that its lowest point goes the way of the arrow of the belt", 0.01, 0.5, False, factor=degrees(1.0)),
    JoggedAxis("belt", JogSpeeds(0.02, 0.02, 0.05, 0.25), "mm", "a mark on the belt and a ruler beside it",
         "so that its upper side goes the way of the arrow", 0.01, 0.5, False, factor=1e3),
    JoggedAxis("press", JogSpeeds(0.5, 0.25, 2.0, 4.0), "mm", "a dial gauge on the press", "towards the contact",
         0.01, 0.01, True, True),
    JoggedAxis("sideslip", JogSpeeds(1.0, 0.5, 2.0, 10.0), "deg", "the yaw axis's scale, or an inclinometer",
         "to the side that the rig's papers call positive", 0.03, 0.1, True),
    JoggedAxis("camber", JogSpeeds(1.0, 0.5, 2.0, 5.0), "deg", "an inclinometer on the wheel's carrier",
         "to the side that the rig's papers call positive", 0.05, 0.1, True),
)  # fmt: skip
"""Ways and speeds are in the axes' units (rad, m, mm, deg; per second) [A]; tolerances [A]; readings: half of an
instrument's finest division [A]."""

SPEEDS: Final = {axis.name: axis.speeds for axis in AXES}
