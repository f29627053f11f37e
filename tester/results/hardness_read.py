"""The hardness that people read of mounted pieces, in words, beside what the compound's file states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from tester.base.source import InvalidSource
from tester.base.units import SHORE_A
from tester.inputs.recipe.hardness import BelievedHardness
from tester.results.run_results import RunResults


def hardness_lines(results: RunResults, compound: str = "") -> Iterator[str]:
    """Yield a line for each piece with a hardness: who read it and when, and why it is doubtful.

    ``compound``: of this compound only; "" of all.
    """
    read = [one for one in results.pieces if isfinite(one.hardness_shore_a) and compound in ("", one.compound)]
    believed = _believed(results) if read else dict[str, BelievedHardness]()
    for piece in read:
        line = f"{results.worn} {piece.piece} ({piece.compound}): hardness {piece.hardness_shore_a:g} {SHORE_A}"
        line += f" ({piece.hardness_by or 'unnamed'}, {piece.hardness_utc})"
        of_file = believed.get(piece.compound)
        if of_file is not None:
            doubt = of_file.doubt(piece.compound, piece.hardness_shore_a)
            line += f"; doubt: {doubt}" if doubt else f"; {of_file.shore_a:g} in its file"
        yield line


def _believed(results: RunResults) -> Mapping[str, BelievedHardness]:
    """Return the hardness in the compounds' files on record, by name."""
    from tester.inputs.materials.compound import compound_model

    found: dict[str, BelievedHardness] = {}
    for file in results.run.info.materials:
        if file.role != "compound" or file.text is None:
            continue
        try:
            model = compound_model(file.text, file.file)
        except InvalidSource:
            continue  # of a version with other keys
        if model.hardness is not None:
            found[file.name] = BelievedHardness(model.hardness, model.hardness_tolerance)
    return found
