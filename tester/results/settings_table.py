"""The table of settings that a run measures several times: a row for each measurement, beside its setting's verdict."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tester.analysis.difference import Difference
from tester.analysis.repeated_settings import SettingMeasurement, difference_of
from tester.results.columns import Column, Table, Value, axis_column, piece_key
from tester.results.run_results import RunResults
from tester.results.settings_compared import RepeatedSetting
from tester.store.records import ConditionInfo


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
    return Table[SettingRow]((*_WHICH, *axes, piece, *_FOUND), tuple(_rows(results)))


def _rows(results: RunResults) -> Iterator[SettingRow]:
    infos = {condition.info.condition: condition.info for condition in results.conditions()}
    for setting in results.settings:
        for measurement in setting.measurements:
            off = Difference() if measurement is setting.first else difference_of(setting.first, measurement)
            yield SettingRow(infos[measurement.condition], setting, measurement, off)


def _agreed(row: SettingRow, name: str) -> Value:
    """Return a figure of the setting's test; None where it was not tested."""
    return getattr(row.setting.found, name, None)


_WHICH: Final[tuple[Column[SettingRow], ...]] = (
    Column("condition", "condition", lambda row: row.measurement.condition, "", 0),
    Column("compound", "compound", lambda row: row.info.compound),
)
_FOUND: Final[tuple[Column[SettingRow], ...]] = (
    Column("mu", "mu", lambda row: row.measurement.mu, "", 3),
    Column("difference", "difference from the first", lambda row: row.from_first.value, "", 3),
    Column("u_difference", "U of the difference", lambda row: row.from_first.expanded, "", 3),
    Column("one_piece", "on one piece", lambda row: row.one_piece),
    Column("chi2", "chi-squared", lambda row: _agreed(row, "chi2"), "", 1),
    Column("chi2_limit", "limit", lambda row: _agreed(row, "limit"), "", 1),
    Column("agrees", "agrees", lambda row: _agreed(row, "kept")),
    Column("stands_out", "stands out most", lambda row: row.stands_out),
)
