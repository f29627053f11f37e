"""The conditions of two runs side by side: which belong together, and by how much their compounds differ."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeAlias

from tester.analysis.difference import Difference, difference
from tester.axes import AxisValue
from tester.results.run_results import RunResults, TableRow
from tester.store.records import StoredRun

Held: TypeAlias = tuple[str, tuple[AxisValue, ...], int]
"""What is compared: compound, values of the axes as people read them, which measurement of them it is (from 1)."""


class Pair(NamedTuple):
    """A condition of one run and the same of another; None where one has it not. ``found``: second less first."""

    first: TableRow | None
    second: TableRow | None
    found: Difference

    @property
    def either(self) -> TableRow:
        """Return the row that there is."""
        found = self.first or self.second
        assert found is not None
        return found


def same_rig(one: StoredRun, other: StoredRun) -> bool:
    """Tell whether two runs have the errors of the measuring chain in common.

    One calibration of one rig; a simulated one has other imperfections for every seed.
    """
    first, second = one.info, other.info
    return (one.calibration_sha256, first.simulated, first.seed) == (
        other.calibration_sha256,
        second.simulated,
        second.seed,
    )


def pairs(first: RunResults, second: RunResults, compounds: tuple[str, str] | None = None) -> Iterator[Pair]:
    """Yield the conditions of two runs of one kind, each of the first with the same of the second, then the others.

    ``compounds``: compare these two, the first of the first run and the second of the second, at the same setpoints.
    Where a run measures a setting several times, the first measurement goes with the first, the second with the second.
    """
    one, other = (
        _by_setting((r for r in results.rows if compounds is None or r.info.compound == compounds[i]), compounds)
        for i, results in enumerate((first, second))
    )
    shared = same_rig(first.run, second.run)
    for key in dict.fromkeys([*one, *other]):
        a, b = one.get(key), other.get(key)
        found = difference(a.result, b.result, same_rig=shared) if a is not None and b is not None else Difference()
        yield Pair(a, b, found)


def _by_setting(rows: Iterable[TableRow], compounds: tuple[str, str] | None) -> dict[Held, TableRow]:
    found: dict[Held, TableRow] = {}
    count: Counter[tuple[str, tuple[AxisValue, ...]]] = Counter()
    for row in rows:
        held = row.info.setpoint
        setting = "" if compounds else held.compound, tuple(axis.of(held) for axis in held.axes)
        count[setting] += 1
        found[(*setting, count[setting])] = row
    return found
