"""Effects of real rubber beyond the simulated rig's defaults, as values of the rig file.

The scales are those of ``sim/rig.yaml``: load lost at held depth (3 % in a decade of time), stiffness lost with
temperature (0.4 %/K), growth with temperature, and wear. In campaigns "real rubber" means these.
"""

from __future__ import annotations

from typing import Final

REAL_RUBBER: Final = ("sim.relaxation=1", "sim.softening=1", "sim.growth=1", "sim.wear=1")
WEAR_RATES: Final = (0.02, 0.1, 0.3)
"""From the most to the least resistant compound, mm3/(N m) (``sim.abrasion.wear_rate``); the rig file believes 0.08."""


def worn_at(rate_mm3_per_n_m: float) -> tuple[str, ...]:
    """Return the values for real rubber that wears at a rate in mm3/(N m)."""
    return (*REAL_RUBBER, f"sim.abrasion.wear_rate={rate_mm3_per_n_m:g}")
