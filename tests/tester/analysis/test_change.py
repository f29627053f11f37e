"""Changes of friction at once, within a repeat and between repeats."""

from __future__ import annotations

from itertools import islice
from math import isnan
from random import Random

import pytest

from tester.analysis.change import LIMIT_PERCENT, change_between, change_within, greatest
from tester.analysis.flags import CHANGED, flags_in
from tester.analysis.left_out import REPEATABILITY
from tester.analysis.reduce import reduce_repeat
from tester.analysis.repeats import combine_repeats
from tester.analysis.results import NAN, ConditionStatus
from tester.analysis.schemes import PAIRS
from tester.analysis.stability import Window
from tests.tester.analysis.series import blocks, correlated

WINDOW = Window(30)


def noisy(seed: int, levels: list[float]) -> list[float]:
    """Return block means about these levels, with AR(1) noise."""
    noise = islice(correlated(Random(seed)), len(levels))
    return [0.7 * level * (1.0 + x) for level, x in zip(levels, noise, strict=True)]


@pytest.mark.parametrize("at", [3, 10, 22, 40])
def test_a_step_within_a_repeat_is_reported_with_its_size(at: int) -> None:
    values = noisy(1, [1.0] * at + [1.15] * (45 - at))
    mean = (at + 1.15 * (45 - at)) / 45
    assert change_within(blocks(values, per_burst=15)) == pytest.approx(15.0 / mean, abs=1.5)


def test_a_step_down_is_below_zero() -> None:
    assert change_within(blocks(noisy(1, [1.0] * 20 + [0.85] * 25))) == pytest.approx(-16.0, abs=1.5)


@pytest.mark.parametrize("seed", range(30))
def test_steady_friction_shows_no_change_to_speak_of(seed: int) -> None:
    assert abs(change_within(blocks(noisy(seed, [1.0] * 45), per_burst=15))) < LIMIT_PERCENT


def test_an_effect_of_temperature_is_not_a_change() -> None:
    surface = [39.0 + 2.0 * i / 14 for i in range(15)]
    values = [0.7 * (1.0 - 0.025 * (surface[i % 15] - 40.0)) for i in range(45)]
    assert abs(change_within(blocks(values, per_burst=15, surface=surface))) < 1.0


def test_too_few_blocks_give_no_result() -> None:
    assert isnan(change_within(blocks([0.7] * 5)))


def test_a_step_left_out_as_a_transient_is_reported() -> None:
    result = reduce_repeat(blocks(noisy(3, [1.0] * 15 + [1.15] * 30)), WINDOW)
    assert result.truncated >= 14
    assert result.change_percent > 12.0


def test_a_change_of_no_slip_is_not_looked_for() -> None:
    assert isnan(reduce_repeat(blocks([0.02] * 10 + [0.03] * 35), WINDOW, rolling=True).change_percent)


@pytest.mark.parametrize("values", [[1.0, 1.15], [1.15, 1.0, 1.0], [1.0, 1.0, 1.15], [1.0, 1.01, 1.14, 1.16, 1.15]])
def test_a_step_between_repeats_is_reported(values: list[float]) -> None:
    assert abs(change_between(values, REPEATABILITY)) > LIMIT_PERCENT


def test_repeats_that_scatter_as_they_do_are_no_change() -> None:
    random = Random(5)
    told = sum(change_between([random.gauss(1.0, 0.02) for _ in range(3)], REPEATABILITY) != 0.0 for _ in range(2000))
    assert told <= 12  # asked: one in a thousand; 2 are expected, and its own s takes some more


def test_one_repeat_alone_has_no_change_between() -> None:
    assert change_between([0.7], REPEATABILITY) == 0.0


def test_the_greatest_of_nothing_known_is_unknown() -> None:
    assert isnan(greatest([NAN])) and greatest([1.0, NAN, -3.0]) == -3.0


def test_a_condition_whose_friction_changed_carries_a_doubt() -> None:
    first = reduce_repeat(blocks(noisy(3, [1.0] * 15 + [1.15] * 40)), WINDOW)
    later = [reduce_repeat(blocks(noisy(seed, [1.15] * 45)), WINDOW) for seed in (4, 5)]
    found = combine_repeats([first, *later], 3, ended=ConditionStatus.OK)
    assert CHANGED in found.doubts and found.change_percent == first.change_percent


def test_repeats_that_part_carry_a_doubt() -> None:
    made = [reduce_repeat(blocks(noisy(seed, [level] * 45)), WINDOW) for seed, level in enumerate((1.0, 1.15, 1.15))]
    assert CHANGED in combine_repeats(made, 3, ended=ConditionStatus.OK).doubts


def test_a_repeat_that_a_person_left_out_is_not_looked_at() -> None:
    made = [reduce_repeat(blocks(noisy(seed, [level] * 45)), WINDOW) for seed, level in enumerate((1.2, 1.0, 1.0, 1.0))]
    found = combine_repeats(made, 3, ended=ConditionStatus.OK, by_hand={0: "dust"})
    assert CHANGED not in flags_in(found.flags)


def test_directions_that_differ_are_no_change_and_a_step_in_one_is() -> None:
    def pairs(levels: list[float]) -> tuple[str, ...]:
        made = [reduce_repeat(blocks(noisy(seed, [level] * 45)), WINDOW) for seed, level in enumerate(levels)]
        return PAIRS.combine(made, 3, ended=ConditionStatus.OK).doubts

    assert CHANGED not in pairs([1.0, 1.1, 1.1, 1.0, 1.0, 1.1])
    assert CHANGED in pairs([1.0, 1.1, 1.1, 1.0, 1.15, 1.265])
