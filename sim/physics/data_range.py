"""Where the paper's data lie, and what a predicted coefficient rests on when it is asked for elsewhere.

Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0), Table 2 and appendices.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from sim.physics.slip import CORNERING, SIDESLIP_DATA

LOAD_N: Final = (100.0, 400.0)
SLIP_M_S: Final = (0.0, 0.4)
TEMPERATURE_C: Final = (25.0, 85.0)
SIDESLIP_DEG: Final = (0.0, 30.0)


def caveats(
    compound: str, slip_velocity_m_s: float, load_n: float, temperature_c: float, sideslip_deg: float
) -> Iterator[str]:
    """Yield why a coefficient of the laws ``paper`` and ``v2`` is to be taken with care, a line each."""
    sideslip = abs(sideslip_deg)
    for name, value, (low, high), unit, scale in (
        ("load", load_n, LOAD_N, "N", 1.0),
        ("slip velocity", slip_velocity_m_s, SLIP_M_S, "mm/s", 1e3),
        ("temperature", temperature_c, TEMPERATURE_C, "degC", 1.0),
        ("sideslip", sideslip, SIDESLIP_DEG, "deg", 1.0),
    ):
        if not low <= value <= high:
            data = f"{scale * low:g} to {scale * high:g} {unit}"
            yield f"{name} {scale * value:g} {unit} is outside the paper's data, {data}: an extrapolation"
    if slip_velocity_m_s == 0.0 and sideslip == 0.0:
        yield "at 0 mm/s the wheel rolls: the paper's value there is no coefficient of sliding"
    if sideslip > 0.0 and compound not in SIDESLIP_DATA:
        yield f"no valid data of {compound} with a sideslip angle: the paper's rows repeat those of 2#"
    elif sideslip > 0.0 and CORNERING.get(compound):
        factor = CORNERING[compound]
        yield f"the factor 1 + {factor:g} sin|sideslip| of {compound} is this project's, from three points of the paper"
