"""A recipe against a rig: every problem at once, of form, of sense, of the machine's limits and of what it outlasts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from pathlib import Path

from tester.analysis.terms import PREFIX, Term
from tester.base.source import InvalidSource, Problem, Tree, read_tree
from tester.base.units import shown
from tester.inputs.recipe.loader import LoadedRecipe, validated
from tester.inputs.recipe.part import RecipePart
from tester.inputs.recipe.schema import Recipe
from tester.inputs.rig import Rig


def check(source: Path | str, rig: Rig, part: RecipePart, name: str | None = None) -> list[Problem]:
    """Return every problem of a recipe file (Path) or text (str) on a rig; an empty list: it can be run."""
    try:
        load_checked(source, rig, part, name)
    except InvalidSource as error:
        return list(error.problems)
    return []


def load_checked(source: Path | str, rig: Rig, part: RecipePart, name: str | None = None) -> LoadedRecipe:
    """Read a recipe and hold it against a rig; raises InvalidSource with every problem.

    ``part``: of the rig's kind.
    """
    tree, problems = read_tree(source, name)
    other = _other_kind(tree, rig)
    if other:
        raise InvalidSource(other)
    recipe, more = validated(tree, part)
    problems += [*more, *sorted(set(part.limits(tree, rig)))]
    if recipe is not None:
        problems += _settings(recipe, tree, part.terms(rig))
    if recipe is not None and not problems:
        problems += part.outlasted(recipe, tree, rig)
    if recipe is None or problems:
        raise InvalidSource(problems)
    return LoadedRecipe(recipe, tree, tuple(part.doubts(recipe, tree, rig)))


def _settings(recipe: Recipe, tree: Tree, terms: Sequence[Term]) -> Iterator[Problem]:
    """Yield what is to replace a bound of the budget, and is the setting of none of the rig's terms."""
    known = [f"{PREFIX}{name}" for one in terms for name in (one.setting, one.factor_setting) if name]
    for key in recipe.experiment:
        if key.startswith(PREFIX) and key not in known:
            yield tree.problem(("experiment", key), f"{key}: no term of this rig's budget has it{_meant(key, known)}")


def _meant(key: str, known: Sequence[str]) -> str:
    near = get_close_matches(key, known, 1)
    return f", did you mean {near[0]}?" if near else f" (expected one of {', '.join(known) or 'none'})"


def _other_kind(tree: Tree, rig: Rig) -> list[Problem]:
    """Return that a recipe is for a rig of another kind: then nothing else in it can be held against this one."""
    said = tree.data.get("kind") if isinstance(tree.data, dict) else None
    if not isinstance(said, str) or said == rig.kind:
        return []
    message = f'kind: the recipe is for a rig of kind {shown(said)}, rig "{rig.name}" is of kind {rig.kind}'
    return [tree.problem(("kind",), message)]
