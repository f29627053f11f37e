"""Ratios that gears can have."""

from __future__ import annotations

from fractions import Fraction

import pytest

from drivers.gearing import gear_ratio


@pytest.mark.parametrize(
    ("measured", "ratio"), [(2.0, "2"), (0.1, "1/10"), (1.5, "3/2"), (0.75, "3/4"), (88.0, "88")]
)
def test_a_gears_ratio_is_a_quotient_of_small_numbers(measured: float, ratio: str) -> None:
    assert gear_ratio(measured) == Fraction(ratio)


@pytest.mark.parametrize("measured", [1.0305, 13.57, 0.0421])
def test_no_gear_has_any_other_ratio(measured: float) -> None:
    assert gear_ratio(measured, 1e-3) is None
