"""Axes of a sweep on the command line."""

from __future__ import annotations

import pytest

from tester.run.sweep.grid import GridError, SweepAxis, axes_of, axis_of, overrides_of, points_of


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("sim.noise=0,1,2", SweepAxis("sim.noise", ("0", "1", "2"))),
        (" sim.noise = 0 , 1", SweepAxis("sim.noise", ("0", "1"))),
        ("sim.friction_model=paper", SweepAxis("sim.friction_model", ("paper",))),
        ("a.b=[1, 2],{c: 3, d: 4}", SweepAxis("a.b", ("[1, 2]", "{c: 3, d: 4}"))),
        ("name='one, two',three", SweepAxis("name", ("'one, two'", "three"))),
        ("a=b=c,d", SweepAxis("a", ("b=c", "d"))),
    ],
)
def test_values_stand_between_commas_outside_brackets_and_quotes(text: str, axis: SweepAxis) -> None:
    assert axis_of(text) == axis


@pytest.mark.parametrize("text", ["sim.noise", "=1", "sim.noise=", "sim.noise=0,,1", "sim.noise=1,1"])
def test_a_text_that_is_no_axis_is_named(text: str) -> None:
    with pytest.raises(GridError, match=f"--set {text}: "):
        axis_of(text)


def test_a_key_that_is_there_twice_is_refused() -> None:
    with pytest.raises(GridError, match="appears twice"):
        axes_of(["sim.noise=0", "sim.noise=1"])


def test_points_are_every_combination_and_the_last_axis_changes_fastest() -> None:
    assert points_of(axes_of(["a=1,2", "b=x,y"])) == [("1", "x"), ("1", "y"), ("2", "x"), ("2", "y")]


def test_without_axes_there_is_one_point() -> None:
    assert points_of([]) == [()]


def test_a_point_is_a_set_of_overrides() -> None:
    assert overrides_of(axes_of(["a=1,2", "b=x"]), ("2", "x")) == ("a=2", "b=x")
