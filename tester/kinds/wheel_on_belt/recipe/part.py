"""This machine's part for recipes (``tester.inputs.recipe.recipe_part``)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from math import cos, hypot, radians, sin
from typing import ClassVar, Final

from sim.physics.friction import MODEL_NAMES
from tester.analysis.terms import Term
from tester.base.axes import Axes, numbers
from tester.base.source import Location, Problem, Tree
from tester.base.units import show
from tester.inputs.recipe.grid_settings import values_of
from tester.inputs.recipe.plan import Plan, Stand
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe
from tester.inputs.recipe.semantics import listed
from tester.inputs.recipe.surface_turns import surface_problems
from tester.inputs.recipe.time_estimate import Estimator
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.budget import terms_of
from tester.kinds.wheel_on_belt.image.axes import AXES, KIND, LEAST_SPEED_M_S, POSITIONED
from tester.kinds.wheel_on_belt.recipe.describe import WheelDescription
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.limits import limit_problems
from tester.kinds.wheel_on_belt.recipe.measured_wheels import diameter_doubts, diameter_problems
from tester.kinds.wheel_on_belt.recipe.plan_steps import WheelPlan
from tester.kinds.wheel_on_belt.recipe.references import reference_problems
from tester.kinds.wheel_on_belt.recipe.remaining import remaining
from tester.kinds.wheel_on_belt.recipe.schema import (
    WheelGrid,
    WheelMeasure,
    WheelRecipe,
    WheelSettings,
    for_wheels,
    wheel_settings,
)
from tester.kinds.wheel_on_belt.recipe.twin_law import twin_doubts
from tester.kinds.wheel_on_belt.recipe.wear_checks import wear_problems
from tester.kinds.wheel_on_belt.rig import RigConfig

KEY = "both_directions"


def reversal_problems(measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
    """Yield why a grid's conditions cannot be measured in both directions, if the grid requests it."""
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
            yield from _belt_stands(wheel, slip, place, tree, turned=True)
    for axis in POSITIONED:
        for index, angle in enumerate(numbers(listed(grid, axis))):
            if angle != 0.0:
                why = _yawed(slips, speeds, angle) if axis.name == "sideslip" else _TILTED
                message = f"{axis.name}: {show(angle, axis.recipe_unit)} with {KEY} is not one condition: {why}"
                place = (*at, axis.name, index)
                yield tree.problem(place, f"{message} (expected 0 {axis.recipe_unit}, or {KEY}: false in this grid)")


def _belt_stands(
    wheel: float, slip: float, place: Location, tree: Tree, *, turned: bool = False
) -> Iterator[Problem]:
    """Yield a problem if the belt would stand or run backwards at a slip, or at its reverse (``turned``)."""
    belt = round(wheel + slip if turned else wheel - slip, 9)
    if belt < LEAST_SPEED_M_S:
        asked = f"slip_velocity: {show(slip, 'm/s')}" + (f", reversed by {KEY}," if turned else "")
        message = f"{asked} leaves {show(belt, 'm/s')} for the belt at a wheel speed of {show(wheel, 'm/s')}"
        expected = f"(expected at least {LEAST_SPEED_M_S} m/s: a standing belt is never loaded)"
        yield tree.problem(place, f"{message} {expected}")


_TILTED = "a tilted tread carries more on one side, which slides faster one way and slower the other way"


def _yawed(slips: list[tuple[int, float]], speeds: list[float], angle: float) -> str:
    for (_, slip), wheel in product(slips, speeds):
        ways = (hypot(wheel - belt * cos(radians(angle)), belt * sin(radians(angle)))
                for belt in (wheel - slip, wheel + slip))  # fmt: skip
        straight, turned = (show(round(way, 3), "m/s") for way in ways)
        return f"it slides at {straight} one way and at {turned} the other way"
    return "it slides at another speed the other way"


