"""Conditions that a wheel would not outlast: grinding plus one condition exceed ``wheel.replace_after``."""

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
"""Axes with the greatest wear at their greatest value: the load, and the angles."""


def wear_problems(recipe: WheelRecipe, tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return the conditions that each wear a wheel beyond ``wheel.replace_after``, grinding included."""
    costs = WheelEstimator(rig).costs
    allowed = recipe.wheel.replace_after
    layer = rig.observer.wheel.rubber_layer
    at: Location = ("wheel", "replace_after")
    if allowed > 2.0 * layer:
        message = f"replace_after: {show(allowed, 'mm')} is more rubber than there is, {show(2 * layer, 'mm')}"
        return [tree.problem(at, message)]
    ground = 0.0
    if recipe.pre_grind is not None:
        grind = recipe.pre_grind
        ground = costs.ground_mm(grind.load, abs(grind.wheel_speed - grind.belt_speed) * grind.duration)
    problems: list[Problem] = []
    compounds = [specimen.compound for specimen in recipe.specimens]
    for index, grid in enumerate(recipe.grids):
        compound, worst = max(
            ((compound, _worst_loss_mm(recipe, grid, compound, costs)) for compound in compounds),
            key=lambda loss: loss[1],
        )
        if ground + worst > allowed:
            wear = f"{worst:.2f} mm of diameter with {shown(compound)}, after {ground:.2f} mm of pre-grinding"
            message = f"a condition of this grid wears {wear}: more than replace_after, {show(allowed, 'mm')}"
            problems.append(tree.problem(("grids", index), message))
    return problems + _watched(recipe, tree, rig)


def _watched(recipe: WheelRecipe, tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return a problem if all references together wear out their reserved wheel."""
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
    """Return the greatest predicted wear of a grid's conditions: at its highest load and widest angles."""
    if recipe.measure is None:
        return 0.0
    settings = wheel_settings(recipe.measure, grid)
    worst = {
        name: (max(numbers(values), key=abs),) if name in _WORST_AT_MOST else values
        for name, values in axis_values(recipe.measure, grid).items()
    }
    return max(costs.of(Setpoint(compound, values, grid.axes), settings).loss_mm for values in product(*worst.values()))
