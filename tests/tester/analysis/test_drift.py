"""The drift of a condition from one fit over its repeats: by construction, and over seeds.

The noise is AR(1), 1 % and 0.3 s. `python -m tests.campaigns.repeats` measures how often the rule errs.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import islice, pairwise
from math import exp
from random import Random

import pytest

from tester.analysis.blocks import Block
from tester.analysis.drift import decay, fit_drift, inflation, refusals
from tester.analysis.stability import Window
from tests.tester.analysis.series import blocks, correlated

MU = 0.7
N = 45


def repeat(
    seed: int | None, drift: float = 0.0, *, per_burst: int = 15, per_kelvin: float = 0.0, surface: Sequence[float] = ()
) -> list[Block]:
    """Return a repeat of 45 blocks with a drift (share of mu per 30 blocks); ``seed`` None: no noise."""
    noise = [0.0] * N if seed is None else list(islice(correlated(Random(seed)), N))
    kelvin = [surface[i % len(surface)] - 25.0 if surface else 0.0 for i in range(N)]
    values = [MU * (1.0 + noise[i] + drift * (i - 22) / 30 + per_kelvin * kelvin[i]) for i in range(N)]
    return blocks(values, per_burst=per_burst, surface=surface)


def test_a_drift_without_noise_is_found_exactly() -> None:
    found = fit_drift([repeat(None, 0.015), repeat(None, 0.015)], Window(30))
    assert found.drift_percent == pytest.approx(1.5, rel=1e-3)
    assert found.stable and found.bound_percent == pytest.approx(1.5, rel=1e-3)


def test_all_repeats_share_one_drift() -> None:
    found = fit_drift([repeat(None, 0.01), repeat(None, -0.01)], Window(30))
    assert found.drift_percent == pytest.approx(0.0, abs=1e-6)
    assert [one.drift_percent for one in found.repeats] == pytest.approx([1.0, -1.0], rel=1e-3)


def test_the_level_of_a_repeat_is_its_own() -> None:
    higher = blocks([1.1 * block.mu for block in repeat(3)], per_burst=15)
    apart = fit_drift([repeat(3), higher], Window(30))
    alike = fit_drift([repeat(3), repeat(3)], Window(30))
    assert apart.drift_percent == pytest.approx(alike.drift_percent, rel=1e-9)


def test_drift_is_that_of_accepted_time_not_of_pauses_between_bursts() -> None:
    assert fit_drift([repeat(None, 0.015, per_burst=3)], Window(30)).drift_percent == pytest.approx(1.5, rel=1e-3)


def test_a_window_in_seconds_is_that_of_accepted_time() -> None:
    by_turns, by_time = fit_drift([repeat(4, 0.01)], Window(30)), fit_drift([repeat(4, 0.01)], Window(None, 30 * 0.353))
    assert by_time.drift_percent == pytest.approx(by_turns.drift_percent, rel=1e-9)


def test_a_sawtooth_of_temperature_is_not_taken_for_drift() -> None:
    surface = [24.0 + 2.0 * j / 14.0 for j in range(15)]
    found = fit_drift([repeat(seed, per_kelvin=0.02, surface=surface) for seed in (1, 2, 3)], Window(30))
    assert found.stable and abs(found.drift_percent) < 0.7
    assert found.per_kelvin_percent == pytest.approx(2.0, abs=0.5)


def test_drift_under_a_sawtooth_of_temperature_is_seen() -> None:
    surface = [24.0 + 2.0 * j / 14.0 for j in range(15)]
    found = fit_drift([repeat(seed, 0.04, per_kelvin=0.02, surface=surface) for seed in (1, 2, 3)], Window(30))
    assert found.drift_percent == pytest.approx(4.0, abs=0.8) and not found.stable


def test_temperature_that_runs_with_time_leaves_the_drift_in_doubt() -> None:
    surface = [24.0 + 2.0 * i / 44.0 for i in range(N)]
    steady = fit_drift([repeat(seed, per_burst=N) for seed in (1, 2, 3)], Window(30))
    warming = fit_drift([repeat(seed, per_burst=N, surface=surface) for seed in (1, 2, 3)], Window(30))
    assert steady.stable and not warming.stable
    assert warming.error_percent > 3.0 * steady.error_percent


def test_no_noise_at_all_is_stable() -> None:
    found = fit_drift([repeat(None)] * 3, Window(30))
    assert found.stable and found.bound_percent == pytest.approx(0.0, abs=1e-9)


def test_the_decay_is_that_of_means_of_a_first_order_process() -> None:
    x = 0.353 / 0.3
    phi = exp(-x)
    assert decay((1.0 - phi) ** 2 / (2.0 * (x - 1.0 + phi))) == pytest.approx(phi, rel=1e-6)
    assert decay(0.0) == 0.0


def test_means_of_a_first_order_process_have_the_stated_inflation() -> None:
    made = list(islice(correlated(Random(1)), 60_000))
    sums = [sum(made[i : i + N]) / N for i in range(0, len(made), N)]
    mean = sum(made) / len(made)
    one = sum((x - mean) ** 2 for x in made) / len(made)
    many = sum((x - mean) ** 2 for x in sums) / len(sums)
    rho = sum((a - mean) * (b - mean) for a, b in pairwise(made)) / len(made) / one
    assert inflation([N], rho) == pytest.approx(many * N / one, rel=0.1)


def test_bursts_of_one_revolution_are_independent() -> None:
    assert inflation([1] * 40, 0.5) == 1.0
    assert inflation([10] * 4, 0.5) < inflation([40], 0.5)


def test_the_bound_covers_the_true_drift() -> None:
    covered = 0
    for seed in range(100):
        found = fit_drift([repeat(3 * seed + i, 0.01) for i in range(3)], Window(30))
        covered += abs(found.drift_percent - 1.0) <= found.bound_percent - abs(found.drift_percent)
    assert 84 <= covered <= 97


def test_steady_repeats_stay() -> None:
    found, refused = refusals([repeat(seed) for seed in range(4)], Window(30))
    assert found.stable and not refused and len(found.repeats) == 4


def test_a_repeat_that_drifts_is_refused_and_the_others_are_judged_without_it() -> None:
    found, refused = refusals([repeat(1), repeat(2, 0.05), repeat(3)], Window(30))
    assert list(refused) == [1] and refused[1].reason.startswith("drifts by +")
    assert found.stable and len(found.repeats) == 2


def test_a_repeat_that_differs_from_three_siblings_is_refused_although_it_drifts_little() -> None:
    quiet = [[*repeat(None)] for _ in range(3)]
    for one, seed in zip(quiet, (1, 2, 3), strict=True):
        one[:] = blocks([MU * (1.0 + 0.1 * x) for x in islice(correlated(Random(seed)), N)], per_burst=15)
    odd = blocks(
        [MU * (1.0 + 0.1 * x + 0.015 * (i - 22) / 30) for i, x in enumerate(islice(correlated(Random(4)), N))],
        per_burst=15,
    )
    _, refused = refusals([*quiet, odd], Window(30))
    assert list(refused) == [3] and "the other repeats by" in refused[3].reason
    _, two_siblings = refusals([*quiet[:2], odd], Window(30))
    assert two_siblings == {}


def test_where_all_drift_none_is_left() -> None:
    found, refused = refusals([repeat(seed, 0.06) for seed in range(3)], Window(30))
    assert sorted(refused) == [0, 1, 2] and not found.stable


@pytest.mark.parametrize("wrong", [float("nan"), float("inf")])
def test_a_repeat_without_a_coefficient_is_not_looked_at(wrong: float) -> None:
    found = fit_drift([repeat(1), blocks([MU] * 20 + [wrong] * 20), blocks([MU] * 5)], Window(30))
    assert found.repeats[0].drift_percent == fit_drift([repeat(1)], Window(30)).repeats[0].drift_percent
    assert found.repeats[1].drift_percent != found.repeats[1].drift_percent
    assert not fit_drift([blocks([0.0] * 30)], Window(30)).stable
