"""Recipes for a specimen on a track: refusals, the plan, its remaining steps."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.inputs.recipe.loader import check
from tester.inputs.recipe.plan import Mounted, Plan, Stand
from tester.inputs.recipe.plan_text import lines
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.recipe.plan_steps import Cover, MountSpecimen, Open, Prepare, Temper, TrackCondition
from tests.tester.inputs.recipe.texts import load_recipe
from tests.tester.kinds.specimen_on_track.bench import DISC, GROSCH


def plan(text: str = DISC, rig: str = "pin-on-disc") -> Plan:
    return PART.expand(load_recipe(text, PART, "r.yaml").recipe, load_rig(rig))


def problems(text: str, rig: str) -> list[str]:
    return [problem.message for problem in check(text, load_rig(rig), PART)]


@pytest.mark.parametrize(
    ("change", "rig", "said"),
    [
        (("3 mm/s", "30 mm/s"), "grosch", "is beyond what the track does"),
        (("0.1 mm/s", "0.1 um/s"), "grosch", "track_speed"),
        (("load: 20 N", "load: 15 N"), "grosch", "no weights make 15 N (weights of rig"),
        (("temperature: 23 degC", "temperature: -60 degC"), "grosch", "is beyond the air's range"),
        (("distance: 0.4 mm", "window: 30 rev"), "grosch", "this machine slides for a way (expected distance)"),
    ],
)
def test_conditions_beyond_the_rig_are_refused(change: tuple[str, str], rig: str, said: str) -> None:
    assert any(said in one for one in problems(GROSCH.replace(*change), rig))


def test_a_check_reports_where_friction_heat_would_matter() -> None:
    text = GROSCH.replace("load: 20 N", "load: 40 N").replace("3 mm/s", "10 mm/s")
    text = text.replace("repeats: 1", "repeats: 1, temperature_band: 0.1 K").replace("within: 1 K", "within: 0.1 K")
    (said,) = problems(text, "grosch")
    assert "friction warms the contact by 0.2 K at SBR, 40 N, 23 degC, 10 mm/s, more than its band of 0.1 K" in said


def test_air_that_no_heater_brings_about_is_refused_with_the_reason() -> None:
    (said,) = problems(DISC.replace("temperature: 23 degC", "temperature: 40 degC"), "pin-on-disc")
    assert said == (
        'temperature: 40 degC cannot be reached: rig "simulated pin on disc" has no chamber, and its room is at 23 degC'
        " (sim.ambient; expected within 3 K of that, soak.within, or a chamber in devices)"
    )
    assert problems(DISC.replace("temperature: 23 degC", "temperature: 25 degC"), "pin-on-disc") == []


WET = DISC.replace("[dry, wet]", "wet").replace("5 K, soak", "5 K, least_friction: 0.02, soak")
FILM = ("sim.contact.wet=0.0094",)


def on_disc(text: str, *overrides: str, high: bool = True) -> list[str]:
    """Return the problems of a recipe on the disc, with or without its height sensor."""
    rig = load_rig("pin-on-disc", overrides)
    devices = {name: device for name, device in rig.devices.items() if high or name != "height_sensor"}
    return [problem.message for problem in check(text, replace(rig, devices=devices), PART)]


def test_friction_that_counts_as_a_lost_contact_is_refused_with_the_key_to_state() -> None:
    text = DISC.replace("compound: SBR", "compound: tread") + "abrasive: {name: road}\n"
    (said,) = on_disc(text, "sim.law=greta")
    assert "sim.law greta expects friction of 0." in said and "at tread, wet, 10 N" in said
    assert "below 5 % the contact counts as lost and the run trips (interlocks.lost_share; state" in said
    assert "state least_friction for a wet or powdered track" in said


def test_low_friction_that_a_rig_cannot_witness_is_refused_with_the_missing_sensor() -> None:
    of_law, stated = on_disc(WET, *FILM, high=False)
    assert stated == (
        "least_friction: 0.02 is too little to show contact (interlocks.lost_share 5 %), and rig"
        ' "simulated pin on disc" has no second reading of it (expected height_sensor in devices, or least_friction of'
        " 0.056 or more)"
    )
    assert 'rig "simulated pin on disc" has no second reading of the contact: height_sensor in devices' in of_law


def test_low_friction_that_is_stated_is_allowed_where_the_height_shows_contact() -> None:
    assert on_disc(WET, *FILM) == []


def test_a_least_friction_above_the_share_needs_no_second_reading() -> None:
    assert on_disc(WET.replace("0.02,", "0.06,"), high=False) == []


def test_low_friction_under_a_small_load_is_refused_with_the_least_load() -> None:
    _, said = on_disc(WET.replace("10 N", "5 N"), *FILM, "weights=[5, 10]")
    assert said == (
        "least_friction: 0.02 of 5 N is 0.1 N, and a deaf cell may show 0.1 N (interlocks.deaf; expected a load of"
        " 5.6 N or more)"
    )


def test_a_law_below_the_stated_friction_is_refused() -> None:
    (said,) = on_disc(WET, "sim.contact.wet=0.004")
    assert "expects friction of 0.88 % of the load at SBR, wet, 10 N, 23 degC, 200 mm/s" in said and "below 1 %" in said
    assert "(interlocks.deaf, or half of least_friction)" in said


def test_a_statement_allows_no_low_friction_on_a_dry_track() -> None:
    text = DISC.replace("[dry, wet]", "dry").replace("5 K, soak", "5 K, least_friction: 0.02, soak")
    (said,) = on_disc(text, "sim.contact.wet=0.6", "sim.rubbers={SBR: {mu_0: 0.02, mu_max: 0.02}}")
    assert "at SBR, 10 N" in said and "below 5 %" in said


def test_friction_well_above_a_lost_contact_is_no_problem() -> None:
    assert on_disc(DISC) == []


def test_on_a_disc_the_plan_states_the_warming_by_friction() -> None:
    text = DISC.replace("0.2 m/s", "1 m/s").replace("5 K", "2 K").replace("within: 3 K", "within: 2 K")
    made, rig = plan(text), load_rig("pin-on-disc")
    assert problems(text, "pin-on-disc") == []
    assert any("friction warms it by 10 K" in line for line in lines(made, PART.estimate(made, rig), PART))


def test_a_person_is_asked_only_for_changes() -> None:
    asked = [step.text for step in plan().steps if isinstance(step, Prepare)]
    assert asked == ["hang 10 N of weights on the arm and make the track clean and dry", "make the track wet"]


def test_the_rest_begins_with_the_steps_to_be_repeated() -> None:
    left = PART.remaining(plan(), Stand(frozenset({1}), frozenset({1}), (Mounted(1, 1, 1, float("nan"), 0.2, False),)))
    install, temper, prepare, condition = left.steps
    assert isinstance(install, MountSpecimen) and install.again and install.sliding_m == 0.2
    assert isinstance(temper, Temper) and isinstance(condition, TrackCondition) and condition.condition == 2
    assert isinstance(prepare, Prepare)
    assert prepare.text == "hang 10 N of weights on the arm and make the track wet"


def test_nothing_is_left_of_a_plan_that_is_done() -> None:
    assert PART.remaining(plan(), Stand(frozenset({1, 2}))).steps == ()


SURFACES = "grids:\n  - {name: one, surface: [glass, silicon carbide], "


def test_a_surface_is_changed_in_the_air_of_the_room_before_its_temperatures() -> None:
    text = GROSCH.replace("grids:\n  - {name: one, ", SURFACES).replace("23 degC", "[0 degC, 20 degC]")
    steps = [step for step in plan(text, "grosch").steps if not isinstance(step, MountSpecimen)]
    shown = [
        step.surface if isinstance(step, Cover)
        else step.temperature_c if isinstance(step, Temper)
        else step.text if isinstance(step, Prepare)
        else str(step.setpoint.value("surface"))[:1] if isinstance(step, TrackCondition)
        else None
        for step in steps
    ]  # fmt: skip
    asked = "hang 20 N of weights on the arm and make the track clean and dry"
    assert shown == [
        23.0, "glass", 0.0, asked, "g", "g", 20.0, "g", "g",
        23.0, "silicon carbide", 0.0, "s", "s", 20.0, "s", "s",
    ]  # fmt: skip
    assert [step.index for step in plan(text, "grosch").steps] == [*range(len(steps) + 1)]


def test_a_new_surface_is_dry() -> None:
    text = DISC.replace("grids:\n  - {name: one, ", SURFACES)
    asked = [step.text if isinstance(step, Prepare) else step.surface for step in plan(text).steps
             if isinstance(step, Cover | Prepare)]  # fmt: skip
    assert asked == [
        "glass", "hang 10 N of weights on the arm and make the track clean and dry", "make the track wet",
        "silicon carbide", "make the track wet",
    ]  # fmt: skip


def test_the_rest_begins_on_its_surface() -> None:
    text = DISC.replace("grids:\n  - {name: one, ", SURFACES)
    ended = frozenset({1, 2, 3})
    left = PART.remaining(plan(text), Stand(ended, ended, (Mounted(1, 1, 1, float("nan"), 0.2, False),)))
    assert [step.kind for step in left.steps] == ["install", "cover", "temper", "prepare", "condition"]
    assert isinstance(left.steps[1], Cover) and left.steps[1].surface == "silicon carbide"


def test_the_rest_opens_the_chamber_first_and_prepares_the_covered_surface() -> None:
    text = GROSCH.replace("grids:\n  - {name: one, ", SURFACES).replace("23 degC", "[0 degC, 20 degC]")
    text = text.replace("load: 20 N", "interface: [dry, wet], load: 20 N")
    whole = plan(text, "grosch")
    first = {step.condition for step in whole.conditions() if step.setpoint.value("surface") == "glass"}
    for ended in ({1}, first):
        left = PART.remaining(whole, Stand(frozenset(ended), frozenset(ended), ())).steps
        places = [number for number, step in enumerate(left) if isinstance(step, Cover)]
        assert all(isinstance(left[place - 1], Open) for place in places)
        assert [left[place].title for place in places][-1] == "cover the track with silicon carbide"
        assert len(places) == (2 if ended == {1} else 1)
    assert [step.kind for step in left[:6]] == ["install", "open", "cover", "prepare", "temper", "condition"]
    assert isinstance(left[3], Prepare) and left[3].text.endswith("make the track clean and dry")


def test_conditions_on_a_surface_name_it() -> None:
    text = DISC.replace("grids:\n  - {name: one, ", SURFACES)
    said = "\n".join(lines(made := plan(text), PART.estimate(made, load_rig("pin-on-disc")), PART))
    assert "on glass, 10 N" in said and "ask: cover the track with silicon carbide" in said


def test_surfaces_are_named_in_one_place() -> None:
    text = DISC.replace("grids:\n  - {name: one, ", SURFACES)
    (said,) = problems(text.replace("specimens:", "abrasive: {name: road}\nspecimens:"), "pin-on-disc")
    assert said == "abrasive: the grids name surfaces (expected one of both)"
    more = "  - {name: two, load: 20 N, temperature: 23 degC, track_speed: 0.1 m/s}\n"
    (said,) = problems(text + more, "pin-on-disc")
    assert said == "surface is missing: another grid names its own (expected one in every grid)"
