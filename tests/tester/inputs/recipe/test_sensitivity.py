"""What compounds' files say of friction over temperature, and when it is taken."""

from __future__ import annotations

from math import hypot, log

import pytest

import recipes
from sim.physics.friction import COMPOUNDS, FrictionModel
from tester.base.source import InvalidSource
from tester.inputs.materials.compound import compound_model
from tester.inputs.materials.library import Library
from tester.inputs.materials.schema import CompoundModel
from tester.inputs.recipe.sensitivity import LEAST_PERCENT, SHARE, known_slope, known_slopes
from tester.run.kinds import recipe_part
from tester.run.rigs import load_rig
from tests.tester.inputs.recipe.test_precision import small_plan

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


def test_a_file_without_such_a_law_says_nothing() -> None:
    assert known_slope(compound("name: mine\n"), 40.0) is None


def test_each_compound_of_a_plan_is_asked_once_at_each_temperature() -> None:
    plan = small_plan()
    temperatures = {one.setpoint.number("temperature") for one in plan.conditions()}
    found = list(known_slopes(plan, {"1#": compound(TEXT.replace("mine", '"1#"'))}))
    assert {(one.compound, one.temperature_c) for one in found} == {("1#", at_c) for at_c in temperatures}


def test_a_compound_without_a_file_is_left_out() -> None:
    assert not list(known_slopes(small_plan(), {}))


@pytest.mark.parametrize(
    ("changed", "told"),
    [("most: 10 degC", "not above least"), ("alpha: -1.5", "expected more than 0"), ("beta: 0 1/K2", "beta")],
)
def test_a_law_that_makes_no_sense_is_refused(changed: str, told: str) -> None:
    key = changed.partition(":")[0]
    old = next(part for part in LAW.strip("}").partition("{")[2].split(", ") if part.startswith(f"{key}:"))
    with pytest.raises(InvalidSource, match=told):
        compound(TEXT.replace(old, changed))


@pytest.mark.parametrize(("law", "described"), [("paper", True), ("v2", True), ("power", False)])
def test_a_simulated_wheel_rubs_as_described_where_its_law_is_the_papers(law: str, described: bool) -> None:
    rig = load_rig("sim", (f"sim.friction_model={law}",))
    assert recipe_part(rig).rubs_as_described(rig) is described


def test_a_simulated_track_does_not() -> None:
    rig = load_rig("grosch")
    assert not recipe_part(rig).rubs_as_described(rig)
