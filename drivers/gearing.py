"""Ratios that a gear, a pulley or a factor object of a drive can have: quotients of small whole numbers."""

from __future__ import annotations

from fractions import Fraction
from typing import Final

MOST_TEETH: Final = 20
"""Greatest number in the quotient of a ratio, apart from whole multiples [A]."""
WITHIN: Final = 0.01
"""Relative difference within which a measured ratio is a gear's [A]: a reading by ruler or protractor."""


def gear_ratio(measured: float, within: float = WITHIN) -> Fraction | None:
    """Return the quotient of small numbers that explains a measured ratio (> 0); None if no gear does."""
    quotient = Fraction(measured) if measured >= 1.0 else 1 / Fraction(measured)
    for denominator in range(1, MOST_TEETH + 1):
        numerator = round(quotient * denominator)
        small = numerator <= MOST_TEETH or denominator == 1
        if small and abs(numerator / denominator / float(quotient) - 1.0) <= within:
            ratio = Fraction(numerator, denominator)
            return ratio if measured >= 1.0 else 1 / ratio
    return None
