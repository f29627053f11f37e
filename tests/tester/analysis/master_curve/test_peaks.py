"""Maxima of a master curve, and Grosch's rules for them."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, pi

import numpy as np
import pytest

from sim.physics.materials import OutsideError
from sim.physics.moduli import ConstantModulus, FractionalZener
from tester.analysis.master_curve.collapse import collapse
from tester.analysis.master_curve.peaks import Peak, peaks_of
from tester.analysis.master_curve.points import set_of
from tester.analysis.master_curve.rules import rules_of
from tests.campaigns.master.synthetic import TS_C, synthetic

TRUE_X = [float(x) for x in (-3.5, 0.5)]
"""Places of the bells of a synthetic set; the maxima of their sum are within 0.1 decades of them."""
RUBBER = FractionalZener(relaxed_pa=1e6, glassy_pa=1e9, tau_s=1e-6, exponent=0.6, shift_c=-3.0)
"""Its loss modulus is greatest at 1 / tau = 1e6 rad/s, its loss factor at (Gr / Gg)^(1 / 2b) / tau = 3162.3 rad/s."""


def test_both_maxima_of_a_curve_are_found_at_the_reference_temperature() -> None:
    found, _ = peaks_of(collapse(set_of(synthetic(0, 0.005)), resamples=20), TS_C)
    assert [np.log10(one.speed_m_s) for one in found] == pytest.approx([-3.5, 0.5], abs=0.15)
    assert [one.mu for one in found] == pytest.approx([1.70, 1.51], rel=0.02)


def test_a_curve_that_only_rises_has_no_maximum() -> None:
    assert peaks_of(collapse(set_of(synthetic(0, 0.0, power=0.2)), resamples=2), TS_C) == ((), 0)


def test_the_intervals_of_maxima_hold_the_truth_and_grow_with_the_noise() -> None:
    held = [0, 0]
    for seed in range(20):
        peaks, _ = peaks_of(collapse(set_of(synthetic(seed, 0.02)), resamples=100), TS_C)
        ends = [[float(np.log10(end)) for end in one.interval_m_s] for one in peaks]
        assert len(ends) == 2
        for i, truth in enumerate(TRUE_X):
            held[i] += ends[i][0] <= truth <= ends[i][1]
            assert 0.01 < ends[i][1] - ends[i][0] < 1.0
    assert min(held) >= 16  # of 20; what the spline smooths away is in neither


def test_a_maximum_that_the_scatter_makes_is_none() -> None:
    flat = [replace(one, mu=float(1.0 + 0.02 * np.log10(one.speed_m_s))) for one in synthetic(0, 0.0)]
    listed = 0
    for seed in range(20):
        noise = np.exp(0.05 * np.random.default_rng(seed).standard_normal(len(flat)))
        bumpy = [replace(one, mu=one.mu * float(e)) for one, e in zip(flat, noise, strict=True)]
        listed += len(peaks_of(collapse(set_of(bumpy), TS_C, resamples=100), TS_C)[0])
    assert listed <= 1


def test_the_rules_are_a_length_times_a_frequency() -> None:
    adhesion, grit = rules_of(RUBBER, 20.0, (Peak(0.1, 2.0),))
    assert adhesion.speed_m_s == pytest.approx(6e-9 * 1e6 / (2.0 * pi), rel=0.01)
    assert grit.speed_m_s == pytest.approx(150e-6 * 3162.3 / (2.0 * pi), rel=0.01)
    assert grit.decades == pytest.approx(np.log10(0.1 / 0.0755), abs=0.01)


def test_a_rule_follows_the_temperature_by_the_rubbers_shift() -> None:
    warm, cold = (rules_of(RUBBER, celsius, ())[0].speed_m_s for celsius in (20.0, -3.0))
    assert np.log10(cold / warm) == pytest.approx(-8.86 * 23.0 / 124.5, abs=0.01)
    assert isnan(rules_of(RUBBER, 20.0, ())[0].decades)


def test_a_maximum_at_the_end_of_the_data_does_not_count() -> None:
    class Narrow:
        def complex_pa(self, rate_rad_s: np.ndarray, temperature_c: float) -> np.ndarray:
            if not 1.0 <= rate_rad_s[0] <= 1e5:
                raise OutsideError("known from 1 to 1e5 rad/s")
            return RUBBER.complex_pa(rate_rad_s, temperature_c)

    adhesion, grit = rules_of(Narrow(), 20.0, ())  # type: ignore[arg-type]
    assert isnan(adhesion.speed_m_s) and grit.speed_m_s == pytest.approx(0.0755, rel=0.01)


def test_a_modulus_without_a_maximum_gives_no_rule() -> None:
    assert all(isnan(one.speed_m_s) for one in rules_of(ConstantModulus(1e6, 0.3), 20.0, ()))
