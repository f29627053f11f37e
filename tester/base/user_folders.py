"""The user's own folders for settings and for files that can be made again, as each system places them."""

from __future__ import annotations

import os
import sys
from pathlib import Path

NAME = "friction-tester"
CACHE = "TESTER_CACHE_DIR"
"""Environment variable: the folder of files that can be made again at any time."""
CONFIG = "TESTER_CONFIG_DIR"
"""Environment variable: the folder of the user's settings."""


def cache_folder() -> Path:
    """Return the folder of cached files, which need not exist.

    ``TESTER_CACHE_DIR``, else ``friction-tester`` in the user's caches: ``XDG_CACHE_HOME`` or ``~/.cache``, on macOS
    ``~/Library/Caches``, on Windows ``LOCALAPPDATA``.
    """
    return _folder(CACHE, ("LOCALAPPDATA", "AppData/Local"), "Library/Caches", ("XDG_CACHE_HOME", ".cache"))


def config_folder() -> Path:
    """Return the folder of the user's settings, which need not exist.

    ``TESTER_CONFIG_DIR``, else ``friction-tester`` in ``XDG_CONFIG_HOME`` or ``~/.config``, on macOS in
    ``~/Library/Application Support``, on Windows in ``APPDATA``.
    """
    return _folder(
        CONFIG, ("APPDATA", "AppData/Roaming"), "Library/Application Support", ("XDG_CONFIG_HOME", ".config")
    )


def _folder(chosen: str, windows: tuple[str, str], mac: str, other: tuple[str, str]) -> Path:
    """Return the folder that a variable names, else the system's: by a variable of its own, else below the home."""
    if own := os.environ.get(chosen):
        return Path(own)
    variable, below = windows if sys.platform == "win32" else ("", mac) if sys.platform == "darwin" else other
    base = os.environ.get(variable) if variable else None
    return (Path(base) if base else Path.home() / below) / NAME
