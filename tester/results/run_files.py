"""The files of a run's folder: its tables, and ``manifest.json``, which reveals changes by size and SHA-256."""

from __future__ import annotations

import json
from collections.abc import Iterable
from hashlib import file_digest
from pathlib import Path

from tester.results.formats import FORMATS, Format, Record
from tester.results.run_results import results_of
from tester.results.table_rows import TableRow
from tester.store.disk import write_whole
from tester.store.run_reader import RunReader

MANIFEST = "manifest.json"

PYRAMID = ".pyramid"
"""Suffix of a file that only speeds up drawing: it is made anew from the record whenever it is missing."""
_LEFT_OUT = (".part", "-wal", "-shm", "-journal", ".lock", PYRAMID)
"""Suffixes of temporary files."""


def write_file(path: Path, chunks: Iterable[bytes | memoryview]) -> None:
    """Write ``chunks`` to ``path``, whole or not at all; raises OSError."""

    def fill(part: Path) -> None:
        with part.open("wb") as file:
            file.writelines(chunks)

    write_whole(path, fill)


def write_format(path: Path, kind: Format, record: Record) -> None:
    """Write a record in a format to ``path``, whole or not at all; raises OSError, StoreError, MissingExtraError."""

    def fill(part: Path) -> None:
        with part.open("wb") as file:
            kind.write(record, file)

    write_whole(path, fill)


def write_all(run_dir: Path) -> list[TableRow]:
    """Write the tables that every run's folder keeps (``Format.kept``) and manifest.json into a run's folder.

    Close the run's writer first. Returns the rows left out of the appendix for lack of a trustworthy value
    (``describe`` gives the reason). Raises StoreError, OSError.
    """
    with RunReader(run_dir) as reader:
        record = Record(reader)
        for kind in FORMATS.values():
            if kind.kept is not None and kind.kept(record.results):
                write_format(run_dir / kind.file, kind, record)
        head = reader.record_head()
    write_file(run_dir / MANIFEST, [manifest_text(run_dir, head).encode()])
    return record.results.missing()


def doubtful(run_dir: Path) -> list[TableRow]:
    """Return the rows whose value needs care; raises StoreError."""
    with RunReader(run_dir) as reader:
        return results_of(reader).doubtful()


def manifest_of(folder: Path) -> dict[str, dict[str, str | int]]:
    """Return size in bytes and SHA-256 (hexadecimal) of the folder's files by their path in it, sorted."""
    files: dict[str, dict[str, str | int]] = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name != MANIFEST and not name.endswith(_LEFT_OUT):
            files[name] = {"bytes": path.stat().st_size, "sha256": file_sha256(path)}
    return files


def file_sha256(path: Path) -> str:
    """Return the SHA-256 of a file, hexadecimal; raises OSError."""
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


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
