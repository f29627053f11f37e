"""Whether scans are late beside others, judged with the error of ten seconds."""

from __future__ import annotations

import random

import pytest

from tests.campaigns.stop.scans import Scans, latest_kept

SEEDS = range(20)


def watched(seed: int, later_s: float = 0.0) -> Scans:
    """Return ten seconds of scans; those with others are so much later than those without others plus a bare loop."""
    drawn = random.Random(seed)
    scans = Scans.__new__(Scans)
    scans.seconds = 10.0
    scans.before = [drawn.expovariate(1e4) for _ in range(1000)]
    scans.loops = [drawn.expovariate(1e4) for _ in range(2000)]
    scans.beside = [drawn.expovariate(1e4) + drawn.expovariate(1e4) + later_s for _ in range(1000)]
    return scans


def in_time(scans: Scans) -> bool:
    return scans.figures("others")[1].ok


def test_scans_that_are_late_as_the_computer_is_are_kept_with_every_seed() -> None:
    assert [seed for seed in SEEDS if not in_time(watched(seed))] == []


def test_scans_that_are_late_by_a_millisecond_more_miss_with_every_seed() -> None:
    assert [seed for seed in SEEDS if in_time(watched(seed, 1e-3))] == []


@pytest.mark.parametrize("missing", ["before", "beside", "loops"])
def test_what_was_not_seen_is_a_miss(missing: str) -> None:
    scans = watched(0)
    setattr(scans, missing, [])
    assert not in_time(scans)
    assert not latest_kept([scans])
