"""What a person measured of a specimen, held against what is believed of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from sim.physics.materials import UnknownMaterialError
from tester.base.source import InvalidSource, Problem, Tree
from tester.inputs.recipe.hardness import BelievedHardness
from tester.inputs.recipe.recipe_schema import Recipe


def hardness_doubts(recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a doubt for each measured hardness that its compound's file does not confirm (``BelievedHardness``)."""
    listed = {
        number: dict(specimen.measured.listed)["hardness"]
        for number, specimen in enumerate(recipe.specimens)
        if specimen.measured is not None and "hardness" in dict(specimen.measured.listed)
    }
    believed = believed_hardness((recipe.specimens[number].compound for number in listed), Path(tree.name))
    for number, values in listed.items():
        compound = recipe.specimens[number].compound
        for place, value in enumerate(values) if compound in believed else ():
            doubt = believed[compound].doubt(compound, value)
            at = ("specimens", number, "measured", "hardness")
            if doubt:
                yield tree.problem((*at, place) if len(values) > 1 else at, f"hardness: {doubt}")


def believed_hardness(compounds: Iterable[str], recipe: Path) -> dict[str, BelievedHardness]:
    """Return the hardness that the compounds' files beside a recipe state, by name; none for one without it."""
    found: dict[str, BelievedHardness] = {}
    for compound in dict.fromkeys(compounds):
        from tester.inputs.materials.library import Library

        try:
            model = Library.beside(recipe).compound(compound).model
        except (UnknownMaterialError, InvalidSource):
            continue  # no file, or one whose problems are reported where it is used
        if model.hardness is not None:
            found[compound] = BelievedHardness(model.hardness, model.hardness_tolerance)
    return found
