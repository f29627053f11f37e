"""The tables of a sweep: every run, every condition in it, and their statistics.

The same results give the same bytes, because the tables contain no wall-clock time, path, host or version.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite, sqrt
from statistics import fmean, stdev

from tester.base.axes import Axes
from tester.results.conditions_table import sweep_columns
from tester.results.table_cells import Cell, nominal
from tester.run.sweep.case import CaseResult, RowResult
from tester.run.sweep.grid import SweepAxis

Row = tuple[Cell, ...]

_STATISTICS = ("n", "mean", "sd", "min", "max")


def head_of(axes: Sequence[SweepAxis]) -> Row:
    """Return the columns that identify a point: its keys of the rig file."""
    return tuple(axis.key for axis in axes)


# -- every run ----------------------------------------------------------------------------------------------------


def run_header(axes: Sequence[SweepAxis], worn: str) -> Row:
    """Return the columns of ``runs.csv``; ``worn``: name for people of the part that wears."""
    counts = ("rig_seconds", f"{worn}s", "rows", "missing_rows")
    return (*head_of(axes), "seed", "outcome", "reason", "exit_code", *counts)


def run_row(result: CaseResult) -> Row:
    """Return a run's row of ``runs.csv``."""
    r = result
    return (*r.point, r.seed, r.outcome, r.reason, r.exit_code, r.rig_seconds, r.mounted, len(r.rows), r.missing)


def condition_header(axes: Sequence[SweepAxis], condition_axes: Axes) -> Row:
    """Return the columns of ``conditions.csv``; ``condition_axes``: the axes of the recipe's conditions."""
    return (*head_of(axes), "seed", *_setpoint_header(condition_axes), *(column.key for column in sweep_columns()))


def condition_rows(result: CaseResult) -> Iterator[Row]:
    """Yield a run's rows of ``conditions.csv``: every row of the recipe's table, even without a value."""
    for row in result.rows:
        yield (*result.point, result.seed, *_setpoints(row), *row.cells.values())


# -- statistics ---------------------------------------------------------------------------------------------------


def summary_header(axes: Sequence[SweepAxis], condition_axes: Axes) -> Row:
    """Return the columns of ``summary.csv``.

    ``mu_sd`` is the spread between seeds, ``u_standard`` the root mean square of the runs' stated uncertainties, and
    ``sd_over_u`` their ratio: 1 if the stated uncertainties match the spread. ``n`` counts the runs with a value,
    ``with_care`` the runs among them whose value carries a doubt (its flags are in ``conditions.csv``).
    """
    mu = tuple(f"mu_{name}" for name in _STATISTICS[1:])
    return (*head_of(axes), *_setpoint_header(condition_axes), "runs", "n", *mu, "u_standard", "sd_over_u", "with_care")


def summary_rows(results: Sequence[CaseResult]) -> Iterator[Row]:
    """Yield the statistics of every condition over the seeds of every point, in the order of points and rows."""
    for point, group in _by_point(results):
        by_row: dict[int, list[RowResult]] = {}
        for result in group:
            for row in result.rows:
                by_row.setdefault(row.row, []).append(row)
        for _, rows in sorted(by_row.items()):
            n, mean, sd, least, greatest = _statistics([row.number("mu") for row in rows])
            stated = [u for row in rows if isfinite(u := row.number("u_standard"))]
            u = sqrt(fmean(x * x for x in stated)) if stated else None
            over = sd / u if sd is not None and u else None
            doubts = sum(row.with_care for row in rows)
            yield (*point, *_setpoints(rows[0]), len(rows), n, mean, sd, least, greatest, u, over, doubts)


def totals_header(axes: Sequence[SweepAxis], worn: str) -> Row:
    """Return the columns of ``totals.csv``; ``worn``: name for people of the part that wears."""
    seconds = tuple(f"rig_seconds_{name}" for name in _STATISTICS[1:])
    mounted = tuple(f"{worn}s_{name}" for name in _STATISTICS[1:])
    return (*head_of(axes), "runs", "done", "other_outcomes", "rows", "missing_rows", *seconds, *mounted)


def totals_rows(results: Sequence[CaseResult]) -> Iterator[Row]:
    """Yield, for every point, the outcomes, durations and numbers of worn parts of its runs.

    Durations and parts cover only completed runs.
    """
    for point, group in _by_point(results):
        done = [result for result in group if result.outcome == "done"]
        others: dict[str, int] = {}
        for result in group:
            if result.outcome != "done":
                others[result.outcome] = others.get(result.outcome, 0) + 1
        other_outcomes = ", ".join(f"{count} {outcome}" for outcome, count in sorted(others.items()))
        _, *seconds = _statistics([result.rig_seconds for result in done])
        _, *mounted = _statistics([float(result.mounted) for result in done])
        rows = sum(len(result.rows) for result in group)
        missing = sum(result.missing for result in group)
        yield (*point, len(group), len(done), other_outcomes, rows, missing, *seconds, *mounted)


def _setpoint_header(condition_axes: Axes) -> Row:
    return ("row", "compound", *(axis.column for axis in condition_axes))


def _setpoints(row: RowResult) -> Row:
    setpoint = row.setpoint
    return (row.row, setpoint.compound, *(nominal(axis.of(setpoint)) for axis in setpoint.axes))


def row_record(row: RowResult) -> dict[str, Cell]:
    """Return a row's cells by column, as numbers and texts."""
    setpoint = row.setpoint
    setpoints = {axis.column: axis.of(setpoint) for axis in setpoint.axes}
    return {"row": row.row, "compound": setpoint.compound, **setpoints, **row.cells}


def _by_point(results: Sequence[CaseResult]) -> Iterator[tuple[tuple[str, ...], list[CaseResult]]]:
    """Yield the results of every point, in the order of cases, in whatever order they arrived."""
    groups: dict[tuple[str, ...], list[CaseResult]] = {}
    for result in sorted(results, key=case_of):
        groups.setdefault(result.point, []).append(result)
    yield from groups.items()


def case_of(result: CaseResult) -> int:
    """Return the sort key of a result."""
    return result.case


def _statistics(values: Sequence[float]) -> tuple[int, float | None, float | None, float | None, float | None]:
    """Return count, mean, standard deviation, least and greatest of the finite values; None where they give none."""
    finite = [value for value in values if isfinite(value)]
    if not finite:
        return 0, None, None, None, None
    return len(finite), fmean(finite), stdev(finite) if len(finite) > 1 else None, min(finite), max(finite)
