"""Recipe files: from text to a valid ``Recipe`` and its plan on a rig, or to every problem with its position."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from pydantic import ValidationError

from tester.analysis.pressure import LOAD
from tester.analysis.terms import PREFIX, Term
from tester.base.source import InvalidSource, Problem, Tree, read_tree
from tester.base.units import shown
from tester.base.validation import problems_of
from tester.inputs.recipe.measured_specimens import hardness_doubts
from tester.inputs.recipe.pressures import with_area, with_loads
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.recipe_schema import Recipe
from tester.inputs.recipe.semantics import semantic_problems
from tester.inputs.rig import Rig


@dataclass(frozen=True, slots=True)
class LoadedRecipe:
    """A recipe with its tree: ``tree.text`` is its text, ``tree.position`` the position of a key.

    ``doubts``: parts that a rig is not expected to complete, where the recipe was checked against one.
    """

    recipe: Recipe
    tree: Tree
    doubts: tuple[Problem, ...] = ()


def validated(tree: Tree, part: RecipePart) -> tuple[Recipe | None, list[Problem]]:
    """Return the recipe of a tree (None where a value is not valid) and the problems found."""
    if not isinstance(tree.data, dict):
        return None, [tree.problem((), "a recipe is a list of keys: recipe, specimens, measure, grids and others")]
    model = part.model()
    try:
        recipe = model.model_validate(tree.data)
    except ValidationError as error:
        return None, problems_of(error, tree, model) + semantic_problems(None, tree, part)
    return recipe, semantic_problems(recipe, tree, part)


def check(source: Path | str, rig: Rig, part: RecipePart, name: str | None = None) -> list[Problem]:
    """Return every problem of a recipe file (Path) or text (str) on a rig; an empty list: it can run."""
    try:
        load_checked(source, rig, part, name)
    except InvalidSource as error:
        return list(error.problems)
    return []


def load_checked(source: Path | str, rig: Rig, part: RecipePart, name: str | None = None) -> LoadedRecipe:
    """Read a recipe and check it against a rig; raises InvalidSource with every problem.

    ``part``: of the rig's kind.
    """
    tree, problems = read_tree(source, name)
    other = _other_kind(tree, rig)
    if other:
        raise InvalidSource(other)
    tree, of_pressures = with_loads(with_area(tree, rig))
    recipe, more = validated(tree, part)
    if of_pressures:  # then the load that is missing is the pressure's
        more = [one for one in more if not one.message.startswith(f"{LOAD} is missing")]
    problems += [*of_pressures, *more, *sorted(set(part.limits(tree, rig)))]
    if recipe is not None:
        problems += _settings(recipe, tree, part.terms(rig))
    if recipe is not None and not problems:
        problems += part.outlasted(recipe, tree, rig)
    if recipe is None or problems:
        raise InvalidSource(problems)
    return LoadedRecipe(recipe, tree, (*part.doubts(recipe, tree, rig), *hardness_doubts(recipe, tree)))


def _settings(recipe: Recipe, tree: Tree, terms: Sequence[Term]) -> Iterator[Problem]:
    """Yield replacements of a bound of the budget that match no setting of the rig's terms."""
    known = [f"{PREFIX}{name}" for term in terms for name in (term.setting, term.factor_setting) if name]
    for key in recipe.experiment:
        if key.startswith(PREFIX) and key not in known:
            yield tree.problem(("experiment", key), f"{key}: no term of this rig's budget has it{_meant(key, known)}")


def _meant(key: str, known: Sequence[str]) -> str:
    near = get_close_matches(key, known, 1)
    return f", did you mean {near[0]}?" if near else f" (expected one of {', '.join(known) or 'none'})"


def _other_kind(tree: Tree, rig: Rig) -> list[Problem]:
    """Return the problem of a recipe for another kind of rig: then nothing else in it can be checked against this
    one."""
    kind = tree.data.get("kind") if isinstance(tree.data, dict) else None
    if not isinstance(kind, str) or kind == rig.kind:
        return []
    message = f'kind: the recipe is for a rig of kind {shown(kind)}, rig "{rig.name}" is of kind {rig.kind}'
    return [tree.problem(("kind",), message)]
