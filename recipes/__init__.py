"""Recipes that come with the program, found by name from any folder."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

FOLDER = Path(__file__).parent
"""Where the packaged recipes and their JSON Schema (``recipe.schema.json``) are."""


class UnknownRecipe(FileNotFoundError):  # noqa: N818 - as FileNotFoundError is called for what happened
    """Neither a file nor the name of a packaged recipe; the message names those there are."""


def names() -> list[str]:
    """Return the names of the packaged recipes, sorted."""
    return sorted(path.stem for path in FOLDER.glob("*.yaml"))


def find(name_or_path: str | Path) -> Path:
    """Return the file of a recipe: that file where there is one, else the packaged recipe of that name.

    ``quickstart``, ``quickstart.yaml`` and ``recipes/quickstart.yaml`` all name the packaged one, from any
    folder. Raises UnknownRecipe.
    """
    path = Path(name_or_path)
    if path.is_file():
        return path
    if path.parent in (Path(), Path("recipes")) and path.suffix in ("", ".yaml") and path.stem in names():
        return FOLDER / f"{path.stem}.yaml"
    near = get_close_matches(path.stem, names(), 1)
    meant = f", did you mean {near[0]}?" if near else ""
    raise UnknownRecipe(f'no recipe "{name_or_path}"{meant} (no such file; packaged are {", ".join(names())})')
