"""Files that are whole or not there, also after a power cut."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


def write_whole(path: Path, fill: Callable[[Path], None]) -> None:
    """Let ``fill`` write a file beside ``path``, then put it in its place, synced; raises OSError."""
    part = path.with_name(f"{path.name}.part")
    try:
        fill(part)
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    sync_folder(path.parent)


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8, line ends as they are, whole and synced; raises OSError."""

    def fill(part: Path) -> None:
        part.write_bytes(text.encode())

    write_whole(path, fill)


def sync_folder(folder: Path) -> None:
    """Make names in a folder last: files made, replaced or deleted there. Nothing where folders cannot be synced."""
    with suppress(OSError):  # Windows opens no folders
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
