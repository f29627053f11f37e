"""A misspelt key is one problem, not an unknown and a missing one; a number beyond every range is reported as such."""

from __future__ import annotations

import pytest

from tester.base.source import InvalidSource
from tester.base.units import UnitError, parse
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import SMALL, load_recipe


def test_a_misspelt_key_is_one_problem() -> None:
    with pytest.raises(InvalidSource) as caught:
        load_recipe(SMALL.replace("temperature:", "temprature:"), PART)
    (problem,) = caught.value.problems
    assert 'unknown key "temprature", did you mean temperature?' in problem.message


def test_a_key_that_is_missing_besides_stays_a_problem() -> None:
    with pytest.raises(InvalidSource) as caught:
        load_recipe(SMALL.replace("temperature:", "temprature:").replace("    slip_velocity: 300 mm/s\n", ""), PART)
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize(("text", "how"), [("1e400 N", "large"), ("-1e400 N", "large"), ("1e-400 N", "small")])
def test_a_number_beyond_every_range_is_reported_as_such(text: str, how: str) -> None:
    with pytest.raises(UnitError, match=f"is too {how} "):
        parse(text, "N")


def _unknown_of(text: str) -> list[str]:
    """Return the message about unknown keys, up to the list of the known ones."""
    with pytest.raises(InvalidSource) as caught:
        load_recipe(text, PART)
    return [one.message.partition(" (")[0] for one in caught.value.problems]


def test_a_missing_key_is_suggested_before_one_that_is_nearer_in_spelling() -> None:
    assert _unknown_of(SMALL.replace("slip_velocity:", "slip_speed:")) == [
        'unknown key "slip_speed", did you mean slip_velocity?'
    ]


@pytest.mark.parametrize(
    ("key", "meant"),
    [("angle: 5 deg", "sideslip or camber"), ("repeat: 3", "repeats"), ("sidesilp: 5 deg", "sideslip")],
)
def test_a_key_is_recognised_by_its_spelling_or_the_name_of_its_quantity(key: str, meant: str) -> None:
    said = _unknown_of(SMALL.replace("    slip_velocity:", f"    {key}\n    slip_velocity:"))
    assert said == [f'unknown key "{key.partition(":")[0]}", did you mean {meant}?']


def test_a_key_of_another_section_is_reported_with_its_section() -> None:
    assert _unknown_of(f"sideslip: 5 deg\n{SMALL}") == ['unknown key "sideslip" here: it goes into grids']


def test_a_key_that_is_there_is_not_suggested_for_another() -> None:
    assert _unknown_of(SMALL.replace("    slip_velocity:", "    slip_speed: 1 m/s\n    slip_velocity:")) == [
        'unknown key "slip_speed", did you mean wheel_speed?'
    ]
