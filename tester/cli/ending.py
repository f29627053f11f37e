"""What a run ends with on a terminal: the table of what was measured, what was not, which command to try next."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from textwrap import wrap

from rich.cells import cell_len

from tester.analysis.trust import mark_of
from tester.axes import Axis, plain
from tester.cli.formatting import shown
from tester.cli.watch import watch_lines
from tester.results.run_results import RunResults, TableRow, results_of
from tester.store.reader import RunReader
from tester.store.schema import StoreError

ROWS_AT_MOST = 200
"""A longer table is for a spreadsheet: its beginning is shown, with the file that has it all."""
_COMPOUND_AT_MOST = 12
"""Cells of a compound's name; what is longer is cut and ends in an ellipsis."""
_WIDTH = 80
"""Columns of a terminal; remarks that do not fit get a line of their own."""


def ending_lines(folder: Path) -> list[str]:
    """Return the lines for people at the end of a run; none where the folder holds no record that can be read."""
    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
            head = reader.record_head()
    except StoreError:
        return []
    kept = [f"record head: {head}"] if head else []
    return ["", *table_lines(results, folder), "", *kept, *_next_lines(results, folder)]


def table_lines(results: RunResults, folder: Path) -> Iterator[str]:
    """Yield the table, 80 columns wide: a row for each condition of which something was tried.

    Setpoints are nominal, the coefficient is the resultant; U is its expanded uncertainty (coverage 95 %) for what was
    mounted, in this condition, which a line below says; the compound's is in ``conditions.csv``. A row without a value
    that can be trusted has a dash and its status, a value to be taken with care the mark ``?``. Conditions
    that the run did not come to are one line.
    """
    yield from risk_lines(results)
    tried = [row for row in results.rows if row.tried]
    listed = tried[:ROWS_AT_MOST]
    if listed:
        axes = results.axes.columns(row.info.setpoint for row in listed)
        pad = " " if any(row.result.doubts for row in listed) else ""
        titles = [axis.title.rpartition(" ") for axis in axes]
        lines: list[tuple[Sequence[str], str]] = [
            (("compound", *(name for name, _, _ in titles), f"mu{pad}", "U", "valid"), ""),
            (("", *(unit for _, _, unit in titles), "", "(95 %)", ""), ""),
            *((_cells(row, axes, pad), _remarks(row)) for row in listed),
        ]
        widths = [max(map(cell_len, column)) for column in zip(*(cells for cells, _ in lines), strict=True)]
        for cells, remarks in lines:
            yield from _line(cells, widths, remarks)
        yield shown(f"U: of this {results.worn} in this condition; conditions.csv has the compound's, too")
    yield from (shown(line) for line in watch_lines(results))
    if len(tried) > ROWS_AT_MOST:
        yield f"and {len(tried) - ROWS_AT_MOST} more conditions: {folder / 'conditions.csv'}"
    if len(tried) < len(results.rows):
        yield f"{len(results.rows) - len(tried)} of {len(results.rows)} conditions not measured"


def risk_lines(results: RunResults) -> Iterator[str]:
    """Yield which safety keys were looser than they should be, and why that was accepted; nothing where none was."""
    if results.run.info.risk:
        yield from wrap(shown(f"RISK ACCEPTED: {results.run.info.risk}"), _WIDTH, subsequent_indent="    ")


def _cells(row: TableRow, axes: Sequence[Axis], pad: str) -> Sequence[str]:
    """Return a row's cells; ``pad`` stands behind a coefficient where others have a mark."""
    i, r = row.info, row.result
    return (
        _cut(shown(i.compound)),
        *(plain(axis.of(i.setpoint)) for axis in axes),
        f"{r.mu_resultant:.3f}{mark_of(r.status, r.flags) or pad}" if r.ok else f"-{pad}",
        f"{r.expanded:.3f}" if r.ok and isfinite(r.expanded) else "-",
        f"{r.n_valid} of {r.n}",
    )


def _remarks(row: TableRow) -> str:
    """Return the row's status where it has no value, and its flags."""
    status = "" if row.result.ok else row.result.status.value
    return shown(", ".join(part for part in (status, row.result.flags) if part))


def _line(cells: Sequence[str], widths: Sequence[int], remarks: str) -> Iterator[str]:
    """Yield a row: the name at the left, numbers at the right, remarks behind them or below."""
    room = [" " * (width - cell_len(cell)) for cell, width in zip(cells, widths, strict=True)]
    line = "  ".join([cells[0] + room[0], *(space + cell for space, cell in zip(room[1:], cells[1:], strict=True))])
    if not remarks or cell_len(line) + 2 + cell_len(remarks) <= _WIDTH:
        yield f"{line}  {remarks}".rstrip()
        return
    yield line
    yield from wrap(remarks, _WIDTH, initial_indent="    ", subsequent_indent="    ")


def _cut(name: str) -> str:
    """Return a name of at most _COMPOUND_AT_MOST cells."""
    if cell_len(name) <= _COMPOUND_AT_MOST:
        return name
    while cell_len(name) >= _COMPOUND_AT_MOST:
        name = name[:-1]
    return f"{name}…"


def _next_lines(results: RunResults, folder: Path) -> Iterator[str]:
    """Yield the commands to try next, as this one was called."""
    program = Path(sys.argv[0]).name if sys.argv[0] else ""
    called = sys.argv[0] if program in ("tester", "tester.exe") and Path(sys.argv[0]).parent != Path() else "tester"
    where = shlex.quote(str(folder))
    if results.status.over or not results.missing():
        yield f"next: {_near(called)} show {where}"
    else:
        yield f"next: {_near(called)} resume {where}"
    yield f"      {_near(called)} tui"


def _near(program: str) -> str:
    """Return a program's path from here where that is shorter; on the search path, its name."""
    path = Path(program)
    if path.is_absolute() and path.is_relative_to(Path.cwd()):
        return str(path.relative_to(Path.cwd()))
    return program
