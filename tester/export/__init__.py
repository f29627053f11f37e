"""What leaves a run: the paper's table, conditions, repeats, samples, and the manifest of its folder."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from tester.export.cells import encode
from tester.export.manifest import MANIFEST, manifest_text
from tester.export.results import RunResults, TableRow, results_of
from tester.export.tables import (
    appendix_rows,
    check_rows,
    condition_rows,
    marked,
    repeat_rows,
    sample_rows,
    wheel_rows,
)
from tester.store.files import write_whole
from tester.store.reader import RunReader

__all__ = [
    "RunResults",
    "TableRow",
    "appendix",
    "conditions",
    "repeats",
    "results_of",
    "samples",
    "wear",
    "wheels",
    "write_all",
    "write_file",
    "write_parquet_file",
]


def appendix(results: RunResults, decimals: int = 2) -> Iterator[bytes]:
    """Yield appendix.csv: the paper's table, UTF-8 with BOM."""
    return encode(marked(appendix_rows(results, decimals), results.run.info), bom=True)


def conditions(results: RunResults) -> Iterator[bytes]:
    """Yield conditions.csv."""
    return encode(condition_rows(results))


def repeats(results: RunResults) -> Iterator[bytes]:
    """Yield repeats.csv."""
    return encode(marked(repeat_rows(results), results.run.info))


def wheels(results: RunResults) -> Iterator[bytes]:
    """Yield wheel.csv."""
    return encode(marked(wheel_rows(results), results.run.info))


def wear(results: RunResults) -> Iterator[bytes]:
    """Yield wear.csv: the checks of the wheels' diameters."""
    return encode(marked(check_rows(results), results.run.info))


def samples(reader: RunReader) -> Iterator[bytes]:
    """Yield samples.csv in bounded memory."""
    return encode(marked(sample_rows(reader), reader.run().info))


def write_file(path: Path, chunks: Iterable[bytes]) -> None:
    """Write ``chunks`` to ``path``, whole or not at all; raises OSError."""

    def fill(part: Path) -> None:
        with part.open("wb") as file:
            file.writelines(chunks)

    write_whole(path, fill)


def write_parquet_file(path: Path, reader: RunReader) -> None:
    """Write the samples as a Parquet file, whole or not at all; raises OSError, StoreError, MissingExtraError."""
    from tester.export.parquet import write_parquet

    def fill(part: Path) -> None:
        write_parquet(reader, part)

    write_whole(path, fill)


def write_all(run_dir: Path) -> list[TableRow]:
    """Write appendix.csv, conditions.csv, repeats.csv, wheel.csv and manifest.json into a run's folder.

    And wear.csv where a wheel's diameter was checked. The run's writer has to be closed. Returns the rows that are not
    in the appendix because they have no value to be trusted (``describe`` says why). Raises StoreError, OSError.
    """
    with RunReader(run_dir) as reader:
        results = results_of(reader)
        head = reader.record_head()
    write_file(run_dir / "appendix.csv", appendix(results))
    write_file(run_dir / "conditions.csv", conditions(results))
    write_file(run_dir / "repeats.csv", repeats(results))
    write_file(run_dir / "wheel.csv", wheels(results))
    if results.checks:
        write_file(run_dir / "wear.csv", wear(results))
    write_file(run_dir / MANIFEST, [manifest_text(run_dir, head).encode()])
    return results.missing()


def doubtful(run_dir: Path) -> list[TableRow]:
    """Return the rows whose value is to be taken with care; raises StoreError."""
    with RunReader(run_dir) as reader:
        return results_of(reader).doubtful()
