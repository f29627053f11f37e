"""The output formats of a run: one table, with an entry for each.

Commands, screens, a run's folder and `tester verify` read it. To add a format, write its function in a module of this
package and its entry below. A laboratory's own is a ``Format`` that its package declares as an entry point of the group
``friction_tester.formats``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import BinaryIO, TypeAlias

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
from tester.results.workbook import Sheet, write_workbook
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
    rows: Rows | None = field(default=None, kw_only=True)
    """The rows of a table, headings first, which a workbook shows too; None for a format that is no table."""


Rows: TypeAlias = Callable[[Record], Iterator[tuple[Cell, ...]]]


def _table(
    name: str, title: str, rows: Rows, kept: Callable[[RunResults], bool] | None = None, *, bom: bool = False,
    risk: bool = True, remarks: Callable[[Record], Iterable[str]] = _no_remarks,
) -> Format:  # fmt: skip
    """Return the format of a table as CSV in UTF-8. ``bom``: after a byte order mark; ``risk``: with the risk as last
    column.
    """

    def all_rows(record: Record) -> Iterator[tuple[Cell, ...]]:
        return marked(rows(record), record.reader.run().info) if risk else rows(record)

    def write(record: Record, file: BinaryIO) -> None:
        file.writelines(encode(all_rows(record), bom=bom))

    return Format(name, f"{name}.csv", title, write, kept, remarks=remarks, rows=all_rows)


def _workbook(record: Record, file: BinaryIO) -> None:
    """Write every table that the run's folder keeps."""
    write_workbook(_sheets(record), record.reader.run().info.started_utc, file)


def _sheets(record: Record) -> Iterator[Sheet]:
    for one in FORMATS.values():
        if one.rows is not None and one.kept is not None and one.kept(record.results):
            yield one.name, one.rows(record)


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
        _table("appendix", "the paper's table", lambda record: appendix_rows(record.results, record.decimals), _always,
               bom=True, remarks=_of_paper),
        _table("conditions", "conditions with uncertainty", lambda record: condition_rows(record.results), _always,
               risk=False),
        _table("budget", "what each uncertainty is made of", lambda record: budget_table(record.results).csv(),
               _always),
        _table("directions", "what each direction of sliding shows, and the cell's angle",
               lambda record: directions_table(record.results).csv(), lambda results: results.both_directions),
        _table("repeats", "every repeat", lambda record: repeats_table(record.results).csv(), _always),
        _table(_WHEEL, f"{_WHEEL}s and their wear", lambda record: pieces_table(record.results).csv(),
               lambda results: results.worn == _WHEEL),
        _table("pieces", "what was mounted, and its wear", lambda record: pieces_table(record.results).csv(),
               lambda results: results.worn != _WHEEL),
        _table("wear", "checks of diameters", lambda record: checks_table(record.results).csv(),
               lambda results: bool(results.checks)),
        _table("reference", "reference conditions, with limits and drift",
               lambda record: references_table(record.results).csv(), lambda results: results.watch is not None),
        _table("settings", "settings that were measured several times, and whether they agree",
               lambda record: settings_table(record.results).csv(), lambda results: bool(results.settings)),
        _table("stiffness", "deformation and stiffness, softening, relaxation",
               lambda record: stiffness_table(record.results, record.reader).csv(), shows_stiffness),
        _table("samples", "every sample", lambda record: sample_rows(record.reader)),
        Format("xlsx", "tables.xlsx", "these tables but samples, as one workbook", _workbook, is_text=False),
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
