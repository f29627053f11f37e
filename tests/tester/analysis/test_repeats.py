"""From repeats to a condition, and from wheels to one value."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, sqrt

import pytest

from tester.analysis.flags import NOT_SHOWN, SHORT
from tester.analysis.left_out import cochran_critical, excess_fluctuation, outliers
from tester.analysis.repeats import ConditionResult, combine_repeats, combine_replicates
from tester.analysis.results import ConditionStatus, Judgement, RepeatResult, RepeatStatus
from tests.tester.analysis.series import means_of


def repeat(
    mu: float = 0.7,
    fluctuation: float = 1.0,
    status: RepeatStatus = RepeatStatus.VALID,
    reason: str = "",
    flags: str = "",
) -> RepeatResult:
    return RepeatResult(
        status=status,
        reason=reason,
        flags=flags,
        mu_resultant=mu,
        mu_longitudinal=mu,
        mu_lateral=0.01,
        fluctuation_percent=fluctuation,
        batches=10,
        means=means_of(force_z_n=200.0, slip_m_s=0.3, surface_c=25.0),
    )


def combine(
    *results: RepeatResult, planned: int = 5, ended: ConditionStatus | None = None, reason: str = ""
) -> ConditionResult:
    return combine_repeats(results, planned, ended=ended, reason=reason)


FIVE = [repeat(mu) for mu in (0.70, 0.71, 0.69, 0.72, 0.70)]


def test_mean_scatter_and_interval_of_valid_repeats() -> None:
    result = combine(*FIVE)
    assert result.ok
    assert (result.counts.valid, result.counts.asked) == (5, 5)
    assert result.mu_resultant == pytest.approx(0.704)
    assert result.s == pytest.approx(0.0114018, rel=1e-5)
    assert result.type_a == pytest.approx(result.s / sqrt(5))
    assert result.interval == pytest.approx(2.776445 * result.type_a, rel=1e-6)
    assert result.measured["surface_c"] == pytest.approx(25.0)


def test_a_repeat_that_is_not_valid_is_left_out_with_its_reason() -> None:
    result = combine(*FIVE[:4], repeat(0.9, status=RepeatStatus.REFUSED, reason="drift +4 %"))
    assert result.ok
    assert result.n_valid == 4
    assert result.mu_resultant == pytest.approx(0.705)
    (excluded,) = result.excluded
    assert (excluded.position, excluded.reason) == (4, "refused: drift +4 %")


def test_no_valid_repeat_is_insufficient_and_names_each() -> None:
    poor = repeat(status=RepeatStatus.TOO_FEW, reason="3 of 30 revolutions")
    result = combine(*[poor] * 5)
    assert result.status is ConditionStatus.INSUFFICIENT
    assert result.reason.startswith("none of 5 repeats is valid: repeat 1 too few revolutions: 3 of 30")


def test_fewer_that_count_than_were_asked_for_are_a_value_with_a_flag() -> None:
    poor = repeat(status=RepeatStatus.TOO_FEW, reason="3 of 30 revolutions")
    result = combine(*FIVE[:4], poor)
    assert result.ok and result.n_valid == 4
    assert (result.flags, result.doubts) == (SHORT, (SHORT,))
    assert combine(*FIVE[:4], poor, FIVE[4]).doubts == ()


@pytest.mark.parametrize(("left_out", "doubts"), [((0, 1), ()), ((0, 1, 2), (SHORT,))])
def test_repeats_that_a_person_left_out_are_missed_below_the_least(
    left_out: tuple[int, ...], doubts: tuple[str, ...]
) -> None:
    result = combine_repeats(FIVE, 5, 3, by_hand=dict.fromkeys(left_out, "the jacket was off"))
    assert result.ok and result.doubts == doubts


def test_excluding_an_invalid_repeat_replaces_nothing() -> None:
    poor = repeat(status=RepeatStatus.TOO_FEW, reason="3 of 30 revolutions")
    assert combine_repeats([*FIVE[:4], poor], 5, 3, by_hand={4: "the jacket was off"}).doubts == (SHORT,)


def test_where_all_repeats_drift_the_value_is_theirs() -> None:
    drifting = [replace(one, status=RepeatStatus.REFUSED, drift_percent=4.0) for one in FIVE]
    result = combine_repeats(drifting, 5, judged=Judgement(flags=NOT_SHOWN))
    assert result.ok and result.mu_resultant == pytest.approx(0.704)
    assert result.doubts == (NOT_SHOWN,) and result.excluded == ()


def test_a_refused_repeat_is_left_out_beside_valid_ones() -> None:
    refused = replace(repeat(0.9), status=RepeatStatus.REFUSED, reason="drifts by +4.0 % a window", drift_percent=4.0)
    result = combine(*FIVE, refused)
    assert (result.n_valid, result.mu_resultant) == (5, pytest.approx(0.704))
    assert result.excluded[0].reason == "refused: drifts by +4.0 % a window"


def test_one_valid_repeat_shows_its_mean_and_no_scatter() -> None:
    result = combine(FIVE[0], *[repeat(status=RepeatStatus.TOO_FEW)] * 4)
    assert result.mu_resultant == pytest.approx(0.70)
    assert isnan(result.s)
    assert isnan(result.budget.expanded)


def test_a_condition_left_early_without_a_value_keeps_the_reason_of_the_run() -> None:
    failed = repeat(status=RepeatStatus.CANNOT_HOLD, reason="warming 3 K/s")
    result = combine(failed, ended=ConditionStatus.CANNOT_HOLD, reason="warming 3 K/s")
    assert (result.status, result.reason) == (ConditionStatus.CANNOT_HOLD, "warming 3 K/s")


def test_a_condition_left_early_with_enough_valid_repeats_has_a_value() -> None:
    assert combine(*FIVE[:3], ended=ConditionStatus.CANNOT_HOLD, reason="warming 3 K/s").ok


def test_a_condition_that_is_under_way_is_not_measured_yet() -> None:
    result = combine(*FIVE[:4])
    assert (result.status, result.reason) == (ConditionStatus.PENDING, "4 of 5 repeats committed")
    assert not combine().ok


def test_repeats_that_all_missed_the_temperature_are_reported_together() -> None:
    failed = repeat(status=RepeatStatus.CANNOT_HOLD, reason="warming 3 K/s")
    result = combine(failed, failed, planned=2)
    assert (result.status, result.reason) == (ConditionStatus.CANNOT_HOLD, "warming 3 K/s")


def test_a_restless_repeat_is_excluded() -> None:
    result = combine(*FIVE[:4], repeat(0.7, fluctuation=6.0))
    assert result.n_valid == 4
    assert "fluctuates by 6.0 %" in result.excluded[0].reason


def test_two_restless_repeats_are_excluded_one_after_the_other() -> None:
    results = [repeat() for _ in range(6)] + [repeat(fluctuation=6.0), repeat(fluctuation=30.0)]
    assert combine(*results, planned=8).n_valid == 6


def test_a_repeat_three_times_as_noisy_as_its_siblings_also_needs_cochran() -> None:
    # C of 2.9 : 1 : 1 : 1 : 1 is beyond the critical value, the ratio is not beyond 3.
    assert excess_fluctuation([*FIVE[:4], repeat(fluctuation=2.9)]) is None


def test_of_two_repeats_none_is_restless() -> None:
    assert excess_fluctuation([repeat(), repeat(fluctuation=50.0)]) is None


def test_repeats_without_any_noise_are_not_restless() -> None:
    assert excess_fluctuation([repeat(fluctuation=0.0)] * 4) is None


@pytest.mark.parametrize(("groups", "df", "printed"), [(3, 1, 0.993), (5, 2, 0.788), (5, 5, 0.588), (10, 1, 0.718)])
def test_cochran_critical_values_are_those_of_iso_5725(groups: int, df: int, printed: float) -> None:
    assert cochran_critical(groups, df) == pytest.approx(printed, abs=6e-4)


def test_a_value_far_from_the_others_is_flagged_and_stays() -> None:
    result = combine(*FIVE[:4], repeat(0.80))
    assert result.ok
    assert result.n_valid == 5
    assert result.flagged == (4,)
    assert "outlier" in result.flags.split()
    assert result.mu_resultant == pytest.approx(0.724)
    assert result.mu_without_flagged == pytest.approx(0.705)


def test_positions_of_flagged_repeats_count_those_left_out() -> None:
    result = combine(repeat(status=RepeatStatus.TOO_FEW), *FIVE[:3], repeat(0.90))
    assert result.flagged == (4,)


def test_of_two_values_none_is_far() -> None:
    assert outliers([0.1, 0.9]) == []


def test_flags_of_repeats_are_those_of_the_condition() -> None:
    flagged = [repeat(flags="rolling"), repeat(flags="rolling; extended"), repeat(flags="drift not shown; truncated")]
    assert combine(*flagged, *FIVE[:2]).flags == "drift not shown; extended; rolling; truncated"


def test_replicates_combine_as_means_of_wheels() -> None:
    wheels = [combine(*[repeat(mu)] * 5) for mu in (0.70, 0.72, 0.76)]
    result = combine_replicates(wheels)
    assert result.ok
    assert (result.counts.valid, result.counts.asked) == (3, 3)
    assert result.mu_resultant == pytest.approx(0.72667, rel=1e-4)
    assert result.s == pytest.approx(0.030551, rel=1e-4)


def test_a_single_wheel_with_a_value_is_not_enough_for_replicates() -> None:
    result = combine_replicates([combine(*FIVE), combine(ended=ConditionStatus.NOT_REACHED)])
    assert result.status is ConditionStatus.INSUFFICIENT
    assert result.reason == "replicate 2: not reached"


def test_replicates_under_way_are_not_measured_yet() -> None:
    assert combine_replicates([combine(*FIVE), combine()]).status is ConditionStatus.PENDING
    assert combine_replicates([combine(), combine()]).status is ConditionStatus.PENDING
