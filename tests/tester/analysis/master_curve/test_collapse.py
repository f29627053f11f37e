"""The reference temperature that brings a set on one curve, with its interval."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.physics.wlf import PoleError
from tester.analysis.master_curve.collapse import PILOT, collapse, shifts
from tester.analysis.master_curve.points import MasterError, MasterPoint, MasterSource, set_of
from tests.campaigns.master.synthetic import TS_C, synthetic


def test_ts_of_a_set_without_noise_is_found_within_a_tenth_of_a_kelvin() -> None:
    assert collapse(set_of(synthetic(0, 0.0))).ts_c == pytest.approx(TS_C, abs=0.1)


@pytest.mark.parametrize(("noise", "most_k"), [(0.02, 1.0), (0.05, 2.0)])
def test_ts_of_sets_with_noise_is_found(noise: float, most_k: float) -> None:
    found = [collapse(set_of(synthetic(seed, noise)), resamples=2).ts_c for seed in range(5)]
    assert max(abs(one - TS_C) for one in found) <= most_k


def test_the_scatter_is_that_of_the_noise() -> None:
    found = [collapse(set_of(synthetic(seed, 0.02)), resamples=2).scatter for seed in range(5)]
    assert np.mean(found) == pytest.approx(0.02, rel=0.1)


def test_a_thermometer_that_is_off_moves_ts_by_as_much() -> None:
    right, off = (collapse(set_of(synthetic(3, 0.02, bias_k=bias)), resamples=2).ts_c for bias in (0.0, 1.5))
    assert off - right == pytest.approx(1.5, abs=0.01)


def test_the_thermometers_uncertainty_is_in_the_interval_and_apart_from_the_fits() -> None:
    without = collapse(set_of(synthetic(0, 0.02)))
    with_it = collapse(set_of(synthetic(0, 0.02, thermometer_k=2.0)))
    assert with_it.u_fit_k == without.u_fit_k
    assert with_it.interval[1] - with_it.interval[0] == pytest.approx(2.0 * 1.96 * 2.0, rel=0.1)
    assert without.interval[1] - without.interval[0] == pytest.approx(2.0 * 1.96 * without.u_fit_k, rel=0.15)


def test_the_interval_is_as_wide_as_ts_scatters() -> None:
    found = [collapse(set_of(synthetic(seed, 0.05))) for seed in range(12)]
    spread = float(np.std([one.ts_c for one in found]))
    assert 0.6 < np.mean([one.u_fit_k for one in found]) / spread < 1.8


def test_sets_drawn_anew_scatter_as_residuals_do_within_a_temperature_and_between_temperatures() -> None:
    off = np.random.default_rng(0).normal(0.0, 0.02, 11)  # of ln mu, by temperature
    made = synthetic(0, 0.01)
    blocks = sorted({one.block_c for one in made})
    found = collapse(set_of([replace(one, mu=one.mu * np.exp(off[blocks.index(one.block_c)])) for one in made]), TS_C)
    by_block = found.residual.reshape(11, 9)
    within = float(np.sum(np.var(by_block, axis=1, ddof=1))) / 11
    in_common = float(np.var(np.mean(by_block, axis=1), ddof=1)) - within / 9  # analysis of variance, nine speeds each
    assert found.drawn is not None
    drawn = (found.drawn.y - (found.of.log_mu - found.residual)[:, None]).reshape(11, 9, -1)
    own = float(np.var(found.residual)) * 99 / (99 - found.parameters)
    assert float(np.mean(np.var(drawn, axis=1, ddof=1))) == pytest.approx(own, rel=0.05)
    assert float(np.mean(np.mean(drawn, axis=1) ** 2)) == pytest.approx(in_common + own / 9, rel=0.1)


def test_a_given_ts_is_kept() -> None:
    found = collapse(set_of(synthetic(0, 0.02)), 25.0)
    assert (found.ts_c, found.interval, found.searched) == (25.0, (25.0, 25.0), False)
    assert found.scatter > 1.3 * collapse(set_of(synthetic(0, 0.02))).scatter


def test_a_ts_at_whose_pole_a_temperature_lies_is_refused() -> None:
    with pytest.raises(PoleError, match="holds only above"):
        collapse(set_of(synthetic(0, 0.02)), 100.0)


def test_runs_of_other_specimens_have_a_factor_of_their_own_near_1() -> None:
    source = MasterSource("second", 0.03)
    first = [replace(one, source=MasterSource("first", 0.03)) for one in synthetic(0, 0.01)[::2]]
    second = [replace(one, source=source, mu=1.05 * one.mu) for one in synthetic(0, 0.01)[1::2]]
    found = collapse(set_of([*first, *second]))
    assert found.curve.factors[1] - found.curve.factors[0] == pytest.approx(np.log(1.05), abs=0.01)
    assert found.ts_c == pytest.approx(TS_C, abs=0.5) and found.scatter < 0.015


def test_too_few_conditions_are_refused_with_the_expected_number() -> None:
    with pytest.raises(MasterError, match="8 conditions are too few for a curve"):
        collapse(set_of(synthetic(0, 0.0)[:8]))
    with pytest.raises(MasterError, match="no condition"):
        set_of([])


def test_the_arrays_are_in_order_of_temperature_and_speed() -> None:
    points: list[MasterPoint] = synthetic(0, 0.0)
    found = set_of(points[::-1])
    assert found.points == tuple(points)
    assert found.in_block.shape == (99, 11) and np.all(np.sum(found.in_block, axis=0) == 9)
    assert np.allclose(shifts(found.celsius, TS_C)[:9], shifts(np.array([-5.0]), TS_C))


def test_factors_of_two_runs_are_bounded_by_their_known_errors() -> None:
    """Least squares by hand: of a difference d the factors take n / (n + (PILOT / gain)^2), here one half."""
    made = synthetic(0, 0.0)
    gain, d = PILOT / np.sqrt(len(made)), 0.004
    runs = [replace(made[0].source, name=name, gain=gain) for name in ("a", "b")]
    both = [
        replace(one, source=source, mu=one.mu * np.exp(sign * 0.5 * d))
        for source, sign in zip(runs, (1.0, -1.0), strict=True)
        for one in made
    ]
    of = set_of(both)
    found = collapse(of, TS_C, resamples=2)
    sides = [float(np.mean(found.residual[of.source == place])) for place in (0, 1)]
    assert abs(sides[0] - sides[1]) == pytest.approx(0.5 * d, rel=0.02)
