"""Recipe files: from text to a valid ``Recipe``, or to every problem with its position."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from tester.recipe.schema import Recipe
from tester.recipe.semantics import semantic_problems
from tester.source import InvalidSource, Problem, Tree, problems_from_validation, read_tree


@dataclass(frozen=True, slots=True)
class LoadedRecipe:
    """A recipe with the tree it came from: ``tree.text`` is its text, ``tree.position`` where something stands."""

    recipe: Recipe
    tree: Tree


def load_recipe(source: Path | str, name: str | None = None) -> LoadedRecipe:
    """Read a recipe file (Path) or text (str); raises InvalidSource with every problem.

    The recipe makes sense by itself; whether a rig can do it is ``tester.recipe.check``'s question.
    """
    tree, problems = read_tree(source, name)
    recipe, more = validated(tree)
    if recipe is None or problems or more:
        raise InvalidSource([*problems, *more])
    return LoadedRecipe(recipe, tree)


def validated(tree: Tree) -> tuple[Recipe | None, list[Problem]]:
    """Return the recipe of a tree (None where a value is not valid) and the problems found."""
    if not isinstance(tree.data, dict):
        return None, [tree.problem((), "a recipe is a list of keys: recipe, specimens, measure, grids and others")]
    try:
        recipe = Recipe.model_validate(tree.data)
    except ValidationError as error:
        return None, problems_from_validation(error, tree, Recipe) + semantic_problems(None, tree)
    return recipe, semantic_problems(recipe, tree)
