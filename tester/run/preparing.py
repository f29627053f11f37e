"""A recipe on a rig, read, checked and planned: before anything is connected, and in a process of its own too."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from recipes import find
from tester.inputs.recipe.estimate import Estimate
from tester.inputs.recipe.loader import LoadedRecipe
from tester.run.folder import Work, work_of
from tester.run.kinds import checked_recipe, recipe_part
from tester.run.materials import UsedMaterials, used_materials
from tester.run.rigs import load_rig


@dataclass(frozen=True, slots=True)
class Prepared:
    """A recipe on a rig: what is to be done, and what it takes."""

    path: Path
    recipe: LoadedRecipe
    work: Work
    expected: Estimate
    materials: UsedMaterials


def prepared(recipe: str, rig_name: str, overrides: tuple[str, ...], accept_risk: str = "") -> Prepared:
    """Read and plan a recipe. Raises InvalidSource, UnknownRecipe."""
    rig = load_rig(rig_name, overrides, accept_risk)
    path = find(recipe)
    loaded = checked_recipe(path, rig)
    work = work_of(loaded.recipe, rig)
    materials = used_materials(loaded.recipe, path)
    return Prepared(path, loaded, work, recipe_part(rig).estimate(work.plan, rig), materials)
