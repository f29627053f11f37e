"""What the simulated rig's law of friction asks of a recipe: rubbers and a surface that it can be made of."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from sim.physics.laws import NO_SETTING
from sim.physics.materials import OutsideError
from tester.base.source import InvalidSource, Problem, Tree
from tester.inputs.materials.setting import law_setting
from tester.inputs.recipe.recipe_schema import Recipe
from tester.kinds.specimen_on_track.rig import TrackConfig


def law_problems(rig: TrackConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield every compound of which the law cannot be made on the recipe's surface."""
    sim = rig.sim
    surface = recipe.abrasive.name if recipe.abrasive is not None else ""
    setting = law_setting(surface, Path(tree.name)) if sim.of_materials else NO_SETTING
    told: set[str] = set()
    for number, specimen in enumerate(recipe.specimens):
        if specimen.compound in told:
            continue
        told.add(specimen.compound)
        try:
            sim.known_everywhere(specimen.compound, setting)
        except OutsideError as error:
            said = f"{error}; a simulated track slides from standstill on (expected moduli with beyond: hold)"
        except InvalidSource as error:
            yield from error.problems
            continue
        except ValueError as error:
            said = str(error)
        else:
            continue
        yield tree.problem(("specimens", number, "compound"), f"compound: sim.law {sim.law}: {said}")
