"""Input of friction laws based on materials: files of compounds and surfaces, and the folder of cached tables."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from sim.physics.laws import LawSetting

VARIABLE = "TESTER_CACHE_DIR"
"""Environment variable: the folder of files that can be made again at any time."""


def law_setting(surface: str, recipe: Path | None = None) -> LawSetting:
    """Return the setting on a surface of this name, with materials and laws beside a recipe first."""
    from tester.inputs.materials.library import Library  # pydantic is slow to load: only where a law needs it

    library = Library.beside(recipe)
    return LawSetting(library, surface, tables=cache_folder() / "laws", stated=library.stated_law)


def cache_folder() -> Path:
    """Return the folder of cached files, which need not exist.

    ``TESTER_CACHE_DIR``, else ``friction-tester`` in the user's caches: ``XDG_CACHE_HOME`` or ``~/.cache``, on macOS
    ``~/Library/Caches``, on Windows ``LOCALAPPDATA``.
    """
    override = os.environ.get(VARIABLE)
    if override:
        return Path(override)
    if sys.platform == "win32":
        base, below = os.environ.get("LOCALAPPDATA"), "AppData/Local"
    elif sys.platform == "darwin":
        base, below = None, "Library/Caches"
    else:
        base, below = os.environ.get("XDG_CACHE_HOME"), ".cache"
    return (Path(base) if base else Path.home() / below) / "friction-tester"
