"""Input of friction laws based on materials: files of compounds and surfaces, and the folder of cached tables."""

from __future__ import annotations

from pathlib import Path

from sim.physics.laws import LawSetting
from tester.base.user_folders import cache_folder


def law_setting(surface: str, recipe: Path | None = None) -> LawSetting:
    """Return the setting on a surface of this name, with materials and laws beside a recipe first."""
    from tester.inputs.materials.library import Library  # pydantic is slow to load: only where a law needs it

    library = Library.beside(recipe)
    return LawSetting(library, surface, tables=cache_folder() / "laws", stated=library.stated_law)
