"""The paper's friction model, written independently so that the product is not compared with itself.

Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0), equations 4-9, slip in m/s.
"""

from __future__ import annotations

from math import exp

COEFFICIENTS = {
    # alpha, beta, gamma, a1, a2, b1, b2, tm
    "1#": (0.2238, 0.002231, 1.013, 10.3850, 0.3975, -0.3834, 1.200, 70.0),
    "2#": (0.6278, 0.001974, 0.980, 12.1476, 0.3204, -0.4440, 1.550, 68.0),
    "3#": (0.8712, 0.002744, 1.028, 71.9234, 0.5443, -0.6167, 1.455, 73.0),
}


def coefficient(compound: str, temperature_c: float, load_n: float, slip_m_s: float) -> float:
    """Return the friction coefficient without sideslip."""
    alpha, beta, gamma, a1, a2, b1, b2, tm = COEFFICIENTS[compound]
    thermal = alpha * exp(-beta * (temperature_c - tm) ** 2) + gamma
    return thermal * (a1 * load_n**b1 * slip_m_s**b2 + a2)
