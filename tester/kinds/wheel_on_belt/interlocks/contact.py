"""The contact of wheel and belt as interlocks and load loop see it: where it begins and how firm it may be."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import nan
from typing import Final

UNLOADED_N: Final = 20.0
"""Below this the contact counts as unloaded, N [A]: noise, zero drift and the runout of a wheel that just touches.

No key of the rig file: what a rig may differ in, the zero of its cell, has keys of its own (``zero_stop``,
``arming.unloaded``), which may not be looser than 30 N because they lean on this. Were 20 N set higher, a rig would
turn its angles, and end its stops, under a load; set lower, a drifting zero would keep stops from ending.
"""
STIFFNESS_EXPONENT: Final = 0.23
"""Tangent stiffness of the line contact grows with load to this power: 125 to 172 N/mm from 100 to 400 N [A]."""
_DEPTH_SHARE: Final = 1.0 / (1.0 - STIFFNESS_EXPONENT)


@dataclass(slots=True)
class Contact:
    """What the load loop knows of the contact."""

    contact_mm: float = nan
    """Press position at the last first touch; NaN until the wheel has been touched since its installation."""
    in_contact: bool = False
    loaded: bool = False
    """Half of the wanted load has been reached since touching: from then on losing it is a fault."""
    highest_n: float = 0.0
    lowest_n: float = 0.0
    """The wanted load, followed slowly downwards (highest) and upwards (lowest): what the load is watched against
    while the press brings it to another value."""


def depth_mm(force_n: float, stiffness_n_per_mm: float) -> float:
    """Return how far beyond the first touch the press stands under ``force_n``, mm: the integral of dF over the tangent
    stiffness, which is ``stiffness_n_per_mm`` at 200 N; 0 where there is no force."""
    if not force_n > 0.0:
        return 0.0
    return _DEPTH_SHARE * force_n / (stiffness_n_per_mm * math.pow(force_n / 200.0, STIFFNESS_EXPONENT))
