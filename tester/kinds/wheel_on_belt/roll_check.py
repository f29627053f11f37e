"""How well rolling under a light load tells a wheel's diameter: for the check itself, and for what a plan expects."""

from __future__ import annotations

from math import hypot
from typing import Final

from tester.kinds.wheel_on_belt.interlocks.contact import depth_mm
from tester.kinds.wheel_on_belt.rig import RigConfig

ROLL_CHECK_N: Final = 50.0
"""Load of the automatic diameter check, N [A]: little penetration, and above the press's friction."""
ROLL_CHECK_TURNS: Final = 6.0
"""Whole turns averaged by the check: runout drops out, and the load loop's ripple."""


def roll_check_u_mm(rig: RigConfig, off_mm: float = 0.0) -> float:
    """Return the standard uncertainty of a diameter by a roll check, mm, by itself.

    ``off_mm``: by how much the press stood deeper for a load beside the nominal one.
    """
    wear, stiffness = rig.wear, rig.loops.load.stiffness_n_per_mm
    per_n = 2.0 * (depth_mm(ROLL_CHECK_N + 0.5, stiffness) - depth_mm(ROLL_CHECK_N - 0.5, stiffness))
    return hypot(
        2.0 * wear.check_press_mm,
        per_n * wear.check_load_n,
        0.01 * wear.check_stiffness_percent * 2.0 * off_mm,
        wear.growth_mm_per_k * wear.check_rubber_k,
    )
