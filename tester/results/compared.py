"""The conditions of two runs side by side: matching pairs, and the difference of their compounds."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from math import isfinite
from typing import Final, NamedTuple, TypeAlias

from tester.analysis.difference import Difference, difference
from tester.analysis.results import NAN, mark_of
from tester.base.axes import AxisValue
from tester.results.columns import Column, Output, Table, axis_column
from tester.results.run_results import RunResults
from tester.results.table_rows import TableRow
from tester.store.records import StoredRun

Held: TypeAlias = tuple[str, tuple[AxisValue, ...], int]
"""Key of a comparison: compound, values of the axes as shown to people, number of the measurement at these (from 1)."""


class Pair(NamedTuple):
    """A condition of one run and its match in another; None where a run lacks it. ``found``: second less first."""

    first: TableRow | None
    second: TableRow | None
    found: Difference

    @property
    def either(self) -> TableRow:
        """Return a row that exists."""
        row = self.first or self.second
        assert row is not None
        return row

    @property
    def z(self) -> float:
        """Return the difference over its standard uncertainty; NaN without one."""
        return self.found.value / self.found.standard if self.found.standard > 0.0 else NAN

    @property
    def verdict(self) -> str:
        """Return in words whether the compounds differ."""
        if self.first is None or self.second is None:
            return f"only in {'1' if self.second is None else '2'}"
        if not self.found.standard > 0.0:
            return ""
        return "differ" if self.found.told_apart else "not told apart"


def same_rig(stored_run: StoredRun, other: StoredRun) -> bool:
    """Return whether two runs share the errors of the measuring chain.

    They share them with the same calibration of the same rig; a simulated rig has other imperfections for every seed.
    """
    first, second = stored_run.info, other.info
    return (stored_run.calibration_sha256, first.simulated, first.seed) == (
        other.calibration_sha256,
        second.simulated,
        second.seed,
    )


def pairs(first: RunResults, second: RunResults, compounds: tuple[str, str] | None = None) -> Iterator[Pair]:
    """Yield the conditions of two runs of one kind, each of the first with its match in the second, then the others.

    ``compounds``: compare these two, the first of the first run and the second of the second, at the same setpoints.
    Where a run measures a setting several times, the first measurement pairs with the first, the second with the
    second.
    """
    first_rows, second_rows = (
        _by_setting((r for r in results.rows if compounds is None or r.info.compound == compounds[i]), compounds)
        for i, results in enumerate((first, second))
    )
    shared = same_rig(first.run, second.run)
    for key in dict.fromkeys([*first_rows, *second_rows]):
        a, b = first_rows.get(key), second_rows.get(key)
        off = difference(a.result, b.result, same_rig=shared) if a is not None and b is not None else Difference()
        yield Pair(a, b, off)


def comparison(first: RunResults, second: RunResults, compounds: tuple[str, str] | None = None) -> Table[Pair]:
    """Return the table of ``pairs``: coefficients, their difference, its standard uncertainty u, z and the coverage
    factor k (95 %)."""
    axes: Iterator[Column[Pair]] = (axis_column(axis, lambda pair: pair.either.info) for axis in first.axes)
    return Table((*_WHICH, *axes, *_FOUND), tuple(pairs(first, second, compounds)))


def _mu(row: TableRow | None) -> float:
    return row.result.mu if row is not None else NAN


def _mark(row: TableRow | None) -> str:
    return mark_of(row.result.status, row.result.flags) if row is not None and isfinite(row.result.mu) else ""


def _pieces(row: TableRow | None) -> int:
    return row.result.n_valid if row is not None and len(row.replicates) > 1 else 1


_WHICH: tuple[Column[Pair], ...] = (
    Column("compound", "compound", lambda pair: pair.either.info.compound),
    Column("pieces_1", "pieces 1", lambda pair: _pieces(pair.first), "", 0),
    Column("pieces_2", "pieces 2", lambda pair: _pieces(pair.second), "", 0),
)
_SHOWN: Final = frozenset({Output.COMPARE})
_FOUND: tuple[Column[Pair], ...] = (
    Column("mu_1", "mu 1", lambda pair: _mu(pair.first), "", 3, _SHOWN, lambda pair: _mark(pair.first)),
    Column("mu_2", "mu 2", lambda pair: _mu(pair.second), "", 3, _SHOWN, lambda pair: _mark(pair.second)),
    Column("mark_1", "mark 1", lambda pair: _mark(pair.first)),
    Column("mark_2", "mark 2", lambda pair: _mark(pair.second)),
    Column("difference", "difference", lambda pair: pair.found.value, "", 3, _SHOWN),
    Column("u_difference", "u", lambda pair: pair.found.standard, "", 3, _SHOWN),
    Column("z", "z", lambda pair: pair.z, "", 2, _SHOWN),
    Column("k", "k", lambda pair: pair.found.coverage, "", 2, _SHOWN),
    Column("differs", "differs", lambda pair: pair.found.told_apart),
    Column("verdict", "verdict", lambda pair: pair.verdict, views=_SHOWN),
)


def _by_setting(rows: Iterable[TableRow], compounds: tuple[str, str] | None) -> dict[Held, TableRow]:
    rows_found: dict[Held, TableRow] = {}
    count: Counter[tuple[str, tuple[AxisValue, ...]]] = Counter()
    for row in rows:
        compound, values = row.info.setpoint.key()
        setting = "" if compounds else compound, values
        count[setting] += 1
        rows_found[(*setting, count[setting])] = row
    return rows_found
