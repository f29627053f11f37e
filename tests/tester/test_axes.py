"""The axes of a condition: nothing that is off its default is left out, anywhere."""

from __future__ import annotations

import pytest

from tester.axes import AXES, Axis, ListWords, columns, condition_words, differing
from tester.recipe.plan import Setpoint

HELD = Setpoint("1#", 0.3, 200.0, 0.0, 0.0, 40.0, 0.8)
OFF = {"slip_velocity_m_s": -0.2, "load_n": 250.0, "sideslip_deg": 10.0, "camber_deg": 5.0, "temperature_c": 55.0,
       "wheel_speed_m_s": 1.0}  # fmt: skip


def test_the_paper_s_conditions_are_told_without_camber_and_wheel_speed() -> None:
    assert condition_words(HELD) == "1#, 300 mm/s, 200 N, 40 degC"


def test_every_axis_off_its_default_is_told() -> None:
    text = condition_words(HELD._replace(**OFF))
    assert text == "1#, -200 mm/s, 250 N, sideslip 10 deg, camber 5 deg, 55 degC, wheel 1 m/s"


@pytest.mark.parametrize("axis", AXES, ids=[axis.name for axis in AXES])
def test_conditions_that_differ_in_one_axis_read_differently(axis: Axis) -> None:
    other = HELD._replace(**{axis.field: OFF[axis.field]})
    assert condition_words(other) != condition_words(HELD)
    assert differing([HELD, other]) == (axis,) and axis in columns([HELD, other])
    words = ListWords([HELD, other])
    assert words.of(other) == axis.words(other) and words.of(HELD) == axis.words(HELD)


def test_a_float_s_last_digits_are_no_words() -> None:
    assert condition_words(HELD._replace(slip_velocity_m_s=0.1 + 0.2)) == condition_words(HELD)
    assert condition_words(HELD._replace(slip_velocity_m_s=-0.0)).startswith("1#, 0 mm/s")


def test_a_list_tells_of_each_what_differs_and_the_rest_once() -> None:
    words = ListWords([HELD, HELD._replace(camber_deg=5.0, compound="2#")])
    assert words.of(HELD) == "1#, camber 0 deg" and words.common == "300 mm/s, 200 N, 40 degC"


def test_the_only_condition_of_a_list_is_told_whole() -> None:
    assert ListWords([HELD]).of(HELD) == condition_words(HELD) and ListWords([HELD]).common == ""


def test_a_table_has_the_paper_s_columns_and_those_off_their_default() -> None:
    paper = ["slip_velocity", "load", "sideslip", "temperature"]
    assert [axis.name for axis in columns([HELD])] == paper
    assert [axis.name for axis in columns([HELD._replace(camber_deg=2.0)])] == [*paper[:3], "camber", paper[3]]
