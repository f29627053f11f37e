"""Outputs of a run: the paper's table, conditions, repeats, samples, and the manifest of its folder."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from tester.results.formats import FORMATS, Format, Record
from tester.results.manifest import MANIFEST, manifest_text
from tester.results.run_results import results_of
from tester.results.table_rows import TableRow
from tester.store.disk import write_whole
from tester.store.run_reader import RunReader


def write_file(path: Path, chunks: Iterable[bytes]) -> None:
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
