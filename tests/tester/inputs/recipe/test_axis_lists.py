"""Ranges of an axis: both ends, and values between them in equal ratios or steps."""

from __future__ import annotations

import json
import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tester.base.source import InvalidSource
from tester.base.units import parse
from tester.inputs.recipe.axis_lists import MAX_PER_DECADE, readable, spaced_model
from tester.inputs.recipe.loader import check
from tester.kinds.wheel_on_belt.recipe.part import PART
from tests.tester.inputs.recipe.texts import load_recipe, recipe, rig, with_line


def spread(unit: str, **keys: object) -> list[float]:
    named = {("from" if key == "first" else key): value for key, value in keys.items()}
    return spaced_model(unit).model_validate(named).values()


def test_values_in_equal_ratios_have_four_digits() -> None:
    assert spread("m/s", first="1 mm/s", to="1 m/s", per_decade=5) == [
        0.001, 0.001585, 0.002512, 0.003981, 0.00631, 0.01, 0.01585, 0.02512, 0.03981, 0.0631,
        0.1, 0.1585, 0.2512, 0.3981, 0.631, 1.0,
    ]  # fmt: skip


def test_both_ends_are_measured_where_they_are_no_whole_number_of_ratios_apart() -> None:
    values = spread("N", first="15 N", to="200 N", per_decade=3)
    assert (values[0], values[-1], len(values)) == (15.0, 200.0, 5)
    ratios = [after / before for before, after in pairwise(values)]
    assert max(ratios) / min(ratios) < 1.001 and max(ratios) < 10.0 ** (1.0 / 3.0)


def test_values_in_equal_steps_are_exact() -> None:
    assert spread("degC", first="25 degC", to="85 degC", step="10 K") == [25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 85.0]
    assert spread("deg", first="-0.3 deg", to="0.3 deg", step="0.1 deg") == [-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3]


@given(
    first=st.floats(1e-6, 1e3).map(lambda value: float(f"{value:.4g}")),
    decades=st.floats(0.01, 9.0),
    per_decade=st.integers(1, MAX_PER_DECADE),
)
def test_values_ascend_and_no_two_are_further_apart_than_asked(first: float, decades: float, per_decade: int) -> None:
    last = float(f"{first * 10.0**decades:.6g}")
    values = spread("m/s", first=f"{first!r} m/s", to=f"{last!r} m/s", per_decade=per_decade)
    assert (values[0], values[-1]) == (first, last)
    widest = 10.0 ** (1.0 / per_decade) * 1.0011
    assert all(before < after <= before * widest for before, after in pairwise(values))
    assert len(values) <= math.ceil(per_decade * math.log10(last / first) + 1e-9) + 1


@given(begin=st.integers(-900, 900), step=st.integers(1, 99), count=st.integers(1, 50))
def test_steps_are_the_written_ones(begin: int, step: int, count: int) -> None:
    ends = {"first": f"{begin / 10} deg", "to": f"{(begin + count * step) / 10} deg", "step": f"{step / 10} deg"}
    assert spread("deg", **ends) == [parse(f"{(begin + n * step) / 10} deg", "deg") for n in range(count + 1)]


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("{from: 1 kN, to: 10 N, per_decade: 5}", "9:11: load: from, 1000 N, is not less than to, 10 N"),
        ("{from: 10 N, to: 10 N, step: 5 N}", "9:11: load: from, 10 N, is not less than to, 10 N"),
        ("{from: 10 N, to: 100 N, per_decade: 0}", '9:47: per_decade: "0" is not accepted'),
        ("{from: 10 N, to: 100 N, per_decade: 101}", '9:47: per_decade: "101" is not accepted'),
        ("{from: -10 N, to: 100 N, per_decade: 5}", "9:18: from: -10 N is too small (expected more than 0 N)"),
        ("{from: 10 N, to: 100 N}", "9:11: load: expected per_decade or step beside from and to"),
        ("{from: 10 N, to: 100 N, per_decade: 5, step: 5 N}", "load: expected per_decade or step beside from and to"),
        ("{from: 10 N, to: 100 N, step: 0 N}", "9:41: step: 0 N is too small (expected more than 0 N)"),
        ("{from: 10 N, to: 100 N, step: 40 N}", "from 10 N (expected 90 N or 130 N)"),
        ("{from: 10 N, to: 300 N, step: 0.001 N}", "make too many values (expected less than 250000"),
        ("{from: 10 N, per_decade: 5}", "9:5: to is missing (expected a force"),
        ("{from: 10 N, to: 100 N, per_decad: 5}", 'unknown key "per_decad", did you mean per_decade?'),
        ("{from: 10, to: 100 N, step: 5 N}", "9:18: from: 10 has no unit"),
    ],
)
def test_a_range_that_is_none_is_reported_at_its_place(written: str, said: str) -> None:
    with pytest.raises(InvalidSource) as raised:
        load_recipe(with_line("load: [100 N, 200 N]", f"load: {written}"), PART, "r.yaml")
    assert any(said in str(problem) for problem in raised.value.problems), raised.value.problems


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("300 mm/s", "{from: -1 mm/s, to: 100 mm/s, per_decade: 5}", "from is -0.001 m/s (expected more than 0)"),
        ("[40 degC, 25 degC]", "{from: 30 degC, to: 40 degC, per_decade: 5}", "degC has no ratios (expected step"),
    ],
)
def test_ratios_need_a_quantity_that_has_them(old: str, new: str, said: str) -> None:
    with pytest.raises(InvalidSource) as raised:
        load_recipe(with_line(old, new), PART, "r.yaml")
    assert any(said in str(problem) for problem in raised.value.problems), raised.value.problems


def test_a_range_is_measured_and_stored_as_its_values() -> None:
    found = recipe(with_line("load: [100 N, 200 N]", "load: {from: 100 N, to: 200 N, step: 50 N}"))
    assert found.grids[0].model_dump()["load"] == [100.0, 150.0, 200.0]
    assert json.loads(found.model_dump_json())["grids"][0]["load"] == ["100 N", "150 N", "200 N"]
    assert found == recipe(with_line("load: [100 N, 200 N]", "load: [100 N, 150 N, 200 N]"))


def test_a_value_of_a_range_beyond_a_limit_is_reported_at_the_range() -> None:
    text = with_line("load: [100 N, 200 N]", "load: {from: 100 N, to: 600 N, step: 250 N}")
    problems = [str(problem) for problem in check(text, rig(), PART, "r.yaml")]
    assert any(one.startswith("r.yaml:9:11: load: 600 N is more than the rig allows") for one in problems), problems


def test_ranges_with_too_many_conditions_are_refused_before_any_combination_is_tried() -> None:
    text = with_line("load: [100 N, 200 N]", "load: {from: 100 N, to: 200 N, step: 0.01 N}")
    text = text.replace("300 mm/s", "{from: 100 mm/s, to: 300 mm/s, step: 0.01 mm/s}")
    (problem,) = check(text, rig(), PART, "r.yaml")
    count = 10_001 * 20_001 * 2
    assert problem.message == f"{count} conditions are too many for one recipe (at most 250000)"


def test_unreadable_values_are_left_to_the_schema() -> None:
    assert list(readable(["1 N", "x"], ("a",), "N")) == [(1.0, ("a", 0))]
    assert list(readable({"from": "1 N", "to": "x", "step": "1 N"}, ("a",), "N")) == []
    assert list(readable({"from": "1 N", "to": "2 N", "step": "1 N"}, ("a",), "N")) == [(1.0, ("a",)), (2.0, ("a",))]
