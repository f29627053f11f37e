"""The end of a run on a terminal: the table of results, the conditions without one, the next commands."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap

from tester.cli.text_table import WIDTH, shown, table_lines
from tester.results.columns import Output
from tester.results.conditions_table import axis_keys, conditions_table, recipe_rows
from tester.results.run_results import RunResults, results_of
from tester.results.tally import flag_lines, tally_of
from tester.store.record_schema import StoreError
from tester.store.run_reader import RunReader

ROWS_AT_MOST = 200
"""Most rows shown; of a longer table the beginning, with the name of the file that has every row."""


def ending_lines(folder: Path) -> list[str]:
    """Return the lines for people at the end of a run; none where the folder holds no record that can be read."""
    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
            head = reader.record_head()
    except StoreError:
        return []
    kept = [f"record head: {head}"] if head else []
    return ["", *ending_table(results, folder), "", *kept, *_next_lines(results, folder)]


def ending_table(results: RunResults, folder: Path) -> Iterator[str]:
    """Yield the table, 80 columns wide: a row for each condition that was tried.

    ``mu`` and its expanded uncertainty (95 %) of the mounted piece are at the temperature asked for; the compound's is
    in ``conditions.csv``. A number that cannot be trusted has the mark ``!``, a value to be taken with care ``?``.
    Conditions that the run did not reach are one line.
    """
    yield from risk_lines(results)
    conditions = recipe_rows(conditions_table(results))
    tried = [one for one in conditions.rows if one.row.tried]
    listed = tried[:ROWS_AT_MOST]
    if listed:
        axes = results.axes.columns(one.info.setpoint for one in listed)
        yield from table_lines(conditions.of(listed).view(Output.END, axis_keys(axes)), "remarks")
        yield shown(f"U: expanded uncertainty (95 %) of this {results.worn}; conditions.csv has the compound's")
        yield from tally_lines(results)
    yield from (shown(line) for line in results.watch_lines())
    if len(tried) > ROWS_AT_MOST:
        yield f"and {len(tried) - ROWS_AT_MOST} more conditions: {folder / 'conditions.csv'}"
    if len(tried) < len(results.rows):
        yield f"{len(results.rows) - len(tried)} of {len(results.rows)} conditions not measured"


def tally_lines(results: RunResults, width: int = WIDTH) -> Iterator[str]:
    """Yield the numbers of conditions with a value and with flags, then the meaning and the remedy of each flag."""
    for line in (tally_of(results).sentence, *flag_lines(results)):
        yield from wrap(shown(line), width, subsequent_indent="    ")


def risk_lines(results: RunResults) -> Iterator[str]:
    """Yield the accepted risk: safety keys looser than they should be, and the reason; nothing without one."""
    if results.run.info.risk:
        yield from wrap(shown(f"RISK ACCEPTED: {results.run.info.risk}"), WIDTH, subsequent_indent="    ")


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
    """Return a program's path, relative to the working folder if the program is below it."""
    path = Path(program)
    if path.is_absolute() and path.is_relative_to(Path.cwd()):
        return str(path.relative_to(Path.cwd()))
    return program
