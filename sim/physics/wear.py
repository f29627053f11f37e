"""What sliding does to the tread: loss of radius, and the excess friction of a new one.

Archard's law, volume = k F s, spread over the tread; the constants are assumptions of ``AbrasionParameters``.
"""

from __future__ import annotations

import math


def radius_loss_mm(
    wear_rate_mm3_n_m: float, load_n: float, sliding_m: float, diameter_mm: float, width_mm: float
) -> float:
    """Return the radius in mm that sliding over ``sliding_m`` under a load takes off a wheel: k F s / (2 pi R w)."""
    return wear_rate_mm3_n_m * load_n * sliding_m / (math.pi * diameter_mm * width_mm)


def running_in_factor(excess: float, distance_m: float, sliding_m: float) -> float:
    """Return what multiplies the friction of a tread that has slid ``sliding_m`` since new: 1 + excess exp(-s/d)."""
    return 1.0 + excess * math.exp(-sliding_m / distance_m)
