"""Origin of a specimen, measurements of it, and the checklist at mounting."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.inputs.recipe.conditions import metadata_of
from tester.inputs.recipe.loader import check, load_checked
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.recipe.plan_steps import MountSpecimen
from tester.kinds.specimen_on_track.rig import TrackConfig

SPECIMEN = "{compound: SBR, note: die 3, origin: {lot: A12, mixed: 2026-10-30, mould: M7}, measured: {hardness: 64.5}}"
REST = """\
measure: {repeats: 1, min_valid: 1, distance: 0.25 mm, at_least: 5 s}
grids:
  - name: one
    load: 20 N
    temperature: 20 degC
    track_speed: 1e-4 m/s
"""
RIG = TrackConfig.of(load_rig("grosch"))


def text(specimen: str = SPECIMEN, more: str = "") -> str:
    return f"recipe: pieces\nkind: specimen_on_track\nspecimens: [{specimen}]\n{more}{REST}"


def problems(recipe: str) -> str:
    return "\n".join(str(problem) for problem in check(recipe, RIG, PART, "r.yaml"))


def test_origin_and_measured_values_are_stored_with_specimen_and_unit() -> None:
    recipe = load_checked(text(), RIG, PART).recipe
    assert metadata_of(recipe) == {
        "specimen_1_lot": "A12",
        "specimen_1_mixed": "2026-10-30",
        "specimen_1_mould": "M7",
        "specimen_1_hardness_shore_a": "64.5",
    }


def test_an_undescribed_specimen_adds_nothing() -> None:
    assert not metadata_of(load_checked(text("{compound: SBR}"), RIG, PART).recipe)


def test_replicates_have_a_value_each() -> None:
    specimen = "{compound: SBR, measured: {hardness: [64, 65], diameter: [10.1 mm, 10 mm]}}"
    recipe = load_checked(text(specimen, "replicates: 2\n"), RIG, PART).recipe
    assert metadata_of(recipe) == {
        "specimen_1_hardness_shore_a": "64 65",
        "specimen_1_diameter_mm": "10.1 10",
    }


def test_too_few_values_are_refused_by_name() -> None:
    found = problems(text(more="replicates: 3\n"))
    assert "specimens, item 1, measured.hardness has 1 values (expected one for each replicate: 3)" in found


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ("measured: {hardness: 101}", "101 Shore A is too large (expected at most 100 Shore A)"),
        ("measured: {hardness: 5 mm}", "hardness"),
        ("measured: {diameter: 0 mm}", "diameter"),
        ("origin: {cured: last week}", '"last week" is not a day (expected one as "2026-11-25")'),
        ("origin: {batch: 7}", "batch"),
    ],
)
def test_a_wrong_value_is_refused(wrong: str, says: str) -> None:
    assert says in problems(text(f"{{compound: SBR, {wrong}}}"))


def test_the_question_at_mounting_lists_the_checks() -> None:
    recipe = load_checked(text(more="checklist: [face flat, clamp at 2 Nm]\n"), RIG, PART).recipe
    notes = [getattr(step, "note", "") for step in PART.expand(recipe, RIG).steps]
    assert "die 3; check: face flat; clamp at 2 Nm" in notes


def test_the_example_of_the_page_is_valid() -> None:
    page = (Path(__file__).parents[4] / "docs" / "how-to" / "describe-a-compound.md").read_text(encoding="utf-8")
    example = page.partition("## What is put on")[2].partition("```yaml\n")[2].partition("```")[0]
    recipe = f"recipe: page\nkind: specimen_on_track\n{example.replace('tread A', 'SBR')}{REST}"
    assert not problems(recipe)


def test_a_checklist_is_short_enough_to_read() -> None:
    assert "checklist" in problems(text(more=f"checklist: [{', '.join('abcdefghijklmnopqrstu')}]\n"))


def test_a_hardness_to_be_asked_is_no_value_and_goes_with_each_specimen() -> None:
    asked = "{compound: SBR, measured: {hardness: prompt}}, {compound: SBR}"
    loaded = load_checked(text(asked, "replicates: 2\n"), RIG, PART)
    plan = PART.expand(loaded.recipe, RIG)
    assert loaded.doubts == () and plan.metadata == {}
    mounts = [step.hardness for step in plan.steps if isinstance(step, MountSpecimen)]
    assert mounts == [True, True, False, False]


def test_any_other_text_is_no_hardness() -> None:
    assert '"often" is not' in problems(text("{compound: SBR, measured: {hardness: often}}"))
