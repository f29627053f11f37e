"""The recipes to choose from: the shipped recipes, and the files in the working folder."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import recipes
from tester.base.trouble import in_words

MOST_BYTES = 262_144
"""Greatest length of a recipe that is read, bytes (safety.md): the service accepts no longer one."""
OWN = "recipes"
"""Folder of a user's recipes, in the working folder."""


@dataclass(frozen=True, slots=True)
class RecipeProblem:
    """One problem of a recipe: line and column from 1, and a message that states the source of the limit."""

    line: int
    column: int
    message: str


Checked: TypeAlias = "tuple[RecipeProblem, ...] | None"
"""The problems of a recipe; None until it has been checked."""


@dataclass(frozen=True, slots=True)
class ListedRecipe:
    """A recipe to choose from. ``text``: its content; ``unreadable``: why it could not be read."""

    name: str
    path: Path
    shipped: bool
    text: str
    unreadable: str = ""

    @property
    def reference(self) -> str:
        """Return the service's name of the recipe."""
        return self.name if self.shipped else str(self.path)

    @property
    def sent(self) -> str:
        """Return the text to send to the service, which may not have access to our files but has the shipped
        recipes.
        """
        return "" if self.shipped else self.text


def shelf(folder: Path) -> list[ListedRecipe]:
    """Return the shipped recipes, then those in ``folder/recipes`` and ``folder``, each by name."""
    listed = [_read(name, recipes.find(name), shipped=True) for name in recipes.names()]
    shipped = recipes.FOLDER.resolve()
    for where in (folder / OWN, folder):
        if where.is_dir() and where.resolve() != shipped:
            files = sorted(where.glob("*.yaml"))
            listed += [r for r in (_read(file.stem, file, shipped=False) for file in files) if _looks_like_one(r)]
    return listed


def read_again(recipe: ListedRecipe) -> ListedRecipe:
    """Return the recipe with the present content of its file."""
    return _read(recipe.name, recipe.path, shipped=recipe.shipped)


def own_copy(recipe: ListedRecipe, folder: Path) -> ListedRecipe:
    """Copy a shipped recipe to a free name in the user's folder, and return the copy; raises OSError."""
    where = folder / OWN
    where.mkdir(exist_ok=True)
    path, count = where / f"my-{recipe.name}.yaml", 1
    while path.exists():
        count += 1
        path = where / f"my-{recipe.name}-{count}.yaml"
    shutil.copyfile(recipe.path, path)
    return _read(path.stem, path, shipped=False)


def _looks_like_one(recipe: ListedRecipe) -> bool:
    """Return whether a file looks like a recipe, finished or not: a folder may contain other YAML files."""
    return bool(recipe.unreadable) or "recipe:" in recipe.text


def _read(name: str, path: Path, *, shipped: bool) -> ListedRecipe:
    try:
        if path.stat().st_size > MOST_BYTES:
            return ListedRecipe(name, path, shipped, "", f"longer than {MOST_BYTES} bytes")
        return ListedRecipe(name, path, shipped, path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        return ListedRecipe(name, path, shipped, "", in_words(error))
