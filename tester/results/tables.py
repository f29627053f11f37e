"""Tables whose cells differ from their columns in number: the paper's appendix, conditions, samples.

Appendix and conditions hold no wall-clock time, path, host or version: the same data gives the same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isnan

from tester.results.conditions_table import conditions_table
from tester.results.run_results import RunResults
from tester.results.table_cells import Cell, Number, exact, nominal
from tester.store.records import RunInfo
from tester.store.run_reader import RunReader

HEAD_COLUMN = "record_head"
RISK_COLUMN = "accepted_risk"
"""Last column of every table of a run with an accepted risk; ``conditions.csv`` has it among the metadata."""

OWNER = ("condition", "repeat", "attempt")
"""Last columns of the samples: the repeat that they belong to."""


def marked(rows: Iterator[tuple[Cell, ...]], run: RunInfo) -> Iterator[tuple[Cell, ...]]:
    """Yield a table's rows, with a last column that names the risk accepted for the run, if any."""
    if not run.risk:
        yield from rows
        return
    yield (*next(rows), RISK_COLUMN)
    for row in rows:
        yield (*row, run.risk)


def appendix_rows(results: RunResults, decimals: int = 2) -> Iterator[tuple[Cell, ...]]:
    """Yield the paper's table: nominal setpoints, one row for each condition with a trustworthy value.

    Reference conditions are left out: one setpoint many times over is no further condition of a compound, and a plot or
    fit of the table would overweight it.

    It has the paper's six columns, and a further one for every axis that is off its default in any condition of the
    recipe.
    """
    axes = results.axes.columns(row.info.setpoint for row in results.rows)
    yield ("Formula", *(axis.header for axis in axes), "Friction Coefficient")
    for row in results.rows:
        if row.result.ok:
            yield (
                row.info.compound,
                *(nominal(axis.of(row.info.setpoint)) for axis in axes),
                Number(f"{row.result.mu:.{decimals}f}"),
            )


def condition_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield the table of conditions.

    Behind its columns come the recipe's metadata, a column each, and last the head of the record's chain: empty for a
    simulated run, which its seed reproduces byte for byte.
    """
    metadata = dict(sorted(results.run.info.metadata.items()))
    last = (*metadata.values(), "" if results.run.info.simulated else results.record_head)
    rows = conditions_table(results).csv()
    keys = next(rows)
    yield (*keys, *(key if key not in (*keys, HEAD_COLUMN) else f"recipe_{key}" for key in metadata), HEAD_COLUMN)
    for row in rows:
        yield (*row, *last)


def sample_rows(reader: RunReader) -> Iterator[tuple[Cell, ...]]:
    """Yield every recorded sample with its condition, repeat and attempt (empty: none)."""
    channels = reader.quantities().recorded
    yield (*(channel.name for channel in channels), *OWNER)
    owners = {repeat.key: repeat for repeat in reader.repeats(attempts=True)}
    for block in reader.sample_blocks():
        owner = owners.get(block.repeat_key)
        ids = (owner.condition, owner.repeat, owner.attempt) if owner is not None else (None, None, None)
        columns = [
            [_whole(value) if channel.whole else exact(value) for value in block.columns[channel.name]]
            for channel in channels
        ]
        for cells in zip(*columns, strict=True):
            yield (*cells, *ids)


def _whole(value: float) -> Number:
    return Number("") if isnan(value) else Number(int(value))
