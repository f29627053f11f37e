"""Both directions of sliding as a table: the result of each, and the apparent misalignment of the load cell's axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from tester.analysis.directions import BothWays, SlidingWay
from tester.analysis.schemes import Misalignment, misalignment
from tester.results.columns import Column, Table, Value
from tester.results.conditions_table import conditions_table
from tester.results.run_results import RunResults


@dataclass(frozen=True, slots=True)
class DirectionRow:
    """A condition in both directions; or the whole run, whose pairs give the angle together."""

    setting: tuple[Value, ...]
    """Cells of the columns that identify the condition, in order."""
    pairs: int
    ways: BothWays | None
    angle: Misalignment


def directions_table(results: RunResults) -> Table[DirectionRow]:
    """Return a row for each condition measured in both directions, and a last one for the whole run.

    ``mu_difference_percent``: excess of the requested direction over the reverse. The angle is that of the cell's axes
    including crosstalk of load and friction (``tester.analysis.schemes``); the row ``run`` has it pooled over all
    conditions.
    """
    conditions = conditions_table(results)
    keys = ("level", "condition", *_SETTING, *(axis.column for axis in results.axes))
    rows: list[DirectionRow] = []
    for row in conditions.rows:
        if row.measured is not None and row.result.both_ways is not None:
            ways, angle = row.result.both_ways, misalignment([row.result])
            rows.append(DirectionRow(tuple(conditions[key].value(row) for key in keys), ways.pairs, ways, angle))
    pooled = results.misalignment()
    rows.append(DirectionRow(("run", *(None for _ in keys[1:])), pooled.pairs, None, pooled))
    setting = (_cell_of(key, place) for place, key in enumerate(keys))
    sides = (_of_way(side, name, read) for side in _SIDES for name, read in _WAY.items())
    return Table[DirectionRow]((*setting, _PAIRS, *sides, *_ANGLE), tuple(rows))


def _cell_of(key: str, place: int) -> Column[DirectionRow]:
    return Column(key, key, lambda row: row.setting[place])


def _of_way(side: str, name: str, read: Callable[[SlidingWay], Value]) -> Column[DirectionRow]:
    def value(row: DirectionRow) -> Value:
        return read(_SIDES[side](row.ways)) if row.ways is not None else None

    return Column(f"{name}_{side}", f"{name} {side}", value)


_SETTING: Final = ("specimen", "replicate", "grid", "compound", "note")
_SIDES: dict[str, Callable[[BothWays], SlidingWay]] = {
    "as_asked": lambda ways: ways.forward,
    "reversed": lambda ways: ways.backward,
}
_WAY: dict[str, Callable[[SlidingWay], Value]] = {
    "n": lambda way: way.n,
    "mu_as_measured": lambda way: way.mu,
    "s": lambda way: way.s,
    "mu_longitudinal_as_measured": lambda way: way.along,
    "drift_percent": lambda way: way.drift_percent,
    "load_n": lambda way: way.means.normal,
    "sliding_m_s": lambda way: way.means.sliding,
    "surface_c": lambda way: way.means.temperature,
}
_PAIRS: Column[DirectionRow] = Column("pairs", "pairs", lambda row: row.pairs, "", 0)
_ANGLE: tuple[Column[DirectionRow], ...] = (
    Column("mu_difference_percent", "difference of mu", lambda row: row.ways and row.ways.difference_percent, "%", 2),
    Column("misalignment_deg", "angle", lambda row: row.angle.deg, "°", 2),
    Column("misalignment_u_standard_deg", "u of the angle", lambda row: row.angle.standard_deg, "°", 2),
    Column("misalignment_u_expanded_deg", "U of the angle", lambda row: row.angle.expanded_deg, "°", 2),
    Column("degrees_of_freedom", "df", lambda row: row.angle.df, "", 0),
)