class WheelPart(WheelDescription):
    """Recipes for a rubber wheel on a belt."""

    kind: ClassVar[str] = KIND
    axes: ClassVar[Axes] = AXES
    recipe: ClassVar[type[Recipe]] = WheelRecipe
    measure: ClassVar[type[MeasureModel]] = WheelMeasure
    grid: ClassVar[type[GridModel]] = WheelGrid
    begins: ClassVar[str] = (
        "pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}\n"
        "rest: {at_least: 20 min, until: 25 degC, within: 2 degC}\n"
        "measure: {wheel_speed: 0.8 m/s, repeats: REPEATS, window: 30 rev, temperature_band: 2 degC}"
    )
    """The start of a new recipe, as in the recipes of the paper's tables."""

    def settings(self, measure: MeasureModel, grid: GridModel) -> WheelSettings:
        """Return the settings of a grid's conditions."""
        return wheel_settings(measure, grid)

    def whole(self, recipe: Recipe | None, tree: Tree) -> Iterator[Problem]:
        """Yield a problem for an empty recipe (grinding a wheel alone is not empty), and faults of the reference."""
        top = tree.data if isinstance(tree.data, dict) else {}
        if not top.get("grids") and top.get("pre_grind") is None:
            yield tree.problem((), "there is nothing to do: neither grids nor pre_grind")
        yield from surface_problems(tree)
        if recipe is not None:
            yield from reference_problems(for_wheels(recipe), tree, self.sense)

    def sense(self, measure: MeasureModel, grid: GridModel, at: Location, tree: Tree) -> Iterator[Problem]:
        """Yield each slip at which the belt would stand or run backwards, and slips that cannot be reversed."""
        yield from reversal_problems(measure, grid, at, tree)
        slips, speeds = grid.axes["slip_velocity"], grid.axes["wheel_speed"]
        for index, slip in enumerate(numbers(listed(grid, slips))):
            for wheel in numbers(values_of(speeds, measure, grid)):
                yield from _belt_stands(wheel, slip, (*at, "slip_velocity", index), tree)

    def limits(self, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield values beyond the rig's limits."""
        yield from limit_problems(tree, RigConfig.of(rig))

    def terms(self, rig: Rig) -> tuple[Term, ...]:
        """Return the possible errors of the measuring chain, the cell's calibration included."""
        known = RigConfig.of(rig).calibration
        return terms_of(known.cell_sensitivity, known.record)

    def rubs_as_described(self, rig: Rig) -> bool:
        """Return True on a machine; on a simulated rig, whether its law is the paper's."""
        return not rig.simulated or RigConfig.of(rig).sim.friction_model in MODEL_NAMES

    def outlasted(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield conditions that each wear a wheel beyond ``wheel.replace_after``, and measured wheels of another size.
        """
        yield from wear_problems(for_wheels(recipe), tree, RigConfig.of(rig))
        yield from diameter_problems(RigConfig.of(rig), recipe, tree)

    def doubts(self, recipe: Recipe, tree: Tree, rig: Rig) -> Iterator[Problem]:
        """Yield the compounds whose law on the simulated wheel is assumed, or has too little friction, and measured
        diameters beyond the uncertainty of the believed one.
        """
        yield from twin_doubts(RigConfig.of(rig), recipe, tree)
        yield from diameter_doubts(RigConfig.of(rig), recipe, tree)

    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> WheelEstimator:
        """Return the estimator of a rig."""
        return WheelEstimator(RigConfig.of(rig), repeatability=repeatability)

    def expand(self, recipe: Recipe, rig: Rig, estimator: Estimator | None = None) -> WheelPlan:
        """Return the plan of a valid recipe on a rig; its wear rate and geometry decide the wheel changes."""
        wheels = estimator if isinstance(estimator, WheelEstimator) else None
        return expand(for_wheels(recipe), RigConfig.of(rig), wheels)

    def remaining(self, plan: Plan, stand: Stand) -> WheelPlan:
        """Return the plan of the remaining work after an interruption."""
        return remaining(WheelPlan.of(plan), stand)


PART: Final = WheelPart()
