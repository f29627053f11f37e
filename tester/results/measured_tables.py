"""Tables of what a run measured: repeats, mounted pieces, and checks of their diameters.

A repeat has its own coefficient, as measured, and the reason where it is in no mean; a piece its wear rate over all its
checks.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite
from typing import Final

from tester.analysis.directions import is_reversed
from tester.analysis.flags import flags_in
from tester.analysis.results import RepeatResult
from tester.analysis.wear_rate import WearCheck, WearRate
from tester.base.units import SHORE_A
from tester.base.words import duration
from tester.results.columns import Column, Output, Table, mean_column, piece_key, setting_columns
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured
from tester.store.records import PieceInfo, StoredRepeat

AS_ASKED: Final = "as asked"
REVERSED: Final = "reversed"
"""Directions of sliding."""


@dataclass(frozen=True, slots=True)
class CommittedRepeat:
    """A committed repeat, its last attempt, and its condition."""

    measured: Measured
    repeat: StoredRepeat

    @property
    def result(self) -> RepeatResult:
        """Return its result."""
        return self.repeat.result

    @property
    def exclusion(self) -> str:
        """Return why it is in no mean; "" where it is in one."""
        return self.measured.exclusion(self.repeat)

    @property
    def direction(self) -> str:
        """Return its direction of sliding."""
        turned = self.measured.info.both_directions and is_reversed(self.repeat.repeat)
        return REVERSED if turned else AS_ASKED


def repeats_table(results: RunResults) -> Table[CommittedRepeat]:
    """Return the table of all committed repeats, condition by condition."""
    which = (*_WHICH, Column[CommittedRepeat](piece_key(results.worn), results.worn, lambda row: row.repeat.piece))
    ways = (_DIRECTION,) if results.both_directions else ()
    columns: tuple[Column[CommittedRepeat], ...] = (
        *which,
        *setting_columns(
            results.axes, lambda row: row.measured.info, lambda row: row.measured.info.replicate,
            results.run.info.metadata, frozenset(),
        ),
        *_FOUND,
        *(mean_column(quantity, lambda row: row.result.means) for quantity in results.quantities.averaged),
        *ways,
    )
    rows = (CommittedRepeat(condition, repeat) for condition in results.conditions() for repeat in condition.repeats)
    return Table(columns, tuple(rows))


_SHOWN: Final = frozenset({Output.REPORT, Output.SCREEN})

_WHICH: tuple[Column[CommittedRepeat], ...] = (
    Column("condition", "condition", lambda row: row.repeat.condition),
    Column("repeat", "repeat", lambda row: row.repeat.repeat),
    Column("attempt", "attempt", lambda row: row.repeat.attempt),
)

_FOUND: tuple[Column[CommittedRepeat], ...] = (
    Column("status", "status", lambda row: row.result.status.value, views=_SHOWN),
    Column("reason", "reason", lambda row: row.result.reason),
    Column("flags", "flags", lambda row: tuple(flags_in(row.result.flags))),
    Column("in_mean", "in the mean", lambda row: not row.exclusion),
    Column("exclusion", "why it is in no mean", lambda row: row.exclusion, views=_SHOWN),
    Column("make_up", "make-up", lambda row: row.repeat in row.measured.make_ups),
    Column("mu_as_measured", "mu as measured", lambda row: row.result.mu_resultant, "", 3, _SHOWN),
    Column("mu_longitudinal_as_measured", "mu along as measured", lambda row: row.result.mu_longitudinal, "", 3),
    Column("mu_lateral_as_measured", "mu across as measured", lambda row: row.result.mu_lateral, "", 3),
    Column("u_window", "u of the window", lambda row: row.result.uncertainty, "", 4),
    Column("fluctuation_percent", "fluctuation", lambda row: row.result.fluctuation_percent, "%", 2),
    Column("drift_percent", "drift", lambda row: row.result.drift_percent, "%", 2),
    Column("drift_bound_percent", "drift bound", lambda row: row.result.bound_percent, "%", 2),
    Column("change_percent", "change at once", lambda row: row.result.change_percent, "%", 2),
    Column("swing_percent", "swing", lambda row: row.result.swing_percent, "%", 1),
    Column("swing_hz", "swing at", lambda row: row.result.swing_hz, "Hz", 1),
    Column("swing_skewness", "skewness of the swing", lambda row: row.result.swing_skewness, "", 2),
    Column("revolutions", "revolutions", lambda row: row.result.revolutions, "", 0),
    Column("truncated_revolutions", "revolutions left out", lambda row: row.result.truncated, "", 0),
    Column("window_s", "window", lambda row: row.result.window_s, "s", 1),
    Column("bursts", "bursts", lambda row: row.result.bursts, "", 0),
    Column("started_s", "began at", lambda row: row.result.started_s, "s", 0),
    Column("ended_s", "ended at", lambda row: row.result.ended_s, "s", 0),
)

_DIRECTION: Column[CommittedRepeat] = Column("direction", "direction", lambda row: row.direction)


@dataclass(frozen=True, slots=True)
class PieceRow:
    """A mounted piece by number, and its wear."""

    piece: PieceInfo
    wear: WearRate


def pieces_table(results: RunResults) -> Table[PieceRow]:
    """Return a row for each mounted piece: its identity, diameters and wear rate (95 % interval), and its hardness if
    the run asked for one.
    """
    number = Column[PieceRow](piece_key(results.worn), results.worn, lambda row: row.piece.piece, "", 0, _REPORT)
    rows = (PieceRow(piece, results.wear_of(piece.piece)) for piece in results.pieces)
    read = any(isfinite(piece.hardness_shore_a) for piece in results.pieces)
    return Table((number, *_PIECE, *(_HARDNESS if read else ())), tuple(rows))


def checks_table(results: RunResults) -> Table[WearCheck]:
    """Return a row for each check of a diameter; ``before`` and ``after`` are conditions, empty where there is none."""
    number = Column[WearCheck](piece_key(results.worn), results.worn, lambda row: row.piece)
    return Table((number, *map(_of_check, _CHECK)), results.checks)


def _of_check(name: str) -> Column[WearCheck]:
    optional = name in ("before", "after")
    return Column(name, name, lambda row: (getattr(row, name) or None) if optional else getattr(row, name))


_CHECK: Final = tuple(field.name for field in fields(WearCheck) if field.name != "piece")
_REPORT: Final = frozenset({Output.REPORT})

_PIECE: tuple[Column[PieceRow], ...] = (
    Column("specimen", "specimen", lambda row: row.piece.specimen),
    Column("replicate", "replicate", lambda row: row.piece.replicate, "", 0, _REPORT),
    Column("compound", "compound", lambda row: row.piece.compound, views=_REPORT),
    Column("installed_diameter_mm", "diameter installed", lambda row: row.piece.installed_diameter_mm, "mm", 3,
           _REPORT),
    Column("diameter_mm", "diameter at the end", lambda row: row.piece.diameter_mm, "mm", 3, _REPORT),
    Column("sliding_m", "slid", lambda row: row.piece.sliding_m, "m", 0, _REPORT),
    Column("mounted_at", "mounted at", lambda row: duration(row.piece.installed_s), views=_REPORT, stored=False),
    Column("checks", "checks", lambda row: row.wear.checks, "", 0),
    Column("wear_mm3_n_m", "wear", lambda row: row.wear.rate, "mm3/(N m)", digits=3),
    Column("wear_u_standard", "u wear", lambda row: row.wear.standard, "mm3/(N m)", digits=2),
    Column("wear_u_expanded", "U wear", lambda row: row.wear.expanded, "mm3/(N m)", digits=2),
)  # fmt: skip

_HARDNESS: tuple[Column[PieceRow], ...] = (
    Column("hardness_shore_a", "hardness", lambda row: row.piece.hardness_shore_a, SHORE_A, 1, _REPORT),
    Column("hardness_by", "read by", lambda row: row.piece.hardness_by, views=_REPORT),
    Column("hardness_utc", "read at", lambda row: row.piece.hardness_utc),
)
