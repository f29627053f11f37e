"""A recipe against a rig: every problem at once, of form, of sense, of the machine's limits and of wear."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from tester.recipe.cost import ConditionCosts
from tester.recipe.estimate import Estimator
from tester.recipe.limits import limit_problems
from tester.recipe.loader import LoadedRecipe, validated
from tester.recipe.plan import Setpoint
from tester.recipe.schema import GridModel, Recipe
from tester.recipe.semantics import axis_values
from tester.recipe.settings import settings_of
from tester.source import InvalidSource, Location, Problem, Tree, read_tree
from tester.units import show, shown

if TYPE_CHECKING:
    from tester.rig import RigConfig


def check(source: Path | str, rig: RigConfig, name: str | None = None) -> list[Problem]:
    """Return every problem of a recipe file (Path) or text (str) on a rig; an empty list: it can be run."""
    try:
        load_checked(source, rig, name)
    except InvalidSource as error:
        return list(error.problems)
    return []


def load_checked(source: Path | str, rig: RigConfig, name: str | None = None) -> LoadedRecipe:
    """Read a recipe and hold it against a rig; raises InvalidSource with every problem."""
    tree, problems = read_tree(source, name)
    recipe, more = validated(tree)
    problems += more + limit_problems(tree, rig)
    if recipe is not None and not problems:
        problems += wear_problems(recipe, tree, rig)
    if recipe is None or problems:
        raise InvalidSource(problems)
    return LoadedRecipe(recipe, tree)


def wear_problems(recipe: Recipe, tree: Tree, rig: RigConfig) -> list[Problem]:
    """Return what would wear a wheel beyond ``wheel.replace_after`` in one go: grinding it and one condition."""
    costs = Estimator(rig).costs
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
    return problems


def _worst_loss_mm(recipe: Recipe, grid: GridModel, compound: str, costs: ConditionCosts) -> float:
    """Return the greatest predicted wear of a grid's conditions, which is at its highest load and widest angles."""
    if recipe.measure is None:
        return 0.0
    slips, loads, sideslips, cambers, speeds, temperatures = axis_values(recipe.measure, grid)
    settings = settings_of(recipe.measure, grid)
    angles = max(sideslips, key=abs), max(cambers, key=abs)
    return max(
        costs.of(Setpoint(compound, slip, max(loads), *angles, temperature, speed), settings).loss_mm
        for slip, speed, temperature in product(slips, speeds, temperatures)
    )
