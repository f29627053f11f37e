"""Measured diameters and hardnesses in a recipe, compared with the rig's wheel and the compound's file."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.inputs.recipe.loader import load_checked
from tester.kinds.wheel_on_belt.recipe.measured_wheels import INSTALLED_MM, off_place_mm
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import SMALL, rig

RIG = rig()
NEW_MM = RIG.geometry.wheel_diameter_mm


def text(measured: str, compound: str = '"1#"') -> str:
    return SMALL.replace('- compound: "1#"', f"- compound: {compound}\n    measured: {{{measured}}}")


def doubts(recipe: str | Path) -> list[str]:
    return [one.message for one in load_checked(recipe, RIG, PART, "r.yaml").doubts]


def test_a_diameter_within_its_uncertainty_is_no_doubt() -> None:
    assert not doubts(text(f"diameter: {NEW_MM + 0.9 * INSTALLED_MM:.3f} mm"))


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_diameter_beyond_it_is_a_doubt_with_its_effect_on_the_speeds(sign: float) -> None:
    (said,) = doubts(text(f"diameter: {NEW_MM + sign * 0.9:.2f} mm"))
    assert "every speed of the wheel is off by 1.0 %" in said
    assert f'expected geometry.wheel_diameter of rig "{RIG.name}": {NEW_MM:g} mm, within {INSTALLED_MM:g} mm' in said


def test_a_wheel_that_its_first_contact_would_refuse_is_an_error() -> None:
    off_mm = 2.0 * off_place_mm(RIG, NEW_MM)
    with pytest.raises(InvalidSource, match="its first contact fails"):
        doubts(text(f"diameter: {NEW_MM - off_mm - 0.1:.2f} mm"))


def test_the_outlier_among_replicates_is_named() -> None:
    recipe = text(f"diameter: [{NEW_MM:g} mm, {NEW_MM + 1.0:g} mm]") + "replicates: 2\n"
    (said,) = load_checked(recipe, RIG, PART, "r.yaml").doubts
    assert f"{NEW_MM + 1.0:g} mm" in said.message


def test_a_hardness_that_is_not_the_compounds_is_a_doubt(tmp_path: Path) -> None:
    (tmp_path / "compounds").mkdir()
    law = "law: {form: power, figures: {a: 0.6, v0: 300 mm/s, n: 0.2, n0: 200 N, m: -0.1}}\n"
    (tmp_path / "compounds" / "own.yaml").write_text(f"name: own\nhardness: 64\n{law}", encoding="utf-8")
    file = tmp_path / "r.yaml"
    said: list[list[str]] = []
    for hardness in (62, 71):
        file.write_text(text(f"hardness: {hardness}", "own"), encoding="utf-8")
        said.append([one.message for one in load_checked(file, RIG, PART).doubts])
    assert said[0] == []
    (one,) = said[1]
    assert one.startswith("hardness: 71 Shore A is not that of") and "expected 64 of its file, within 3 [A]" in one


def test_a_hardness_of_a_compound_without_a_file_is_only_recorded() -> None:
    assert not doubts(text("hardness: 64"))
