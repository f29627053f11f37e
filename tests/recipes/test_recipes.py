"""The packaged recipes and how they are found."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import recipes
from tester.base.validation import editor_text
from tester.inputs.recipe.loader import check, load_checked
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.run.kind_lookup import recipe_part
from tests.recipes.asked import asked_by
from tests.tester.inputs.recipe.texts import load_recipe


def test_these_recipes_are_packaged() -> None:
    table2 = ["table2", "table2-load", "table2-sideslip", "table2-slip"]
    assert recipes.names() == ["greta", "grosch", "pin-on-disc", "pre-grind", "pressure", "quickstart", *table2, "wear"]


@pytest.mark.parametrize("name", ["quickstart", "quickstart.yaml", "recipes/quickstart.yaml"])
def test_a_packaged_recipe_is_found_by_name_from_any_folder(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert recipes.find(name) == recipes.FOLDER / "quickstart.yaml"


def test_a_file_comes_before_a_packaged_recipe_of_that_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    own = tmp_path / "quickstart.yaml"
    own.write_text("recipe: mine\n", encoding="utf-8")
    assert recipes.find("quickstart.yaml").resolve() == own


@pytest.mark.parametrize("name", ["nosuch", "elsewhere/quickstart.yaml", "quickstart.txt", "../quickstart", "."])
def test_a_recipe_that_is_neither_file_nor_name_is_refused_with_the_known_names(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(recipes.UnknownRecipe, match=r"packaged are greta, grosch, pin-on-disc, "):
        recipes.find(name)


@pytest.mark.parametrize("name", recipes.names())
def test_every_packaged_recipe_is_valid_on_the_rig_that_its_file_asks_for(name: str) -> None:
    rig_name, changes = asked_by(name)
    rig = load_rig(rig_name, changes, accept_risk="hysteresis alone is weak")
    assert check(recipes.find(name), rig, recipe_part(rig)) == []


def test_grosch_has_11_temperatures_and_9_speeds_on_each_track_and_friction_heats_none() -> None:
    rig = load_rig("grosch")
    part = recipe_part(rig)
    plan = part.expand(load_recipe(recipes.find("grosch"), part).recipe, rig)
    held = [held_by(step.setpoint) for step in plan.conditions()]
    tracks = [(one.surface, one.interface) for one in held]
    assert list(dict.fromkeys(tracks)) == [
        ("wavy glass", "dry"), ("silicon carbide", "dry"), ("silicon carbide", "talc")
    ]  # fmt: skip
    places = {(one.temperature_c, one.track_m_s) for one in held}
    assert len(places) == 99 and len({celsius for celsius, _ in places}) == 11
    for track in set(tracks):
        own = [(one.temperature_c, one.track_m_s) for one in held if (one.surface, one.interface) == track]
        assert len(own) == 99 and set(own) == places
    assert part.estimate(plan, rig).not_held == ()


def test_the_loads_of_the_pressures_are_weights() -> None:
    rig_name, changes = asked_by("pressure")
    rig = load_rig(rig_name, changes)
    part = recipe_part(rig)
    plan = part.expand(load_checked(recipes.find("pressure"), rig, part).recipe, rig)
    assert {held_by(step.setpoint).load_n for step in plan.conditions()} == {10.0, 25.0, 40.0, 55.0, 70.0}


def test_the_packaged_schema_matches_the_output_of_tester_schema() -> None:
    stored = (recipes.FOLDER / "recipe.schema.json").read_text(encoding="utf-8")
    assert stored == editor_text(PART.model()), "write it again: tester schema > recipes/recipe.schema.json"


def test_the_schema_knows_every_key_of_a_recipe() -> None:
    schema = json.loads(editor_text(PART.model()))
    assert {"recipe", "specimens", "pre_grind", "rest", "measure", "grids", "order", "wheel"} <= set(
        schema["properties"]
    )
    assert schema["additionalProperties"] is False
    assert "for" in schema["$defs"]["SoakModel"]["properties"]
