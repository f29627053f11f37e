"""What no shift can do."""

from __future__ import annotations

from dataclasses import replace

from tester.analysis.master_curve.signs import signs_of
from tests.campaigns.master.synthetic import synthetic


def test_on_a_master_curve_warming_does_what_slowing_does() -> None:
    found = signs_of(synthetic(0, 0.0))
    assert found.cells > 50 and found.same <= 0.05 * found.cells


def test_a_coefficient_that_rises_with_both_is_none() -> None:
    rising = [replace(one, mu=one.speed_m_s**0.1 * 1.05 ** (one.block_c / 9.0)) for one in synthetic(0, 0.0)]
    found = signs_of(rising)
    assert found.same == found.cells == 80


def test_compounds_and_loads_are_apart() -> None:
    points = synthetic(0, 0.0)
    parted = [replace(one, held={"load": f"{i} N"}) for i, one in enumerate(points)]
    assert signs_of(parted).cells == 0
