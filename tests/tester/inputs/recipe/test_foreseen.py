"""Predicted uncertainty of a plan, and the change that would halve its largest term."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, log

import pytest

import recipes
from sim.physics.friction import COMPOUNDS, FrictionModel
from tester.analysis.kelvin import KnownSlope
from tester.analysis.terms import Term
from tester.base.source import InvalidSource
from tester.inputs.materials.compound import compound_model
from tester.inputs.materials.library import Library
from tester.inputs.materials.material_schema import CompoundModel
from tester.inputs.recipe.foreseen import (
    LEAST_PERCENT,
    MOST,
    SHARE,
    Foreseen,
    foreseen,
    foreseen_fields,
    foreseen_lines,
    halved,
    known_slope,
    known_slopes,
)
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.run.kind_lookup import load_rig, recipe_part
from tests.tester.inputs.recipe.test_precision import small_plan
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


def part(found: Foreseen, name: str) -> Foreseen:
    """Return an outlook with one of its terms alone."""
    alone = tuple(one for one in found.whole.contributions if one.name == name)
    return replace(found, whole=replace(found.whole, contributions=alone))


def test_touches_leave_less_of_a_worn_wheel_than_the_misalignment() -> None:
    found = worst(SLOW % "")
    diameter = part(found, "diameter worn off")
    assert found.largest.name == "axis misalignment"
    assert 0.8 < diameter.percent_of(diameter.largest) < found.percent_of(found.largest)


def test_a_check_halves_the_diameter_term_and_the_plan_with_it_agrees() -> None:
    found = worst(SLOW % "")
    better = halved(part(found, "diameter worn off"), ESTIMATOR, TERMS)
    assert better is not None and "wear_check: each_condition" in better.words
    assert worst(SLOW % ", wear_check: each_condition").percent < found.percent


def test_both_directions_halve_the_misalignment_term() -> None:
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


def test_a_sensitivity_without_pairs_is_unknown_and_a_file_may_state_it() -> None:
    single = PREPARED.replace("[40 degC, 25 degC]", "40 degC")
    (one, *_), (known, *_) = of(single), of(single, [KnownSlope("1#", 40.0, 0.4, 0.2, "a file")])
    assert not one.outlook.slope.known and known.outlook.slope.source == "a file"
    assert known.percent < one.percent


def test_pairs_of_the_plan_take_precedence_over_a_file() -> None:
    (one, *_) = of(PREPARED, [KnownSlope("1#", 40.0, 0.4, 0.2, "a file")])
    assert one.outlook.slope.source.startswith("the run's own conditions")


def test_a_term_that_nothing_halves_has_no_proposal() -> None:
    found = worst(SLOW % "")
    other = replace(found.largest, name="something else")
    assert halved(replace(found, whole=replace(found.whole, contributions=(other,))), ESTIMATOR, TERMS) is None


def test_lines_and_fields_agree() -> None:
    found = of(SLOW % "")
    terms: tuple[Term, ...] = TERMS
    fields, text = foreseen_fields(found, ESTIMATOR, terms), "\n".join(foreseen_lines(found, ESTIMATOR, terms))
    assert f"{fields['largest']}, {fields['largest_percent']:.2g} %" in text
    assert f"halved by {fields['halved_by']}: {fields['halved_percent']:.2g} %" in text
    assert f"to {fields['most_percent']:.2g} % of this piece" in text


def test_without_sliding_there_is_no_outlook() -> None:
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


LAW = "over_temperature: {alpha: 0.5, beta: 0.001 1/K2, gamma: 1, Tm: 60 degC, least: 20 degC, most: 80 degC}"
TEXT = f"name: mine\nsource: a fit of 12 conditions\n{LAW}\n"


def compound(text: str = TEXT) -> CompoundModel:
    return compound_model(text, "mine.yaml")


@pytest.mark.parametrize("name", COMPOUNDS)
@pytest.mark.parametrize("at_c", [25.0, 40.0, 55.0, 73.0, 85.0])
def test_the_papers_compounds_have_the_papers_law_in_their_files(name: str, at_c: float) -> None:
    law = FrictionModel(name)
    numeric = log(law.mu(at_c + 0.01, 200.0, 0.3) / law.mu(at_c - 0.01, 200.0, 0.3)) / 0.02
    found = known_slope(Library([recipes.FOLDER]).compound(name).model, at_c)
    assert found is not None and found.slope.per_kelvin == pytest.approx(numeric, abs=1e-6)
    assert "Table 3 of doi 10.3390/polym16050596" in found.source


def test_a_sensitivity_from_a_file_names_the_file_s_source() -> None:
    found = known_slope(compound(), 40.0)
    assert found is not None and found.source == "the compound's file: a fit of 12 conditions"


def test_its_uncertainty_is_a_share_of_it_and_no_less_than_the_least() -> None:
    steep, flat = known_slope(compound(), 40.0), known_slope(compound(), 60.0)
    assert steep is not None and flat is not None
    assert steep.u_per_kelvin_percent == pytest.approx(hypot(SHARE * steep.per_kelvin_percent, LEAST_PERCENT))
    assert (flat.per_kelvin_percent, flat.u_per_kelvin_percent) == (pytest.approx(0.0), pytest.approx(LEAST_PERCENT))


@pytest.mark.parametrize("at_c", [19.9, 80.1])
def test_nothing_is_known_beyond_the_temperatures_of_the_law(at_c: float) -> None:
    assert known_slope(compound(), at_c) is None


def test_a_file_without_such_a_law_gives_no_sensitivity() -> None:
    assert known_slope(compound("name: mine\n"), 40.0) is None


def test_each_compound_of_a_plan_is_asked_once_at_each_temperature() -> None:
    plan = small_plan()
    temperatures = {one.setpoint.number("temperature") for one in plan.conditions()}
    found = list(known_slopes(plan, {"1#": compound(TEXT.replace("mine", '"1#"'))}))
    assert {(one.compound, one.temperature_c) for one in found} == {("1#", at_c) for at_c in temperatures}


def test_a_compound_without_a_file_is_left_out() -> None:
    assert not list(known_slopes(small_plan(), {}))


@pytest.mark.parametrize(
    ("changed", "message"),
    [("most: 10 degC", "not above least"), ("alpha: -1.5", "expected more than 0"), ("beta: 0 1/K2", "beta")],
)
def test_a_law_that_makes_no_sense_is_refused(changed: str, message: str) -> None:
    key = changed.partition(":")[0]
    old = next(part for part in LAW.strip("}").partition("{")[2].split(", ") if part.startswith(f"{key}:"))
    with pytest.raises(InvalidSource, match=message):
        compound(TEXT.replace(old, changed))


@pytest.mark.parametrize(("law", "described"), [("paper", True), ("v2", True), ("power", False)])
def test_a_simulated_wheel_rubs_as_described_where_its_law_is_the_papers(law: str, described: bool) -> None:
    rig = load_rig("sim", (f"sim.friction_model={law}",))
    assert recipe_part(rig).rubs_as_described(rig) is described


def test_a_simulated_track_does_not() -> None:
    rig = load_rig("grosch")
    assert not recipe_part(rig).rubs_as_described(rig)
