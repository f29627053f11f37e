"""What is asked of fits, over many synthetic sets of conditions."""

from __future__ import annotations

import pytest

from tests.campaigns import fit


@pytest.mark.campaign
def test_every_figure_of_200_sets_is_kept() -> None:
    assert fit.main([]) == 0


def test_held_out_conditions_of_a_few_sets_are_within_3_per_cent() -> None:
    pytest.importorskip("scipy", reason="needs the extra `report`")
    largest, over, count = fit.held_out(6)
    assert (over, count) == (0, 30) and largest < fit.HELD_OUT


def test_fewer_sets_are_judged_with_an_allowance_for_chance() -> None:
    assert fit.bounds(fit.SETS) == fit.COVERED
    low, high = fit.bounds(fit.SAMPLE)
    assert 0.79 < low < 0.81 and high == 1.0
