"""A misspelt key is one problem, not an unknown and a missing one; a number beyond every range says so."""

from __future__ import annotations

import pytest

from tester.base.source import InvalidSource
from tester.base.units import UnitError, parse
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.recipe.loader import load_recipe
from tests.tester.recipe.texts import SMALL


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
def test_a_number_beyond_every_range_says_so(text: str, how: str) -> None:
    with pytest.raises(UnitError, match=f"is too {how} "):
        parse(text, "N")
