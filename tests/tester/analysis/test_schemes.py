"""Pairs as values of a condition: counted and excluded pairs with reasons, and each direction's own drift."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt
from random import Random
from statistics import stdev

import pytest

from tester.analysis.blocks import Block
from tester.analysis.flags import NOT_SHOWN, flags_in
from tester.analysis.kelvin import Slope, SurfaceWarmth
from tester.analysis.measurand import Surroundings, pooled, with_budget
from tester.analysis.repeats import combine_replicates
from tester.analysis.results import ConditionStatus, RepeatResult
from tester.analysis.schemes import EACH, OTHER_HALF, PAIRS, scheme_of
from tester.analysis.stability import Window
from tester.analysis.terms import Size
from tester.analysis.uncertainty import Contribution
from tester.kinds.wheel_on_belt.budget import TERMS
from tests.tester.analysis.pairs import refused, series
from tests.tester.analysis.series import block, correlated

VALUES = (0.70, 0.72, 0.71, 0.73, 0.69, 0.72)


def test_the_scheme_follows_from_the_recipe() -> None:
    assert scheme_of(both_directions=False) is EACH and scheme_of(both_directions=True) is PAIRS


def test_a_condition_s_value_is_the_mean_of_its_pairs_with_their_scatter() -> None:
    found = PAIRS.combine(series(VALUES, 0.5), 3)
    pairs = [0.71, 0.72, 0.705]
    assert found.ok and (found.counts.valid, found.counts.asked) == (3, 3)
    assert found.mu_resultant == pytest.approx(sum(pairs) / 3, rel=3e-4)
    assert found.s == pytest.approx(stdev(pairs), rel=0.03)


def test_each_direction_has_its_own_mean() -> None:
    ways = PAIRS.combine(series(VALUES, 0.5), 3).both_ways
    assert ways is not None and (ways.forward.n, ways.backward.n) == (3, 3)
    assert ways.forward.mu > sum(VALUES) / 6 > ways.backward.mu
    assert ways.forward.along > 0.0 > ways.backward.along


def test_a_repeat_that_is_refused_takes_the_other_of_its_pair_with_it() -> None:
    results = series((*VALUES, 0.7, 0.7))
    results[2] = refused(results[2])
    found = PAIRS.combine(results, 3)
    assert found.n_valid == 3 and found.flags == ""
    assert {one.position: one.reason for one in found.excluded} == {
        2: "refused: drifts by +4.0 % a window", 3: OTHER_HALF,
    }  # fmt: skip
    assert PAIRS.values(results) == pytest.approx([0.71, 0.705, 0.70])


def test_a_repeat_that_a_person_leaves_out_takes_the_other_of_its_pair_with_it() -> None:
    found = PAIRS.combine(series(VALUES), 3, min_valid=2, by_hand={5: "rubber torn"})
    assert found.n_valid == 2
    assert {one.position: one.reason for one in found.excluded} == {
        4: OTHER_HALF, 5: "excluded by hand: rubber torn",
    }  # fmt: skip


def test_a_condition_that_ended_within_a_pair_goes_without_it() -> None:
    found = PAIRS.combine(series(VALUES[:5]), 3, ended=ConditionStatus.OK)
    assert found.n_valid == 2 and "short" in flags_in(found.flags)
    assert [one.position for one in found.excluded] == [4]


def test_a_condition_under_way_is_not_measured_until_its_last_pair_is() -> None:
    assert PAIRS.combine(series(VALUES[:5]), 3).status is ConditionStatus.PENDING


def steady(seed: int, drift: float = 0.0, noisy: float = 0.3) -> list[Block]:
    """Return 45 turns; ``drift``: share of the coefficient a window of 30; ``noisy``: share of the usual noise."""
    noise = correlated(Random(seed))
    return [block(0.7 * (1.0 + next(noise) * noisy + drift * (i - 22) / 30.0), at_s=0.353 * i) for i in range(45)]


def judged(drifts: dict[int, float], noisy: float = 0.3) -> tuple[list[RepeatResult], str, float]:
    """Judge six repeats, some with drift; return them, the flags, the drift."""
    results = series([0.7] * 6)
    found, judgement = PAIRS.judge(results, [steady(i, drifts.get(i, 0.0), noisy) for i in range(6)], 3, Window(30.0))
    return found, judgement.flags, judgement.drift_percent


def test_each_direction_has_a_drift_of_its_own_and_opposite_ones_cancel_in_the_mean() -> None:
    """Drift of the zero of Fx: the one direction rises as the other falls."""
    ways = {i: (0.012 if i in (0, 3, 4) else -0.012) for i in range(6)}
    found, flags, drift = judged(ways)
    assert all(found[i].drift_percent > 0.5 for i in (0, 3, 4)) and all(found[i].drift_percent < -0.5 for i in (1, 2))
    assert abs(drift) < 0.3 and NOT_SHOWN not in flags


def test_a_direction_that_drifts_is_reported_though_the_other_does_not() -> None:
    assert NOT_SHOWN not in judged({}, 2.0)[1]
    _, flags, _ = judged(dict.fromkeys((0, 3, 4), 0.018), 2.0)
    assert NOT_SHOWN in flags_in(flags)


def test_a_repeat_that_drifts_is_refused_among_those_of_its_direction() -> None:
    found, _, _ = judged({3: 0.06})
    assert [one.valid for one in found] == [True, True, True, False, True, True]


def of_budget(both: bool) -> dict[str, Contribution]:
    results = series(VALUES) if both else series([VALUES[0], *VALUES[2:5:2]])
    found = (PAIRS if both else EACH).combine(results, 3)
    other = (PAIRS if both else EACH).combine(series([value * 0.5 for value in VALUES]) if both else results, 3)
    warmth = SurfaceWarmth(25.0, 25.0, 0.0, Slope(0.0005, 0.002, "known of it"))
    by = Surroundings(TERMS, pooled([found, other]), warmth, Size(90.0, 0.1))
    return {one.name: one for one in with_budget(found, by).budget.contributions}


def test_the_budget_of_both_directions_has_next_to_no_misalignment() -> None:
    assert of_budget(True)["axis misalignment"].standard < 0.01 * of_budget(False)["axis misalignment"].standard
    assert of_budget(True)["cell linearity, friction"].standard == pytest.approx(
        of_budget(False)["cell linearity, friction"].standard, rel=1e-6
    )


def test_the_largest_term_of_one_direction_is_the_session_s_misalignment() -> None:
    found = {name: one.standard for name, one in of_budget(False).items() if name != "repeatability"}
    assert max(found, key=found.__getitem__) == "axis misalignment"


def test_repeatability_of_pairs_is_pooled_as_that_of_repeats() -> None:
    """Two repeats make a value: it scatters by 1 / sqrt 2 of a repeat, and with n values by 1 / sqrt n of that."""
    found = PAIRS.combine(series(VALUES), 3)
    pool = pooled([found])
    assert 0.01 * pool.s_percent == pytest.approx(sqrt(2.0) * found.s / found.mu_resultant)
    one = of_budget(True)["repeatability"]
    assert one.standard == pytest.approx(found.s / sqrt(3.0), rel=1e-6)
    assert one.source == "s pooled over the run, 3 pairs of repeats"


def test_replicates_in_both_directions_stay_free_of_misalignment() -> None:
    wheels = [PAIRS.combine(series([value * share for value in VALUES], 0.5), 3) for share in (1.0, 1.03)]
    ways = combine_replicates(wheels).both_ways
    assert ways is not None and ways.pairs == 6 and ways.turning["belt_speed_m_s"] == pytest.approx(-0.3)
    assert combine_replicates([wheels[0], replace(wheels[1], both_ways=None)]).both_ways is None
