"""What sliding does to the tread: loss of radius, and the excess friction of a new one; and to the belt below it.

Archard's law, volume = k F s, spread over the tread; the constants are assumptions of ``AbrasionParameters`` and
``CounterfaceParameters``.
"""

from __future__ import annotations

import math

from sim.physics.parameters import CounterfaceParameters


def radius_loss_mm(
    wear_rate_mm3_n_m: float, load_n: float, sliding_m: float, diameter_mm: float, width_mm: float
) -> float:
    """Return the radius in mm that sliding over ``sliding_m`` under a load takes off a wheel: k F s / (2 pi R w)."""
    return wear_rate_mm3_n_m * load_n * sliding_m / (math.pi * diameter_mm * width_mm)


def running_in_factor(excess: float, distance_m: float, sliding_m: float) -> float:
    """Return what multiplies the friction of a tread that has slid ``sliding_m`` since new: 1 + excess exp(-s/d)."""
    return 1.0 + excess * math.exp(-sliding_m / distance_m)


def grip_kept(counterface: CounterfaceParameters, travel_m: float, surface_c: float) -> float:
    """Return the share of its grip that a belt keeps over a travel under load (m), below rubber at ``surface_c``."""
    hotter_k = max(surface_c - counterface.clogs_above, 0.0)
    counted_m = travel_m * (1.0 + counterface.clogging * hotter_k)
    return (1.0 - counterface.loss) ** (counted_m / counterface.loss_travel)
