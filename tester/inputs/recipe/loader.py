"""Recipe files: from text to a valid ``Recipe``, or to every problem with its position."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from tester.base.source import InvalidSource, Problem, Tree, problems_from_validation, read_tree
from tester.inputs.recipe.part import RecipePart
from tester.inputs.recipe.schema import Recipe, recipe_model
from tester.inputs.recipe.semantics import semantic_problems


@dataclass(frozen=True, slots=True)
class LoadedRecipe:
    """A recipe with the tree it came from: ``tree.text`` is its text, ``tree.position`` where something stands.

    ``doubts``: what a rig is not expected to bring to its end, where it was held against one.
    """

    recipe: Recipe
    tree: Tree
    doubts: tuple[Problem, ...] = ()


def load_recipe(source: Path | str, part: RecipePart, name: str | None = None) -> LoadedRecipe:
    """Read a recipe file (Path) or text (str); raises InvalidSource with every problem.

    ``part``: of the kind that it is for.

    The recipe makes sense by itself; whether a rig can do it is ``tester.inputs.recipe.check``'s question.
    """
    tree, problems = read_tree(source, name)
    recipe, more = validated(tree, part)
    if recipe is None or problems or more:
        raise InvalidSource([*problems, *more])
    return LoadedRecipe(recipe, tree)


def validated(tree: Tree, part: RecipePart) -> tuple[Recipe | None, list[Problem]]:
    """Return the recipe of a tree (None where a value is not valid) and the problems found."""
    if not isinstance(tree.data, dict):
        return None, [tree.problem((), "a recipe is a list of keys: recipe, specimens, measure, grids and others")]
    model = recipe_model(part)
    try:
        recipe = model.model_validate(tree.data)
    except ValidationError as error:
        return None, problems_from_validation(error, tree, model) + semantic_problems(None, tree, part)
    return recipe, semantic_problems(recipe, tree, part)
