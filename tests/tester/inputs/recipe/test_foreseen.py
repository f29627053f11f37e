"""What a plan foresees of its uncertainty, and what would halve the largest term."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest

from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Term
from tester.inputs.recipe.foreseen import MOST, Foreseen, foreseen, foreseen_fields, foreseen_lines, halved
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tests.tester.inputs.recipe.texts import PREPARED, recipe, rig

SLOW = """\
recipe: slow
specimens: [{compound: "1#"}]
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
measure: {wheel_speed: 0.8 m/s, repeats: 5%s}
grids:
  - {name: fast, slip_velocity: 300 mm/s, load: 400 N, temperature: [25 degC, 40 degC]}
  - {name: slow, slip_velocity: 100 mm/s, load: 200 N, temperature: [25 degC, 40 degC]}
"""
ESTIMATOR = WheelEstimator(rig())


def of(text: str, known: Sequence[KnownSlope] = ()) -> list[Foreseen]:
    plan = expand(recipe(text), rig())
    return foreseen(plan, ESTIMATOR.walk(plan), ESTIMATOR, known)


def worst(text: str) -> Foreseen:
    return max(of(text), key=lambda one: one.percent)


def test_on_a_worn_wheel_at_a_low_slip_the_diameter_is_the_largest_term() -> None:
    found = worst(SLOW % "")
    assert found.largest.name == "diameter worn off" and found.percent > 8.0


def test_what_halves_the_diameter_is_a_check_and_the_plan_with_it_says_so_too() -> None:
    better = halved(worst(SLOW % ""), ESTIMATOR, TERMS)
    assert better is not None and "wear_check: each_condition" in better.words
    checked = worst(SLOW % ", wear_check: each_condition")
    assert checked.largest.name != "diameter worn off" and checked.percent < 8.0


def test_what_halves_the_misalignment_is_both_directions() -> None:
    found = worst(SLOW % ", wear_check: each_condition")
    better = halved(found, ESTIMATOR, TERMS)
    assert found.largest.name == "axis misalignment"
    assert better is not None and "both_directions: true" in better.words
    assert better.percent < 0.5 * found.percent_of(found.largest)


def test_a_term_that_no_recipe_halves_is_to_be_known_better() -> None:
    found = worst(SLOW % ", wear_check: each_condition, both_directions: true")
    (cell,) = [one for one in found.whole.contributions if one.name == "cell linearity, friction"]
    better = halved(replace(found, whole=replace(found.whole, contributions=(cell,))), ESTIMATOR, TERMS)
    (term,) = [one for one in TERMS if one.name == cell.name]
    assert better is not None
    assert better.words == f"knowing it to {0.5 * term.bound:g} N (experiment: {{uncertainty.{term.setting}: 0.5}})"
    assert better.percent == pytest.approx(0.5 * found.percent_of(cell))


def test_four_times_the_repeats_halve_the_repeatability() -> None:
    found = worst(SLOW % ", wear_check: each_condition, both_directions: true")
    loud = replace(found, whole=replace(found.whole, contributions=(found.whole.contributions[-1],)))
    better = halved(loud, ESTIMATOR, TERMS)
    assert better is not None and better.words == "measure: {repeats: 20}"


def test_a_sensitivity_that_no_pair_tells_is_unknown_and_a_file_may_say_it() -> None:
    single = PREPARED.replace("[40 degC, 25 degC]", "40 degC")
    (one, *_), (known, *_) = of(single), of(single, [KnownSlope("1#", 40.0, 0.4, 0.2, "a file")])
    assert not one.outlook.slope.known and known.outlook.slope.source == "a file"
    assert known.percent < one.percent


def test_pairs_of_the_plan_tell_it_before_a_file() -> None:
    (one, *_) = of(PREPARED, [KnownSlope("1#", 40.0, 0.4, 0.2, "a file")])
    assert one.outlook.slope.source.startswith("the run's own conditions")


def test_a_term_that_nothing_halves_has_no_proposal() -> None:
    found = worst(SLOW % "")
    other = replace(found.largest, name="something else")
    assert halved(replace(found, whole=replace(found.whole, contributions=(other,))), ESTIMATOR, TERMS) is None


def test_lines_and_fields_say_the_same() -> None:
    found = of(SLOW % "")
    terms: tuple[Term, ...] = TERMS
    fields, text = foreseen_fields(found, ESTIMATOR, terms), "\n".join(foreseen_lines(found, ESTIMATOR, terms))
    assert f"{fields['largest']}, {fields['largest_percent']:.2g} %" in text
    assert f"halved by {fields['halved_by']}: {fields['halved_percent']:.2g} %" in text
    assert f"to {fields['most_percent']:.2g} % of this piece" in text


def test_where_nothing_slides_nothing_is_said() -> None:
    assert list(foreseen_lines([], ESTIMATOR, TERMS)) == [] and foreseen_fields([], ESTIMATOR, TERMS) == {}


def test_of_a_long_plan_some_conditions_are_looked_at() -> None:
    many = ", ".join(f"{100 + 0.1 * i:g} N" for i in range(MOST + 100))
    found = of(PREPARED.replace("100 N, 200 N", many))
    assert MOST / 2 <= len(found) <= MOST


@pytest.mark.parametrize("text", [SLOW % "", SLOW % ", wear_check: each_condition"])
def test_the_sum_is_that_of_its_terms(text: str) -> None:
    found = worst(text)
    together = sum(one.standard**2 for one in found.whole.contributions) ** 0.5
    assert found.whole.standard == pytest.approx(together)
