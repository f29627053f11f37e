"""Keyed random streams, scatter and its sum."""

from __future__ import annotations

import copy
import math
import statistics

import numpy as np
import pytest

from sim.noise import Autoregressive, NormalStream, normal, uniforms
from tests.campaigns.acceptance.sigma import mean_of_autoregressive


def take(stream: NormalStream, count: int) -> list[float]:
    return [stream.next() for _ in range(count)]


def test_same_key_gives_the_same_numbers() -> None:
    assert take(NormalStream(1, "ir", 2, 3), 3000) == take(NormalStream(1, "ir", 2, 3), 3000)


@pytest.mark.parametrize(
    "other",
    [
        NormalStream(2, "ir", 1, 1, 1, 1, 1),
        NormalStream(1, "hub", 1, 1, 1, 1, 1),
        *(NormalStream(1, "ir", *(2 if i == j else 1 for j in range(5))) for i in range(5)),
        NormalStream(1, "ir", 1, 1),
        NormalStream(1, "ir", 1, 1, 1, 1, 1, 0),
    ],
)
def test_each_part_of_the_key_makes_a_stream_of_its_own(other: NormalStream) -> None:
    mine, theirs = take(NormalStream(1, "ir", 1, 1, 1, 1, 1), 400), take(other, 400)
    assert abs(np.corrcoef(mine, theirs)[0, 1]) < 0.2


def test_first_numbers_never_change() -> None:
    """Philox and SeedSequence are stable by contract; this is the alarm if a numpy release changes its normals."""
    expected = [-0.4695556, 0.6289600, 0.3961664]
    assert take(NormalStream(1, "ir", 1, 1, 1, 1, 1), 3) == pytest.approx(expected, abs=1e-6)


def test_stream_is_standard_normal_across_its_blocks() -> None:
    numbers = take(NormalStream(7, "cell", 1, 1), 20_000)
    assert statistics.fmean(numbers) == pytest.approx(0.0, abs=0.03)
    assert statistics.stdev(numbers) == pytest.approx(1.0, abs=0.02)
    assert len(set(numbers)) == len(numbers)


def test_reading_by_fours_gives_the_same_numbers() -> None:
    by_fours = NormalStream(1, "cell", 1)
    assert [x for _ in range(500) for x in by_fours.next4()] == take(NormalStream(1, "cell", 1), 2000)


def test_copied_stream_continues_identically_and_independently() -> None:
    stream = NormalStream(1, "ir", 5)
    take(stream, 100)
    twin = copy.deepcopy(stream)
    ahead = take(stream, 1000)
    assert take(twin, 1000) == ahead


def test_seeds_of_any_size_and_sign_are_taken() -> None:
    assert len({normal(seed, "wheel", 1, 1) for seed in (0, -1, 2**40, 2**63)}) == 4


def test_uniform_numbers_fill_minus_one_to_one() -> None:
    numbers = uniforms(2000, 1, "session")
    assert -1.0 <= min(numbers) < -0.99
    assert 0.99 < max(numbers) < 1.0


def test_autoregressive_fluctuation_has_its_size_and_correlation_time() -> None:
    process, stream = Autoregressive(0.01, 0.3), NormalStream(3, "within", 1)
    process.retime(0.01)
    process.restart(stream.next())
    values = [process.step(stream.next()) for _ in range(60_000)]
    assert statistics.stdev(values) == pytest.approx(0.01, rel=0.1)
    correlation = np.corrcoef(values[:-30], values[30:])[0, 1]
    assert correlation == pytest.approx(math.exp(-1.0), abs=0.07)


def test_autoregressive_fluctuation_has_its_size_at_any_step() -> None:
    process, stream = Autoregressive(0.01, 0.3), NormalStream(4, "within", 1)
    process.retime(0.1)
    values = [process.step(stream.next()) for _ in range(20_000)]
    assert statistics.stdev(values) == pytest.approx(0.01, rel=0.05)


def test_mean_of_the_fluctuation_over_a_window_is_as_computed() -> None:
    process, stream = Autoregressive(0.01, 0.3), NormalStream(5, "within", 1)
    process.retime(0.02)
    means: list[float] = []
    for _ in range(800):
        process.restart(stream.next())
        means.append(statistics.fmean(process.step(stream.next()) for _ in range(100)))
    assert statistics.stdev(means) == pytest.approx(mean_of_autoregressive(0.01, 0.3, 2.0), rel=0.08)


def test_mean_over_next_to_no_time_scatters_as_the_fluctuation_itself() -> None:
    assert mean_of_autoregressive(0.01, 0.3, 1e-4) == pytest.approx(0.01, rel=1e-3)
    assert mean_of_autoregressive(0.01, 0.3, 300.0) == pytest.approx(0.01 * math.sqrt(0.002), rel=1e-3)


@pytest.mark.parametrize("count", [0, 1, 127, 128, 129, 128 + 1024, 3000])
def test_a_stream_counts_its_draws_and_skips(count: int) -> None:
    drawn, skipped = NormalStream(1, "count"), NormalStream(1, "count")
    for _ in range(count):
        drawn.next()
    skipped.skip(count)
    assert drawn.drawn == skipped.drawn == count
    assert drawn.next() == skipped.next()
