"""Pressures in a recipe become loads, over the area that recipe or rig file state."""

from __future__ import annotations

import pytest

from tester.analysis.pressure import AREA_MM2, AREA_SOURCE, pressure_kpa
from tester.base.source import InvalidSource, Tree, read_tree
from tester.base.validation import editor_schema
from tester.inputs.recipe.conditions import metadata_of
from tester.inputs.recipe.loader import check, load_checked
from tester.inputs.recipe.pressures import with_loads
from tester.kinds import load_rig, load_rig_text
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.rig import TrackConfig

AREA = "contact: {area: 100 mm2, source: die of 10 mm x 10 mm}\n"
TEXT = f"""\
recipe: pressures
kind: specimen_on_track
specimens: [{{compound: SBR}}]
{AREA}measure: {{repeats: 1, min_valid: 1, distance: 0.25 mm, at_least: 5 s}}
grids:
  - name: one
    pressure: [100 kPa, 0.2 MPa]
    temperature: 20 degC
    track_speed: 1e-4 m/s
"""
RIG = TrackConfig.of(load_rig("grosch"))
STATED = TrackConfig.of(load_rig("grosch", ["contact={area: 50 mm2, source: 'drawing 12'}"]))


def tree_of(text: str) -> Tree:
    return read_tree(text, "r.yaml")[0]


def problems(text: str, rig: TrackConfig = RIG) -> list[str]:
    return [str(problem) for problem in check(text, rig, PART, "r.yaml")]


def test_a_pressure_is_the_load_over_the_area() -> None:
    assert load_checked(TEXT, RIG, PART).recipe == load_checked(
        TEXT.replace("pressure: [100 kPa, 0.2 MPa]", "load: [10 N, 20 N]"), RIG, PART
    ).recipe  # fmt: skip


@pytest.mark.parametrize(
    ("written", "area", "loads"),
    [
        ("55 kPa", "100 mm2", ["5.5 N"]),
        ("[0.1 MPa]", "0.7 cm2", ["7 N"]),
        ("{from: 50 kPa, to: 150 kPa, step: 50 kPa}", "100 mm2", ["5 N", "10 N", "15 N"]),
        ("{from: 10 kPa, to: 1 MPa, per_decade: 2}", "100 mm2", ["1 N", "3.162 N", "10 N", "31.62 N", "100 N"]),
    ],
)
def test_pressures_are_written_like_any_axis(written: str, area: str, loads: list[str]) -> None:
    text = TEXT.replace("[100 kPa, 0.2 MPa]", written).replace("100 mm2", area)
    tree, found = with_loads(tree_of(text))
    assert found == [] and isinstance(tree.data, dict)
    assert tree.data["grids"] == [
        {"name": "one", "temperature": "20 degC", "track_speed": "1e-4 m/s", "load": loads}
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (AREA, "", "r.yaml:7:15: pressure: no area is known to spread a load over (expected contact: {area: 100 mm2}"),
        ("0.2 MPa", "20 N", 'r.yaml:8:25: pressure: "20 N" has the unit of force'),
        ("0.2 MPa", "0 kPa", "r.yaml:8:25: pressure: 0 Pa is too small (expected more than 0 Pa)"),
        ("    temperature", "    load: 10 N\n    temperature", "r.yaml:8:15: pressure: the grid has a load, too"),
        ("100 mm2", "0 mm2", "r.yaml:4:17: area: 0 mm2 is too small (expected more than 0 mm2)"),
        ("0.2 MPa", "0.1 MPa", "r.yaml:8:25: load: 10 N is listed twice"),
        ("[100 kPa, 0.2 MPa]", "{from: 1 MPa, to: 1 kPa, step: 1 kPa}", "r.yaml:8:15: pressure: from, 1e+06 Pa"),
    ],
)
def test_a_wrong_pressure_is_reported_at_its_place(old: str, new: str, message: str) -> None:
    found = problems(TEXT.replace(old, new))
    assert any(one.startswith(message) for one in found), found
    assert not any("load is missing" in one for one in found)


