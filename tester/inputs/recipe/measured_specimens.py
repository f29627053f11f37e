"""What a person measured of a specimen, held against what is believed of it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Final

from sim.physics.materials import UnknownMaterialError
from tester.base.source import InvalidSource, Problem, Tree
from tester.base.units import shown
from tester.inputs.recipe.recipe_schema import Recipe

HARDNESS_U: Final = 3.0
"""Expanded uncertainty of a hardness by hand, Shore A [A]: a pocket durometer and its operator differ by some 2."""


def hardness_doubts(recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a doubt for each measured hardness that its compound's file does not confirm within HARDNESS_U."""
    measured = [(number, one) for number, one in enumerate(recipe.specimens) if one.measured and one.measured.hardness]
    if not measured:
        return
    from tester.inputs.materials.library import Library

    library = Library.beside(Path(tree.name))
    for number, specimen in measured:
        try:
            believed = library.compound(specimen.compound).model.hardness
        except (UnknownMaterialError, InvalidSource):
            continue  # no file, or one whose problems are reported where it is used
        values = specimen.measured.hardness if specimen.measured is not None else None
        for place, value in enumerate(values or ()):
            if believed is not None and abs(value - believed) > HARDNESS_U:
                message = f"hardness: {value:g} Shore A is not that of {shown(specimen.compound)}: another compound, or"
                expected = f"(expected {believed:g} of its file, within {HARDNESS_U:g} [A])"
                at = ("specimens", number, "measured", "hardness")
                several = (*at, place) if len(values or ()) > 1 else at
                yield tree.problem(several, f"{message} an old one? {expected}")
