"""A condition's repeats judged together, and carry-over from repeat to repeat."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from math import exp
from random import Random

import pytest

from tester.analysis.blocks import Block
from tester.analysis.drift import fit_drift
from tester.analysis.flags import CARRY_OVER, NOT_SHOWN, flags_in
from tester.analysis.judge import judge, trend_of
from tester.analysis.reduce import counted, reduce_repeat
from tester.analysis.results import Judgement, RepeatResult, RepeatStatus
from tester.analysis.stability import Window, filled
from tests.tester.analysis.series import blocks, correlated, counter_of

MU = 0.7
N = 45


def repeat(seed: int, drift: float = 0.0, *, level: float = 1.0, settles: float = 0.0, at: int = 0) -> list[Block]:
    """Return a repeat's counted blocks; ``settles``: a share of mu, 1/e after 94 blocks, from block ``at`` on."""
    noise = islice(correlated(Random(seed)), 2 * N)
    values = [
        MU * level * (1.0 + x + drift * (i - 22) / 30 + settles * exp(-(at + i) / 94.0)) for i, x in enumerate(noise)
    ]
    made = blocks(values, per_burst=15)
    long_enough = next(made[:n] for n in range(N, 2 * N) if filled(counter_of(made[:n]), Window(30)))
    return list(counted(long_enough, Window(30)))


def result_of(used: list[Block], *, alone: bool = False) -> RepeatResult:
    """Return a repeat's result from the blocks that count; neither window nor transient is open."""
    flags = NOT_SHOWN if alone and not fit_drift([used], Window(30)).stable else ""
    return replace(reduce_repeat(used), flags=flags, status=RepeatStatus.VALID)


def judged(repeats: list[list[Block]], planned: int = 3) -> tuple[list[RepeatResult], Judgement]:
    results = [result_of(one, alone=planned <= 2) for one in repeats]
    return judge(results, repeats, planned, Window(30))


def test_steady_repeats_are_valid_and_without_a_flag() -> None:
    results, found = judged([repeat(seed) for seed in (1, 2, 3)])
    assert all(result.valid for result in results) and found.flags == ""
    assert abs(found.drift_percent) < found.drift_bound_percent <= 2.0
    assert found.repeat_windows == pytest.approx(1.5)


def test_a_repeat_that_drifts_is_refused_with_its_reason_and_keeps_its_value() -> None:
    results, found = judged([repeat(1), repeat(2, 0.05), repeat(3)])
    assert [result.status for result in results] == ["valid", "refused", "valid"]
    assert results[1].reason.startswith("drifts by")
    assert results[1].mu_resultant == result_of(repeat(2, 0.05)).mu_resultant
    assert found.flags == ""


def test_repeats_with_too_few_blocks_for_a_fit_are_kept_and_their_drift_is_not_shown() -> None:
    repeats = [repeat(seed)[:2] for seed in (1, 2, 3)]
    results, found = judge([result_of(one) for one in repeats], repeats, 3, Window(3))
    assert all(result.valid for result in results)
    assert NOT_SHOWN in flags_in(found.flags)


def test_repeats_carry_the_drift_of_the_common_fit() -> None:
    before = [result_of(repeat(seed)) for seed in (1, 2, 3)]
    after, _ = judged([repeat(seed) for seed in (1, 2, 3)])
    assert [r.drift_percent for r in after] != [r.drift_percent for r in before]


def test_a_drift_of_the_limit_is_not_shown_to_be_small() -> None:
    _, found = judged([repeat(seed, 0.0195) for seed in (11, 12, 13)])
    assert NOT_SHOWN in flags_in(found.flags)


def test_where_all_drift_the_condition_carries_both_flags() -> None:
    results, found = judged([repeat(seed, 0.06) for seed in (1, 2, 3)])
    assert all(result.drifts for result in results)
    assert flags_in(found.flags) == [CARRY_OVER, NOT_SHOWN]
    assert found.drift_percent == pytest.approx(6.0, abs=1.0)


def test_up_to_two_repeats_are_judged_each_alone_and_never_refused() -> None:
    results, found = judged([repeat(1), repeat(2, 0.06)], planned=2)
    assert [result.status for result in results] == ["valid", "valid"]
    assert flags_in(results[1].flags) == [NOT_SHOWN] and found.flags == NOT_SHOWN
    assert found.drift_percent == pytest.approx(6.0, abs=1.5)


def test_rolling_is_not_judged() -> None:
    made = [repeat(seed, 0.06) for seed in (1, 2, 3)]
    results = [reduce_repeat(one, Window(30), rolling=True) for one in made]
    after, found = judge(results, made, 3, Window(30))
    assert after == results and found.flags == "" and found.drift_percent != found.drift_percent


def test_repeats_that_have_no_value_are_passed_over() -> None:
    made = [repeat(1), repeat(2), repeat(3)[:10], repeat(4)]
    results = [result_of(one) for one in made]
    results[2] = reduce_repeat(made[2], Window(30))
    after, _ = judge(results, made, 3, Window(30))
    assert after[2] == results[2] and after[2].status is RepeatStatus.TOO_FEW


def test_two_repeats_refused_for_the_same_drift_carry_over() -> None:
    _, found = judged([repeat(1, 0.05), repeat(2, 0.05), repeat(3), repeat(4), repeat(5)])
    assert found.flags == CARRY_OVER


def test_two_repeats_refused_for_opposite_drifts_do_not() -> None:
    results, found = judged([repeat(3), repeat(1, 0.05), repeat(2, -0.05), repeat(4), repeat(5)])
    assert sum(result.drifts for result in results) == 2
    assert found.flags == ""


def test_a_first_repeat_that_is_refused_carries_over_a_later_one_does_not() -> None:
    refused, steady = repeat(2, -0.05), [repeat(seed) for seed in (1, 3, 4)]
    results, found = judged([refused, *steady])
    assert results[0].drifts and CARRY_OVER in flags_in(found.flags)
    results, found = judged([*steady[:2], refused, steady[2]])
    assert results[2].drifts and CARRY_OVER not in flags_in(found.flags)


def test_the_rest_may_not_drift_like_the_refused_repeats() -> None:
    results, found = judged([repeat(1, -0.01), repeat(2, -0.05), repeat(3, -0.01), repeat(4, -0.01)])
    assert [result.drifts for result in results] == [False, True, False, False]
    assert CARRY_OVER in flags_in(found.flags)
    results, found = judged([repeat(1, 0.01), repeat(2, -0.05), repeat(3, 0.01), repeat(4, 0.01)])
    assert results[1].drifts and CARRY_OVER not in flags_in(found.flags)


def test_means_that_fall_with_the_distance_carry_over() -> None:
    _, found = judged([repeat(seed, level=1.0 - 0.03 * seed) for seed in range(5)])
    assert found.flags == CARRY_OVER
    assert found.trend_percent == pytest.approx(-12.8, abs=1.5)


def test_scatter_between_repeats_does_not() -> None:
    _, found = judged([repeat(seed, level=level) for seed, level in enumerate((1.0, 1.03, 0.98, 1.01, 0.99))])
    assert found.flags == ""


def test_a_drift_that_dies_away_carries_over() -> None:
    """A run-in whose first repeat alone is refused: the make-ups look steady."""
    results, found = judged([repeat(seed, settles=0.12, at=60 * seed) for seed in range(5)])
    assert CARRY_OVER in flags_in(found.flags)
    assert found.trend_percent < -2.0 and results[-1].valid


def test_the_trend_of_one_repeat_is_none() -> None:
    trend, carries = trend_of([result_of(repeat(1))], 0.0)
    assert trend != trend and not carries
