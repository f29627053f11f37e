"""Slip between wheel and belt as a vector in the wheel's frame, and the effect of a sideslip angle on friction.

Frame: x along the wheel's plane in the direction of its tread at the contact, y across it. The sideslip
angle d is the yaw of the wheel against the belt's travel. Pure formulas. Cornering factors: fitted to the
sideslip rows of the paper (Polymers 2024, 16(5), 596, doi 10.3390/polym16050596, CC BY 4.0).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

from sim.physics import laws
from sim.physics.friction import UnknownCompoundError, in_range

CORNERING: Final[dict[str, float]] = {"1#": 0.58, "2#": 0.0, "3#": 0.0}
"""Extra friction per sin|d|. 1#: fitted to the paper's rows; 2#: vector slip alone explains them to 2.4 %."""

SIDESLIP_DATA: Final[frozenset[str]] = frozenset({"1#", "2#"})
"""Compounds with valid sideslip data: the paper's rows of 3# repeat those of 2#, so 3# has no factor."""

CREEP_M_S: Final = 0.008
"""[A] Slip added along x to find the direction of friction when there is no slip (the plant's default)."""

# Without Final: a compiled module does not find a constant tuple of numbers.
LOAD_N = (100.0, 400.0)
SLIP_M_S = (0.0, 0.4)
TEMPERATURE_C = (25.0, 85.0)
SIDESLIP_DEG = (0.0, 30.0)
"""Range of the paper's data (Table 2 and appendices)."""

REVERSAL_WIDTH_M_S: Final = 0.001
"""[A] The force passes through zero over this width of slip (the plant's default)."""


def slip_velocity(wheel_m_s: float, belt_m_s: float, sideslip_deg: float) -> tuple[float, float, float]:
    """Return (vx, vy, resultant) in m/s of the tread against the belt, wheel frame."""
    d = math.radians(sideslip_deg)
    vx = wheel_m_s - belt_m_s * math.cos(d)
    vy = belt_m_s * math.sin(d)
    return vx, vy, math.sqrt(vx * vx + vy * vy)


def belt_speed_for(wheel_m_s: float, slip_velocity_m_s: float) -> float:
    """Return the belt speed in m/s for a nominal slip velocity (that at sideslip 0; negative = braking)."""
    return wheel_m_s - slip_velocity_m_s


def cornering_factor(compound: str, sideslip_deg: float) -> float:
    """Return the coefficient's factor at a sideslip angle, 1 + k sin|d|; raises UnknownCompoundError."""
    if compound not in CORNERING:
        raise UnknownCompoundError(compound)
    return 1.0 + CORNERING[compound] * math.sin(math.radians(abs(sideslip_deg)))


def traction_direction(
    vx: float, vy: float, creep_m_s: float = CREEP_M_S, reversal_m_s: float = REVERSAL_WIDTH_M_S
) -> tuple[float, float]:
    """Return the direction of friction on the belt as (cx, cy), of length 1 (less only within a reversal).

    It is along the slip vector; as slip vanishes, along (vx + creep, vy), because a driven wheel that transmits
    traction creeps. The creep fades with the square of slip and is 6 um/s at 0.3 m/s. Where the driven
    wheel's slip changes sign, the length goes through zero over the reversal width instead of jumping.
    """
    x = vx + creep_m_s / (1.0 + (vx * vx + vy * vy) / (creep_m_s * creep_m_s))
    length = math.sqrt(x * x + vy * vy)
    if length < reversal_m_s:
        length = reversal_m_s
    return x / length, vy / length


def predict(
    compound: str,
    slip_velocity_m_s: float,
    load_n: float,
    temperature_c: float,
    sideslip_deg: float = 0.0,
    wheel_speed_m_s: float = 0.8,
    model: str = "paper",
) -> float:
    """Return a law's coefficient (resultant friction over load) of a test condition.

    Nominal slip velocity in m/s (wheel minus belt at sideslip 0), load in N above 0, surface temperature in
    degC, sideslip in deg; ``model``: the name of a law (``sim.physics.laws``). Raises UnknownCompoundError and
    ValueError (see ``sim.physics.friction.in_range``), UnknownLawError.
    """
    belt = belt_speed_for(wheel_speed_m_s, slip_velocity_m_s)
    _, _, resultant = slip_velocity(wheel_speed_m_s, belt, sideslip_deg)
    law = laws.make(model, compound)
    in_range(temperature_c, load_n, resultant)
    return law.mu(temperature_c, load_n, resultant) * cornering_factor(compound, sideslip_deg)


def caveats(
    compound: str, slip_velocity_m_s: float, load_n: float, temperature_c: float, sideslip_deg: float
) -> Iterator[str]:
    """Yield the reasons for care with a coefficient of the laws ``paper`` and ``v2``, a line each."""
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
