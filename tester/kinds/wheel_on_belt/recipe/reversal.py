"""Finds conditions that cannot be measured in both directions: the reversed slip is not the same condition."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from math import cos, hypot, radians, sin

from tester.base.axes import numbers
from tester.base.source import Location, Problem, Tree
from tester.base.units import show
from tester.inputs.recipe.grid_settings import values_of
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel
from tester.inputs.recipe.semantics import listed
from tester.kinds.wheel_on_belt.image.axes import LEAST_SPEED_M_S, POSITIONED
from tester.kinds.wheel_on_belt.recipe.schema import WheelGrid, WheelMeasure, wheel_settings

KEY = "both_directions"


def reversal_problems(measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
    """Yield why a grid's conditions cannot be measured in both directions, if that is asked for."""
    if not isinstance(measure, WheelMeasure) or not isinstance(grid, WheelGrid):
        return
    settings = wheel_settings(measure, grid)
    if not settings.both_directions:
        if grid.run_in_after_reversal or (measure.run_in_after_reversal and grid.both_directions is None):
            place = at if grid.run_in_after_reversal else ("measure",)
            message = "run_in_after_reversal: without both_directions nothing is reversed"
            yield tree.problem((*place, "run_in_after_reversal"), f"{message} (expected both_directions: true)")
        return
    speeds = list(numbers(values_of(grid.axes["wheel_speed"], measure, grid)))
    slips = list(enumerate(numbers(listed(grid, grid.axes["slip_velocity"]))))
    for index, slip in slips:
        place = (*at, "slip_velocity", index)
        if slip == 0.0:
            message = f"slip_velocity: {show(slip, 'm/s')} has no direction to reverse"
            yield tree.problem(place, f"{message} (expected another slip, or {KEY}: false in this grid)")
        for wheel in speeds:
            yield from _belt_stands(wheel, slip, place, tree)
    for axis in POSITIONED:
        for index, angle in enumerate(numbers(listed(grid, axis))):
            if angle != 0.0:
                why = _yawed(slips, speeds, angle) if axis.name == "sideslip" else _TILTED
                message = f"{axis.name}: {show(angle, axis.recipe_unit)} with {KEY} is not one condition: {why}"
                place = (*at, axis.name, index)
                yield tree.problem(place, f"{message} (expected 0 {axis.recipe_unit}, or {KEY}: false in this grid)")


def _belt_stands(wheel: float, slip: float, place: Location, tree: Tree) -> Iterator[Problem]:
    belt = round(wheel + slip, 9)
    if belt < LEAST_SPEED_M_S:
        message = f"slip_velocity: {show(slip, 'm/s')}, reversed by {KEY}, leaves {show(belt, 'm/s')} for the belt"
        expected = f"(expected at least {LEAST_SPEED_M_S} m/s: a standing belt is never loaded)"
        yield tree.problem(place, f"{message} at a wheel speed of {show(wheel, 'm/s')} {expected}")


_TILTED = "a tilted tread carries more on one side, which slides faster one way and slower the other way"


def _yawed(slips: list[tuple[int, float]], speeds: list[float], angle: float) -> str:
    for (_, slip), wheel in product(slips, speeds):
        one, other = (hypot(wheel - belt * cos(radians(angle)), belt * sin(radians(angle)))
                      for belt in (wheel - slip, wheel + slip))  # fmt: skip
        return f"it slides at {show(round(one, 3), 'm/s')} one way and at {show(round(other, 3), 'm/s')} the other way"
    return "it slides at another speed the other way"
