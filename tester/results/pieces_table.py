"""The tables of mounted pieces: each with its wear rate over all its checks, and every check of a diameter."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final

from tester.analysis.wear_rate import WearCheck, WearRate
from tester.base.words import duration
from tester.results.columns import Column, Output, Table, piece_key
from tester.results.run_results import RunResults
from tester.store.records import PieceInfo


@dataclass(frozen=True, slots=True)
class PieceRow:
    """A mounted piece by number, and its wear."""

    piece: PieceInfo
    wear: WearRate


def pieces_table(results: RunResults) -> Table[PieceRow]:
    """Return a row for each mounted piece: its identity, diameters and wear rate (95 % interval)."""
    number = Column[PieceRow](piece_key(results.worn), results.worn, lambda row: row.piece.piece, "", 0, _SHOWN)
    rows = (PieceRow(piece, results.wear_of(piece.piece)) for piece in results.pieces)
    return Table((number, *_PIECE), tuple(rows))


def checks_table(results: RunResults) -> Table[WearCheck]:
    """Return a row for each check of a diameter; ``before`` and ``after`` are conditions, empty where there is none."""
    number = Column[WearCheck](piece_key(results.worn), results.worn, lambda row: row.piece)
    return Table((number, *map(_of_check, _CHECK)), results.checks)


def _of_check(name: str) -> Column[WearCheck]:
    optional = name in ("before", "after")
    return Column(name, name, lambda row: (getattr(row, name) or None) if optional else getattr(row, name))


_CHECK: Final = tuple(field.name for field in fields(WearCheck) if field.name != "piece")
_SHOWN: Final = frozenset({Output.REPORT})

_PIECE: tuple[Column[PieceRow], ...] = (
    Column("specimen", "specimen", lambda row: row.piece.specimen),
    Column("replicate", "replicate", lambda row: row.piece.replicate, "", 0, _SHOWN),
    Column("compound", "compound", lambda row: row.piece.compound, views=_SHOWN),
    Column("installed_diameter_mm", "diameter installed", lambda row: row.piece.installed_diameter_mm, "mm", 3, _SHOWN),
    Column("diameter_mm", "diameter at the end", lambda row: row.piece.diameter_mm, "mm", 3, _SHOWN),
    Column("sliding_m", "slid", lambda row: row.piece.sliding_m, "m", 0, _SHOWN),
    Column("mounted_at", "mounted at", lambda row: duration(row.piece.installed_s), views=_SHOWN, stored=False),
    Column("checks", "checks", lambda row: row.wear.checks, "", 0),
    Column("wear_mm3_n_m", "wear", lambda row: row.wear.rate, "mm3/(N m)", digits=3),
    Column("wear_u_standard", "u wear", lambda row: row.wear.standard, "mm3/(N m)", digits=2),
    Column("wear_u_expanded", "U wear", lambda row: row.wear.expanded, "mm3/(N m)", digits=2),
)
