"""``manifest.json``: size and SHA-256 of every file in a run's folder, to reveal changes."""

from __future__ import annotations

import json
from hashlib import file_digest
from pathlib import Path

MANIFEST = "manifest.json"

_LEFT_OUT = (".part", "-wal", "-shm", "-journal", ".lock")
"""Suffixes of temporary files."""


def manifest_of(folder: Path) -> dict[str, dict[str, str | int]]:
    """Return size in bytes and SHA-256 (hexadecimal) of the folder's files by their path in it, sorted."""
    files: dict[str, dict[str, str | int]] = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name != MANIFEST and not name.endswith(_LEFT_OUT):
            with path.open("rb") as file:
                files[name] = {"bytes": path.stat().st_size, "sha256": file_digest(file, "sha256").hexdigest()}
    return files


def manifest_text(folder: Path, record_head: str) -> str:
    """Return the manifest of a folder as JSON; ``record_head``: of its record's chain."""
    whole = {"version": 1, "record_head": record_head, "files": manifest_of(folder)}
    return json.dumps(whole, indent=1, ensure_ascii=False) + "\n"


def manifest_head(folder: Path) -> str:
    """Return the head of the record's chain in the folder's manifest; raises OSError, ValueError, KeyError."""
    return str(json.loads((folder / MANIFEST).read_text("utf-8"))["record_head"])


def manifest_problems(folder: Path) -> list[str]:
    """Return the differences from the folder's manifest, a line each; raises OSError, ValueError if it has none."""
    recorded: dict[str, dict[str, str | int]] = json.loads((folder / MANIFEST).read_text("utf-8"))["files"]
    present = manifest_of(folder)
    missing = [f"{name}: missing" for name in recorded if name not in present]
    changed = [f"{name}: changed" for name in recorded if name in present and present[name] != recorded[name]]
    return missing + changed + [f"{name}: not in the manifest" for name in present if name not in recorded]
