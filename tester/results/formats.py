"""The output formats of a run: one table, with an entry for each.

Commands, screens, a run's folder and `tester verify` read it. To add a format, write its function in a module of this
package and its entry below. A laboratory's own is a ``Format`` that its package declares as an entry point of the group
``friction_tester.formats``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import BinaryIO

from tester.base.plugins import PluginError, plugins
from tester.results.budget_table import budget_table
from tester.results.directions_table import directions_table
from tester.results.measured_tables import checks_table, pieces_table, repeats_table
from tester.results.parquet import write_parquet
from tester.results.repeated_tables import references_table, settings_table
from tester.results.run_results import RunResults, results_of
from tester.results.stiffness_table import shows_stiffness, stiffness_table
from tester.results.table_cells import Cell, encode
from tester.results.tables import appendix_rows, condition_rows, marked, sample_rows
from tester.store.run_reader import RunReader


@dataclass(frozen=True)
class Record:
    """A run's record, as a format receives it."""

    reader: RunReader
    decimals: int = 2
    """Decimals of a coefficient in the paper's table."""

    @cached_property
    def results(self) -> RunResults:
        """Return the conditions, reduced from their repeats on first use; raises StoreError."""
        return results_of(self.reader)


def _no_remarks(record: Record) -> Iterable[str]:
    return ()


@dataclass(frozen=True, slots=True)
class Format:
    """An output format of a run."""

    name: str
    """Name in commands."""
    file: str
    """Name of its file."""
    title: str
    """Content, in a few words."""
    write: Callable[[Record, BinaryIO], None]
    """Writes the record to a file that is open for bytes; may raise StoreError, OSError, MissingExtraError."""
    kept: Callable[[RunResults], bool] | None = None
    """Whether a run's folder gets the file at the run's end; None: never."""
    is_text: bool = field(default=True, kw_only=True)
    """Whether it may be written to a terminal."""
    remarks: Callable[[Record], Iterable[str]] = field(default=_no_remarks, kw_only=True)
    """Yields remarks for the reader of the file, a line each."""


def _csv(
    rows: Callable[[Record], Iterator[tuple[Cell, ...]]], *, bom: bool = False, risk: bool = True
) -> Callable[[Record, BinaryIO], None]:
    """Return the writer of a table in UTF-8. ``bom``: after a byte order mark; ``risk``: with the risk as last column.
    """

    def write(record: Record, file: BinaryIO) -> None:
        made = rows(record)
        file.writelines(encode(marked(made, record.reader.run().info) if risk else made, bom=bom))

    return write


def _of_paper(record: Record) -> Iterator[str]:
    """Yield the rows that the paper's table leaves out, and those that need care."""
    for row in record.results.missing():
        yield f"not in the appendix: {row.describe()}"
    for row in record.results.doubtful():
        yield f"to be taken with care: {row.advise()}"


def _always(results: RunResults) -> bool:
    return True


_WHEEL = "wheel"
"""The worn part whose table of pieces keeps the name that existing scripts read."""

FORMATS: dict[str, Format] = {
    one.name: one
    for one in (
        Format("appendix", "appendix.csv", "the paper's table",
               _csv(lambda record: appendix_rows(record.results, record.decimals), bom=True), _always,
               remarks=_of_paper),
        Format("conditions", "conditions.csv", "conditions with uncertainty",
               _csv(lambda record: condition_rows(record.results), risk=False), _always),
        Format("budget", "budget.csv", "what each uncertainty is made of",
               _csv(lambda record: budget_table(record.results).csv()), _always),
        Format("directions", "directions.csv", "what each direction of sliding shows, and the cell's angle",
               _csv(lambda record: directions_table(record.results).csv()), lambda results: results.both_directions),
        Format("repeats", "repeats.csv", "every repeat",
               _csv(lambda record: repeats_table(record.results).csv()), _always),
        Format(_WHEEL, f"{_WHEEL}.csv", f"{_WHEEL}s and their wear",
               _csv(lambda record: pieces_table(record.results).csv()), lambda results: results.worn == _WHEEL),
        Format("pieces", "pieces.csv", "what was mounted, and its wear",
               _csv(lambda record: pieces_table(record.results).csv()), lambda results: results.worn != _WHEEL),
        Format("wear", "wear.csv", "checks of diameters", _csv(lambda record: checks_table(record.results).csv()),
               lambda results: bool(results.checks)),
        Format("reference", "reference.csv", "reference conditions, with limits and drift",
               _csv(lambda record: references_table(record.results).csv()), lambda results: results.watch is not None),
        Format("settings", "settings.csv", "settings that were measured several times, and whether they agree",
               _csv(lambda record: settings_table(record.results).csv()), lambda results: bool(results.settings)),
        Format("stiffness", "stiffness.csv", "deformation and stiffness, softening, relaxation",
               _csv(lambda record: stiffness_table(record.results, record.reader).csv()), shows_stiffness),
        Format("samples", "samples.csv", "every sample", _csv(lambda record: sample_rows(record.reader))),
        Format("parquet", "samples.parquet", "every sample, for programs",
               lambda record, file: write_parquet(record.reader, file), is_text=False),
    )
}  # fmt: skip
"""The shipped formats, in the order of lists and files."""


def format_names() -> tuple[str, ...]:
    """Return the names of the formats: the shipped ones, and those of installed packages."""
    return (*FORMATS, *(name for name in plugins().names("formats") if name not in FORMATS))


def format_of(name: str) -> Format:
    """Return the format of a name, from this table or a package's; raises PluginError."""
    if name in FORMATS:
        return FORMATS[name]
    extension = plugins().load("formats", name)
    if not isinstance(extension, Format):
        expected = "a tester.results.formats.Format"
        raise PluginError(f'extension "{name}" is no format (expected {expected}, not {extension!r:.80})')
    return extension
