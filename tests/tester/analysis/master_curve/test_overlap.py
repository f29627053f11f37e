"""Shifts of neighbouring temperatures by themselves."""

from __future__ import annotations

from math import isnan

import numpy as np

from tester.analysis.master_curve.collapse import collapse
from tester.analysis.master_curve.overlap import TemperaturePair, pairs_of
from tester.analysis.master_curve.points import MasterPoint, set_of
from tests.campaigns.master.synthetic import SPEEDS_M_S, linear, synthetic


def pairs(points: list[MasterPoint], ts_c: float | None = None) -> tuple[TemperaturePair, ...]:
    return pairs_of(collapse(set_of(points), ts_c, resamples=2))


def test_free_shifts_are_those_of_wlf_where_friction_follows_it() -> None:
    found = [abs(pair.difference) for seed in range(4) for pair in pairs(synthetic(seed, 0.01))]
    assert np.median(found) < 0.1 and max(found) < 0.25


def test_free_shifts_show_another_law() -> None:
    found = pairs(synthetic(0, 0.005, shift=linear))
    assert np.median([abs(pair.free + 9.0 / 12.0) for pair in found]) < 0.1
    assert max(abs(pair.difference) for pair in found) > 0.5


def test_temperatures_far_apart_overlap_thinly_or_not_at_all() -> None:
    slow = [one for one in synthetic(0, 0.0) if one.speed_m_s < 1e-5 or one.block_c > 20.0]
    found = pairs(slow, 30.0)
    assert found[0].thin and not found[0].tied
    assert not found[-1].thin and found[-1].tied


def test_temperatures_with_few_speeds_have_no_shift_of_their_own() -> None:
    few = [one for one in synthetic(0, 0.0) if one.speed_m_s in SPEEDS_M_S[::3]]
    found = pairs(few, 30.0)
    assert all(isnan(pair.free) and pair.thin for pair in found)
