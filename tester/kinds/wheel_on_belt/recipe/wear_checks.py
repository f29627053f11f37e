"""Finds conditions that a wheel would not outlast: grinding plus one condition exceed ``wheel.replace_after``."""

from __future__ import annotations

from itertools import product

from tester.base.axes import Setpoint, numbers
from tester.base.source import Location, Problem, Tree
from tester.base.units import show, shown
from tester.inputs.recipe.semantics import axis_values
from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.kinds.wheel_on_belt.recipe.cost import ConditionCosts
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.references import AT
from tester.kinds.wheel_on_belt.recipe.schema import WheelGrid, WheelRecipe, wheel_settings
from tester.kinds.wheel_on_belt.rig import RigConfig

_WORST_AT_MOST = ("load", *(axis.name for axis in AXES if axis.drive))
"""Axes of which the greatest value wears most: the load, and the angles."""


def wear_problems(recipe: WheelRecipe, tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return what would wear a wheel beyond ``wheel.replace_after`` in one go: grinding it and one condition."""
    costs = WheelEstimator(rig).costs
    allowed = recipe.wheel.replace_after
    layer = rig.observer.wheel.rubber_layer
    at: Location = ("wheel", "replace_after")
    if allowed > 2.0 * layer:
        message = f"replace_after: {show(allowed, 'mm')} is more rubber than there is, {show(2 * layer, 'mm')}"
        return [tree.problem(at, message)]
    ground = 0.0
    if recipe.pre_grind is not None:
        one = recipe.pre_grind
        ground = costs.ground_mm(one.load, abs(one.wheel_speed - one.belt_speed) * one.duration)
    problems: list[Problem] = []
    for index, grid in enumerate(recipe.grids):
        compound, worst = max(
            ((one.compound, _worst_loss_mm(recipe, grid, one.compound, costs)) for one in recipe.specimens),
            key=lambda entry: entry[1],
        )
        if ground + worst > allowed:
            wear = f"{worst:.2f} mm of diameter with {shown(compound)}, after {ground:.2f} mm of pre-grinding"
            message = f"a condition of this grid wears {wear}: more than replace_after, {show(allowed, 'mm')}"
            problems.append(tree.problem(("grids", index), message))
    return problems + _watched(recipe, tree, rig)


def _watched(recipe: WheelRecipe, tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return that all references together wear the wheel that is reserved for them out."""
    if recipe.reference is None or recipe.reference.wheel is None:
        return []
    plan, allowed = expand(recipe, rig), recipe.wheel.replace_after
    reserved = plan.wear[0]
    if reserved.loss_mm <= allowed:
        return []
    wear = f"{reserved.loss_mm:.2f} mm of diameter in {reserved.conditions} references"
    message = f"the reserved wheel wears {wear}: more than replace_after, {show(allowed, 'mm')}"
    expected = "(expected fewer references, repeats or revolutions, or a lower load)"
    return [tree.problem(AT, f"reference: {message} {expected}")]


def _worst_loss_mm(recipe: WheelRecipe, grid: WheelGrid, compound: str, costs: ConditionCosts) -> float:
    """Return the greatest predicted wear of a grid's conditions, which is at its highest load and widest angles."""
    if recipe.measure is None:
        return 0.0
    settings = wheel_settings(recipe.measure, grid)
    values = {
        name: (max(numbers(held), key=abs),) if name in _WORST_AT_MOST else held
        for name, held in axis_values(recipe.measure, grid).items()
    }
    return max(costs.of(Setpoint(compound, held, grid.axes), settings).loss_mm for held in product(*values.values()))
