"""What the kind of a rig brings: the one place, beside the commands, that looks a kind up."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from tester.base.source import InvalidSource, Problem, read_tree
from tester.inputs.rig import Rig
from tester.kinds import PACKAGED, find

if TYPE_CHECKING:
    from tester.inputs.recipe.loader import LoadedRecipe
    from tester.inputs.recipe.part import RecipePart
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind

Part = TypeVar("Part")


def to_be_run(rig: Rig) -> Rig:
    """Return the rig; raises InvalidSource, as all here, where its kind brings nothing to run a recipe with."""
    _brought(rig, "runs", find(rig.kind).runs)
    return rig


def run_parts(rig: Rig) -> KindRun:
    """Return how runs on a rig are built, and what goes with them."""
    return _brought(rig, "runs", find(rig.kind).runs)()


def served_kind(rig: Rig) -> ServedKind:
    """Return what the kind of a rig answers a service."""
    return _brought(rig, "service", find(rig.kind).served)()


def recipe_part(rig: Rig) -> RecipePart:
    """Return what the kind of a rig says about recipes."""
    return _brought(rig, "recipes", find(rig.kind).recipe)()


def checked_recipe(source: Path | str, rig: Rig, name: str | None = None) -> LoadedRecipe:
    """Return a recipe that a rig can carry out (tester.inputs.recipe.check.load_checked).

    Raises InvalidSource with every problem; of a recipe that does not name its kind, and is plainly written for a
    packaged kind other than the rig's, with that alone.
    """
    from tester.inputs.recipe.check import load_checked

    try:
        return load_checked(source, rig, recipe_part(rig), name)
    except InvalidSource as error:
        other = _kind_written_for(source, rig, len(error.problems))
        if not other:
            raise
        first = error.problems[0]
        there = next(iter(find(other).rigs))
        meant = f"the keys are of a recipe for a rig of kind {other} (such as --rig {there})"
        said = f'{meant}, rig "{rig.name}" is of kind {rig.kind}'
        raise InvalidSource([Problem(first.file, first.line, first.column, said)]) from error


def _kind_written_for(source: Path | str, rig: Rig, problems: int) -> str:
    """Return the packaged kind in whose schema a recipe has less than half as many problems, "" where none is so."""
    from tester.inputs.recipe.loader import validated

    try:
        tree, _ = read_tree(source)
    except InvalidSource:
        return ""
    if not isinstance(tree.data, dict) or "kind" in tree.data:
        return ""
    for kind in PACKAGED:
        part = find(kind).recipe if kind != rig.kind else None
        if part is not None and 2 * len(validated(tree, part())[1]) < problems:
            return kind
    return ""


def _brought(rig: Rig, what: str, part: Callable[[], Part] | None) -> Callable[[], Part]:
    if part is None:
        said = f"kind: no recipe can be run on a rig of the kind {rig.kind}, for the kind brings no {what}"
        raise InvalidSource([Problem(f"rig {rig.name}", 1, 1, said)])
    return part
