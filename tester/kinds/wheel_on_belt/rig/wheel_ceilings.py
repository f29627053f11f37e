"""Ceilings of this rig's safety keys: direction, hardest value, and the reason.

Interlock parameters have their own ceilings (tester.inputs.rig.parameter); those of other sections are here.
"""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.ceilings import HIGHER, LOWER, TRUE, Ceiling, ceilings_of
from tester.inputs.rig.parameter import SECTION
from tester.inputs.rig.plain_rig import PLAIN_CEILINGS
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS
from tester.kinds.wheel_on_belt.rig.sections import VELOCITY_AXES

_OWN: Final = (
    Ceiling("limits.load", "N", LOWER, "450 N",
            "the load trips at once above it, and the press still comes for some 50 ms: harm begins at 500 N"),
    Ceiling("limits.wheel_speed", "m/s", LOWER, "1.5 m/s",
            "at 1.5 m/s a wheel that does not stop loses its power after 2.5 s; no step of a stop may begin later"),
    Ceiling("limits.belt_speed", "m/s", LOWER, "1.5 m/s",
            "at 1.5 m/s a belt that does not stop loses its power after 2.5 s; no step of a stop may begin later"),
    Ceiling("limits.slip_power", "W", LOWER, "400 W",
            "the wheel's drive gives 400 W at its rated torque: 16 N m at 25 rad/s"),
    Ceiling("limits.jacket", "degC", LOWER, "150 degC",
            "3 K of margin and 2 K of rise after the heat is off make 155 degC, which harms"),
    Ceiling("limits.surface", "degC", LOWER, "100 degC",
            "the contact is hotter than the surface beside it by some 20 K [A]; harm begins at 130 degC there"),
    *(Ceiling(axis.limit, axis.recipe_unit, LOWER, axis.hardest, axis.because) for axis in POSITIONED),
    *(ceiling for ceiling in PLAIN_CEILINGS if ceiling.key != "can.consumer_heartbeat"),
    Ceiling("arming.bump_test", "", HIGHER, TRUE, "without it wheel and belt may be exchanged, or turn the wrong way"),
    Ceiling("arming.creep", "m/s", LOWER, "0.1 m/s", "nothing is proven yet: a wheel turns once in three seconds"),
    Ceiling("arming.unloaded", "N", LOWER, "30 N",
            "450 N, the greatest load, and 30 N of a wrong zero are 480 N; harm begins at 500 N"),
    Ceiling("scan.sliding", "Hz", HIGHER, "50 Hz", "a delay of 50 ms is two scans and a half: fewer are one reading"),
    Ceiling("can.consumer_heartbeat", "s", LOWER, "300 ms",
            "without heartbeat a drive keeps its setpoint: another 0.1 s at 400 W (limits.slip_power) are 40 J: harm"),
    *(Ceiling(f"axes.{name}.rpdo_deadline", "s", LOWER, "250 ms",
              "without it a drive that receives no setpoint costs 3# 45 J; harm is 40 J", zero_is_off=True)
      for name in VELOCITY_AXES),
    Ceiling("axes.wheel.quick_stop_deceleration", "", HIGHER, "200",
            "rad/s2; at 8 m/s2 (178 rad/s2) a jammed belt costs 3# 45 J at 430 N, harm is 40 J"),
    Ceiling("axes.belt.quick_stop_deceleration", "", HIGHER, "9", "m/s2; as the wheel's"),
    Ceiling("axes.wheel.speed_zero", "", HIGHER, "0.1",
            "rad/s; 0 is off: a jam is then seen with the next scan, and costs 3# 77 J; harm is 40 J"),
    Ceiling("axes.belt.speed_zero", "", HIGHER, "0.005", "m/s; as the wheel's"),
    Ceiling("axes.press.acceleration", "", HIGHER, "600",
            "mm/s2; at 400 and 30 mm/s a wheel in local mode costs 3# 42 J, at 600 and 40 mm/s 39.5 J: harm is 40 J"),
    Ceiling("axes.press.max_speed", "", HIGHER, "40", "mm/s, of a fast stop; as axes.press.acceleration"),
    Ceiling("axes.press.quick_stop_deceleration", "", HIGHER, "100", "mm/s2; from 10 mm/s it comes 0.5 mm further"),
    Ceiling("loops.load.touch_load", "N", LOWER, "20 N",
            "a wrong direction or scale of wheel or belt shows at 20 N or less"),
    Ceiling("loops.load.follow_rate", "N/s", HIGHER, "50 N/s",
            "until a change is followed the load is watched against the one before: 450 N to none then take 9 s"),
    Ceiling("loops.load.touch_speed", "mm/s", LOWER, "15 mm/s",
            "the press comes 0.75 mm in the 50 ms until contact is seen"),
    Ceiling("loops.load.loading_speed", "mm/s", LOWER, "4 mm/s", "at 172 N/mm the load rises by 34 N in 50 ms"),
    Ceiling("loops.load.lift_speed", "mm/s", HIGHER, "5 mm/s", "lifting 2.5 mm takes 0.5 s, half of what it may"),
    Ceiling("loops.load.clearance", "mm", HIGHER, "1 mm", "twenty times the runout of the tread"),
    Ceiling("loops.heat.hub_max", "degC", LOWER, "150 degC", "as limits.jacket"),
)  # fmt: skip

CEILINGS: Final[tuple[Ceiling, ...]] = (*_OWN, *ceilings_of(SECTION, PARAMETERS))
"""Every safety key of a rig file, in the order of the page docs/kinds/wheel-on-belt.md."""
