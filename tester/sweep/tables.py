"""The tables of a sweep: every run, every condition of it, and what they are together.

The same results give the same bytes: no wall-clock time, path, host or version is in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import astuple, fields
from math import isfinite, sqrt
from statistics import fmean, stdev

from tester.analysis.trust import WITH_CARE, mark_of
from tester.axes import AXES
from tester.export.cells import Cell, nominal
from tester.sweep.case import CaseResult, RowResult
from tester.sweep.grid import Axis

Row = tuple[Cell, ...]

_SETPOINTS = ("row", "compound", *(axis.column for axis in AXES))
_MEASURED = ("status", "mu", "s", "n_valid", "u_standard", "flags", "reason")
_STATISTICS = ("n", "mean", "sd", "min", "max")


def head_of(axes: Sequence[Axis]) -> Row:
    """Return the columns that name a point: the keys of the rig file that were set."""
    return tuple(axis.key for axis in axes)


# -- every run ----------------------------------------------------------------------------------------------------


def run_header(axes: Sequence[Axis]) -> Row:
    """Return the columns of ``runs.csv``."""
    return (*head_of(axes), "seed", "outcome", "reason", "exit_code", "rig_seconds", "wheels", "rows", "missing_rows")


def run_row(result: CaseResult) -> Row:
    """Return a run's row of ``runs.csv``."""
    r = result
    return (*r.point, r.seed, r.outcome, r.reason, r.exit_code, r.rig_seconds, r.wheels, len(r.rows), r.missing)


def condition_header(axes: Sequence[Axis]) -> Row:
    """Return the columns of ``conditions.csv``."""
    return (*head_of(axes), "seed", *_SETPOINTS, *_MEASURED)


def condition_rows(result: CaseResult) -> Iterator[Row]:
    """Yield a run's rows of ``conditions.csv``: one for each row of the recipe's table, also one without a value."""
    for row in result.rows:
        measured = astuple(row)[len(_SETPOINTS) :]
        yield (*result.point, result.seed, *_setpoints(row), *measured)


# -- what they are together ---------------------------------------------------------------------------------------


def summary_header(axes: Sequence[Axis]) -> Row:
    """Return the columns of ``summary.csv``.

    ``mu_sd`` is the spread between seeds, ``u_standard`` the root mean square of the uncertainties that the runs state,
    ``sd_over_u`` their ratio: 1 where runs scatter as they say. ``n`` counts the runs with a value,
    ``with_care`` those of them whose value carries a doubt (its flags are in ``conditions.csv``).
    """
    mu = tuple(f"mu_{name}" for name in _STATISTICS[1:])
    return (*head_of(axes), *_SETPOINTS, "runs", "n", *mu, "u_standard", "sd_over_u", "with_care")


def summary_rows(results: Sequence[CaseResult]) -> Iterator[Row]:
    """Yield the statistics of every condition over the seeds of every point, in the order of points and rows."""
    for point, group in _by_point(results):
        by_row: dict[int, list[RowResult]] = {}
        for result in group:
            for row in result.rows:
                by_row.setdefault(row.row, []).append(row)
        for _, rows in sorted(by_row.items()):
            n, mean, sd, least, greatest = _statistics([row.mu for row in rows])
            stated = [row.u_standard for row in rows if isfinite(row.u_standard)]
            u = sqrt(fmean(x * x for x in stated)) if stated else None
            over = sd / u if sd is not None and u else None
            doubts = sum(mark_of(row.status, row.flags) == WITH_CARE for row in rows)
            yield (*point, *_setpoints(rows[0]), len(rows), n, mean, sd, least, greatest, u, over, doubts)


def totals_header(axes: Sequence[Axis]) -> Row:
    """Return the columns of ``totals.csv``."""
    seconds = tuple(f"rig_seconds_{name}" for name in _STATISTICS[1:])
    wheels = tuple(f"wheels_{name}" for name in _STATISTICS[1:])
    return (*head_of(axes), "runs", "done", "other_outcomes", "rows", "missing_rows", *seconds, *wheels)


def totals_rows(results: Sequence[CaseResult]) -> Iterator[Row]:
    """Yield, for every point, how its runs ended, how long they took and how many wheels they used.

    Duration and wheels are those of runs that came to their end.
    """
    for point, group in _by_point(results):
        done = [result for result in group if result.outcome == "done"]
        others: dict[str, int] = {}
        for result in group:
            if result.outcome != "done":
                others[result.outcome] = others.get(result.outcome, 0) + 1
        told = ", ".join(f"{count} {outcome}" for outcome, count in sorted(others.items()))
        _, *seconds = _statistics([result.rig_seconds for result in done])
        _, *wheels = _statistics([float(result.wheels) for result in done])
        rows = sum(len(result.rows) for result in group)
        missing = sum(result.missing for result in group)
        yield (*point, len(group), len(done), told, rows, missing, *seconds, *wheels)


def _setpoints(row: RowResult) -> Row:
    values = [getattr(row, field.name) for field in fields(row)[2 : len(_SETPOINTS)]]
    return (row.row, row.compound, *(nominal(value) for value in values))


def _by_point(results: Sequence[CaseResult]) -> Iterator[tuple[tuple[str, ...], list[CaseResult]]]:
    """Yield the results of every point, in the order of cases whatever order they came in."""
    groups: dict[tuple[str, ...], list[CaseResult]] = {}
    for result in sorted(results, key=case_of):
        groups.setdefault(result.point, []).append(result)
    yield from groups.items()


def case_of(result: CaseResult) -> int:
    """Return what results are sorted by."""
    return result.case


def _statistics(values: Sequence[float]) -> tuple[int, float | None, float | None, float | None, float | None]:
    """Return count, mean, standard deviation, least and greatest of the finite values; None where there is none."""
    found = [value for value in values if isfinite(value)]
    if not found:
        return 0, None, None, None, None
    return len(found), fmean(found), stdev(found) if len(found) > 1 else None, min(found), max(found)