def test_a_load_beyond_the_weights_is_reported_at_its_pressure() -> None:
    found = problems(TEXT.replace("0.2 MPa", "9 MPa"))
    assert found and found[0].startswith("r.yaml:8:25: load: no weights make 900 N"), found


def test_without_pressure_a_recipe_is_as_it_was() -> None:
    tree = tree_of(TEXT.replace("pressure: [100 kPa, 0.2 MPa]", "load: 10 N"))
    same, found = with_loads(tree)
    assert (same.data, same.positions, found) == (tree.data, {**tree.positions}, [])


def test_the_area_is_on_record_and_makes_a_pressure_of_a_load() -> None:
    metadata = metadata_of(load_checked(TEXT, RIG, PART).recipe)
    assert (metadata[AREA_MM2], metadata[AREA_SOURCE]) == ("100", "die of 10 mm x 10 mm")
    assert pressure_kpa(20.0, metadata) == 200.0 and pressure_kpa(20.0, {}) is None


def test_the_rigs_area_counts_where_the_recipe_states_none() -> None:
    own = load_checked(TEXT.replace(AREA, "").replace("100 kPa, 0.2", "0.2 MPa, 0.4"), STATED, PART)
    assert own.recipe.grids[0].model_dump()["load"] == [10.0, 20.0]
    metadata = metadata_of(own.recipe)
    assert (metadata[AREA_MM2], metadata[AREA_SOURCE]) == ("50", "drawing 12")


def test_the_recipes_area_counts_before_the_rigs() -> None:
    metadata = metadata_of(load_checked(TEXT, STATED, PART).recipe)
    assert (metadata[AREA_MM2], metadata[AREA_SOURCE]) == ("100", "die of 10 mm x 10 mm")


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        ("contact={area: 50 mm2}", "source is missing"),
        ("contact={area: 50 mm2, source: ' '}", "expected where the area comes from"),
        ("contact={area: 0 mm2, source: die}", "area: 0 mm2 is too small"),
        ("contact={area: 5 mm, source: die}", "has the unit of length"),
    ],
)
def test_an_area_of_a_rig_file_has_a_unit_and_a_source(stated: str, message: str) -> None:
    with pytest.raises(InvalidSource, match=message):
        load_rig("grosch", [stated])


def test_the_rigs_area_is_that_on_which_a_simulated_law_of_materials_rubs() -> None:
    with pytest.raises(InvalidSource, match="persson rubs on 100 mm2"):
        load_rig("grosch", ["sim.law=persson", "contact={area: 50 mm2, source: die}"])
    load_rig("grosch", ["sim.law=persson", "sim.contact.area=50", "contact={area: 50 mm2, source: die}"])


def test_an_area_survives_the_stored_rig_file() -> None:
    assert load_rig_text(STATED.text) == STATED and "\ncontact:" not in RIG.text


def test_a_simulated_law_of_pressure_needs_the_recipes_area() -> None:
    materials = TrackConfig.of(load_rig("grosch", ["sim.law=persson"]))
    text = TEXT.replace("100 mm2", "50 mm2") + "abrasive: {name: silicon carbide}\n"
    assert any("area: 50 mm2, and sim.law persson rubs on 100 mm2" in one for one in problems(text, materials))
    assert not any("area:" in one for one in problems(text))


def test_editors_accept_a_pressure_in_place_of_a_load() -> None:
    grid = editor_schema(PART.model())["$defs"]["GridModel"]  # type: ignore[index]
    assert "pressure" in grid["properties"] and "load" not in grid["required"]
    assert grid["oneOf"] == [{"required": ["load"]}, {"required": ["pressure"]}]


def test_a_recipe_of_another_form_is_refused_as_before() -> None:
    with pytest.raises(InvalidSource):
        load_checked("recipe: r\ngrids: 3\n", RIG, PART)
