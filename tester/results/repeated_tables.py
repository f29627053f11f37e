"""Tables of what a run measures several times: reference conditions, and any setting with several measurements.

A reference condition has its point of the control chart and the change of the counterface, a measurement the verdict of
its setting.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Final

from tester.analysis.difference import Difference
from tester.analysis.reference import CounterfaceDrift, Reference
from tester.analysis.reference_watch import ControlChart, ControlPoint
from tester.analysis.repeated_settings import SettingMeasurement, difference_of
from tester.results.columns import Column, Output, Table, Value, axis_column, piece_key
from tester.results.run_results import RunResults
from tester.results.settings_compared import RepeatedSetting
from tester.results.table_rows import TableRow
from tester.store.records import ConditionInfo


@dataclass(frozen=True, slots=True)
class ReferenceRow:
    """A reference condition with its point on its compound's chart; ``drift`` is its counterface's."""

    row: TableRow
    reference: Reference
    chart: ControlChart | None
    point: ControlPoint | None
    drift: CounterfaceDrift | None

    @property
    def within(self) -> bool | None:
        """Return whether it is inside the limits; None where it has no value."""
        return self.point.within if self.point is not None and isfinite(self.point.mu) else None

    @property
    def verdict(self) -> str:
        """Return ``within`` in words."""
        return "no value" if self.within is None else "in control" if self.within else "out of control"

    def change(self, part: int) -> Value:
        """Return the counterface's change over its travel, per cent (part 0), or an end of its interval (95 %)."""
        return self.drift.changed_percent(self.drift.over_m)[part] if self.drift is not None else None


def references_table(results: RunResults) -> Table[ReferenceRow]:
    """Return a row for each reference condition, in the order of measurement.

    ``mu`` is at the nominal temperature, ``repeatability_expanded`` its expanded repeatability (95 %). The result for
    a counterface is the same in every row of it.
    """
    piece = Column[ReferenceRow](piece_key(results.worn), results.worn, lambda row: row.reference.piece or None)
    axes: Iterator[Column[ReferenceRow]] = (axis_column(axis, lambda row: row.row.info) for axis in results.axes)
    rows = tuple(_reference_rows(results))
    return Table[ReferenceRow]((*_WHICH_REFERENCE, piece, _COMPOUND, *axes, *_OF_REFERENCE), rows)


def _reference_rows(results: RunResults) -> Iterator[ReferenceRow]:
    watch = results.watch
    if watch is None:
        return
    points = {point.condition: (chart, point) for chart in watch.charts for point in chart.points}
    rows = {row.info.condition: row for row in results.references}
    for reference in watch.references:
        yield ReferenceRow(
            rows[reference.condition], reference, *points.get(reference.condition, (None, None)),
            watch.drifts.get(reference.surface),
        )


_SHOWN: Final = frozenset({Output.REPORT})

_WHICH_REFERENCE: tuple[Column[ReferenceRow], ...] = (
    Column("reference", "turn", lambda row: row.reference.number, "", 0, _SHOWN),
    Column("condition", "condition", lambda row: row.reference.condition),
)
_COMPOUND: Column[ReferenceRow] = Column("compound", "compound", lambda row: row.reference.compound, views=_SHOWN)
_OF_REFERENCE: tuple[Column[ReferenceRow], ...] = (
    Column("status", "status", lambda row: row.row.result.status.value),
    Column("started_s", "began at", lambda row: row.reference.t_s, "s", 0),
    Column("counterface_travel_m", "travel of the counterface", lambda row: row.reference.counterface_m, "m", 0),
    Column("piece_sliding_m", "slid", lambda row: row.reference.piece_m, "m", 0),
    Column("mu", "mu", lambda row: row.reference.mu, "", 3, _SHOWN),
    Column("repeatability_expanded", "repeatability", lambda row: row.point and row.point.expanded, "", 3, _SHOWN),
    Column("centre", "centre", lambda row: row.chart and row.chart.centre, "", 3),
    Column("limit_low", "lower limit", lambda row: row.chart and row.chart.low, "", 3, _SHOWN),
    Column("limit_high", "upper limit", lambda row: row.chart and row.chart.high, "", 3, _SHOWN),
    Column("within", "inside", lambda row: row.within),
    Column("verdict", "verdict", lambda row: row.verdict, views=_SHOWN, stored=False),
    Column("change_percent", "change", lambda row: row.change(0), "%", 1),
    Column("change_low_percent", "change at least", lambda row: row.change(1), "%", 1),
    Column("change_high_percent", "change at most", lambda row: row.change(2), "%", 1),
    Column("change_over_m", "over", lambda row: row.drift and row.drift.over_m, "m", 0),
    Column("told_apart", "told apart", lambda row: row.drift and row.drift.apart),
)


@dataclass(frozen=True, slots=True)
class SettingRow:
    """A measurement of a setting, and its difference from the setting's first."""

    info: ConditionInfo
    setting: RepeatedSetting
    measurement: SettingMeasurement
    from_first: Difference

    @property
    def one_piece(self) -> bool:
        """Return whether it was made on the piece of the setting's first measurement."""
        return self.measurement.piece == self.setting.first.piece

    @property
    def stands_out(self) -> bool | None:
        """Return whether it is the most deviant; None where the setting agrees, or was not judged."""
        agreed = self.setting.found
        if agreed is None or agreed.kept or agreed.outstanding is None:
            return None
        return agreed.measurements[agreed.outstanding] is self.measurement


def settings_table(results: RunResults) -> Table[SettingRow]:
    """Return a row for each measurement of a setting measured several times.

    ``difference`` is that from the setting's first measurement, with its expanded uncertainty (95 %) ``u_difference``;
    chi2 and its limit are the setting's, the same in its rows.
    """
    piece = Column[SettingRow](piece_key(results.worn), results.worn, lambda row: row.measurement.piece or None)
    axes: Iterator[Column[SettingRow]] = (axis_column(axis, lambda row: row.info) for axis in results.axes)
    return Table[SettingRow]((*_WHICH_SETTING, *axes, piece, *_OF_SETTING), tuple(_setting_rows(results)))


def _setting_rows(results: RunResults) -> Iterator[SettingRow]:
    infos = {condition.info.condition: condition.info for condition in results.conditions()}
    for setting in results.settings:
        for measurement in setting.measurements:
            off = Difference() if measurement is setting.first else difference_of(setting.first, measurement)
            yield SettingRow(infos[measurement.condition], setting, measurement, off)


def _agreed(row: SettingRow, name: str) -> Value:
    """Return a figure of the setting's test; None where it was not tested."""
    return getattr(row.setting.found, name, None)


_WHICH_SETTING: Final[tuple[Column[SettingRow], ...]] = (
    Column("condition", "condition", lambda row: row.measurement.condition, "", 0),
    Column("compound", "compound", lambda row: row.info.compound),
)
_OF_SETTING: Final[tuple[Column[SettingRow], ...]] = (
    Column("mu", "mu", lambda row: row.measurement.mu, "", 3),
    Column("difference", "difference from the first", lambda row: row.from_first.value, "", 3),
    Column("u_difference", "U of the difference", lambda row: row.from_first.expanded, "", 3),
    Column("one_piece", "on one piece", lambda row: row.one_piece),
    Column("chi2", "chi-squared", lambda row: _agreed(row, "chi2"), "", 1),
    Column("chi2_limit", "limit", lambda row: _agreed(row, "limit"), "", 1),
    Column("agrees", "agrees", lambda row: _agreed(row, "kept")),
    Column("stands_out", "stands out most", lambda row: row.stands_out),
)
