"""The axes of a condition: every value off its default appears everywhere."""

from __future__ import annotations

import json
import pickle

import pytest

from tester.base.axes import Axes, Axis, AxisValue, ListWords, axes_from, condition_words
from tester.kinds.wheel_on_belt.image.axes import AXES, held_by

HELD = AXES.setpoint("1#", slip_velocity=0.3, load=200.0, temperature=40.0)
OFF: dict[str, AxisValue] = {
    "slip_velocity": -0.2, "load": 250.0, "sideslip": 10.0, "camber": 5.0, "temperature": 55.0, "wheel_speed": 1.0,
    "surface": "corundum 80",
}  # fmt: skip


def test_the_paper_s_conditions_are_described_without_camber_and_wheel_speed() -> None:
    assert condition_words(HELD) == "1#, 300 mm/s, 200 N, 40 degC"


def test_every_axis_off_its_default_is_described() -> None:
    text = condition_words(HELD.but(**OFF))
    assert text == "1#, -200 mm/s, 250 N, sideslip 10 deg, camber 5 deg, 55 degC, wheel 1 m/s, on corundum 80"


@pytest.mark.parametrize("axis", AXES.table, ids=[axis.name for axis in AXES])
def test_conditions_that_differ_in_one_axis_read_differently(axis: Axis) -> None:
    other = HELD.but(**{axis.name: OFF[axis.name]})
    assert condition_words(other) != condition_words(HELD)
    assert AXES.differing([HELD, other]) == (axis,) and axis in AXES.columns([HELD, other])
    words = ListWords([HELD, other])
    assert words.of(other) == axis.words(other) and words.of(HELD) == axis.words(HELD)


def test_a_float_s_last_digits_are_no_words() -> None:
    assert condition_words(HELD.but(slip_velocity=0.1 + 0.2)) == condition_words(HELD)
    assert condition_words(HELD.but(slip_velocity=-0.0)).startswith("1#, 0 mm/s")


def test_a_list_describes_the_differences_of_each_and_the_rest_once() -> None:
    words = ListWords([HELD, HELD.but("2#", camber=5.0)])
    assert words.of(HELD) == "1#, camber 0 deg" and words.common == "300 mm/s, 200 N, 40 degC"


def test_the_only_condition_of_a_list_is_described_in_full() -> None:
    assert ListWords([HELD]).of(HELD) == condition_words(HELD) and ListWords([HELD]).common == ""


def test_a_table_has_the_paper_s_columns_and_those_off_their_default() -> None:
    paper = ["slip_velocity", "load", "sideslip", "temperature"]
    assert [axis.name for axis in AXES.columns([HELD])] == paper
    assert [axis.name for axis in AXES.columns([HELD.but(camber=2.0)])] == [*paper[:3], "camber", paper[3]]


TRACK = Axes(
    (
        Axis("track_speed", "m/s", "track_speed_m_s", "mm/s", 1e3, "track_speed_mm_s", "Track Speed /mm·s⁻¹", "mm/s",
             "", None, True),
        Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "",
             None, True),
        Axis("interface", "1", "interface", "", 1.0, "interface", "Interface", "Interface", "", "dry", True,
             choices=("dry", "wet")),
    ),
    blocks="temperature",
)  # fmt: skip


def test_an_axis_may_have_choices_instead_of_numbers() -> None:
    dry = TRACK.setpoint("1#", track_speed=0.001, temperature=20.0)
    wet = dry.but(interface="wet")
    assert condition_words(dry) == "1#, 1 mm/s, 20 degC" and condition_words(wet) == "1#, 1 mm/s, 20 degC, wet"
    assert TRACK.differing([dry, wet]) == (TRACK["interface"],) and ListWords([dry, wet]).of(wet) == "wet"
    with pytest.raises(TypeError, match="interface is wet, not a number"):
        wet.number("interface")


@pytest.mark.parametrize("axes", [AXES, TRACK], ids=["wheel", "track"])
def test_a_table_read_from_plain_data_uses_the_same_words(axes: Axes) -> None:
    back = axes_from(json.loads(json.dumps(axes.as_data())))
    assert back == axes and back.as_data() == axes.as_data() and back.nested == axes.nested


def test_setpoints_are_equal_after_a_way_through_pickle() -> None:
    back = pickle.loads(pickle.dumps(HELD))  # noqa: S301 - our own bytes
    assert back == HELD and hash(back) == hash(HELD)


def test_values_are_looked_up_by_name_whatever_their_order() -> None:
    held = HELD.but(**OFF)
    assert {axis.name: held.value(axis.name) for axis in AXES} == OFF
    assert AXES.numbers_of("temperature", "load")(held.values) == (55.0, 250.0)
    seen = held_by(held)
    assert (seen.positions["camber"], seen.temperature_c, seen.wheel_speed_m_s) == (5.0, 55.0, 1.0)


def test_an_axis_that_is_none_is_named() -> None:
    with pytest.raises(KeyError, match="no axis chamber"):
        AXES.setpoint("1#", chamber=1.0)
    with pytest.raises(ValueError, match="each once"):
        Axes([*AXES, AXES["load"]], "temperature")
