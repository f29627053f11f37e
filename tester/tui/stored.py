"""A stored run as the Results screen shows it. Reading takes long enough to be done in a thread."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from tester.analysis.trust import mark_of
from tester.export.cells import nominal
from tester.export.results import Measured, RunResults, results_of
from tester.store.catalogue import find_run
from tester.store.reader import RunReader
from tester.store.records import StoredExclusion
from tester.tui.plot import OTHER, SERIES, Bin, Point

AXES = (
    ("load", "N"),
    ("slip", "mm/s"),
    ("temperature", "°C"),
    ("sideslip", "°"),
)
"""What the coefficient is plotted against, in turn."""
HEADER = ("Formula", "Slip mm/s", "Load N", "Angle °", "Temp °C", "mu", "s", "n", "Status")
"""The export's columns, and s and n."""


@dataclass(frozen=True, slots=True)
class Row:
    """One condition: cells of HEADER, the values of AXES, mu (None: none), its number in the store."""

    cells: tuple[str, ...]
    at: tuple[float, ...]
    compound: str
    mu: float | None
    condition: int
    mark: str = ""
    """Of mu (tester.analysis.trust): "" where it is trusted."""


@dataclass(frozen=True, slots=True)
class RepeatRow:
    """One repeat of a condition: number, coefficient, status, why it is not in the mean, its trace of mu."""

    repeat: int
    mu: float | None
    status: str
    exclusion: str
    by_hand: str
    """Who has left it out, and when; "" where nobody has."""
    trace: tuple[Bin | None, ...]


@dataclass(frozen=True, slots=True)
class Stored:
    """A run's table."""

    name: str
    folder: Path
    recipe: str
    status: str
    rows: tuple[Row, ...]


def read(name: str, runs: Path) -> Stored:
    """Read a run's conditions; raises StoreError, OSError, sqlite3.Error."""
    folder = find_run(name, runs)
    with RunReader(folder) as reader:
        results = results_of(reader)
    return Stored(folder.name, folder, results.run.info.recipe_name, results.status.value, tuple(_rows(results)))


def _rows(results: RunResults) -> list[Row]:
    return [_row(measured) for measured in results.conditions()]


def _row(measured: Measured) -> Row:
    i, r = measured.info, measured.result
    at = (i.load_n, 1e3 * i.slip_velocity_m_s, i.temperature_c, i.sideslip_deg)
    setpoints = (nominal(at[1]), nominal(at[0]), nominal(at[3]), nominal(at[2]))
    mark = mark_of(r.status, r.flags) if isfinite(r.mu_resultant) else ""
    found = (_number(r.mu_resultant, 3) + mark, _number(r.s, 4), f"{r.n_valid}/{r.n}")
    status = f"{r.status.value}{': ' + r.reason if r.reason else ''} {r.flags}".strip()
    mu = r.mu_resultant if isfinite(r.mu_resultant) else None
    return Row((i.compound, *map(str, setpoints), *found, status), at, i.compound, mu, i.condition, mark)


def _number(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if isfinite(value) else "—"


def condition(folder: Path, number: int, columns: int) -> tuple[Row, tuple[RepeatRow, ...]]:
    """Read a condition and its repeats with traces of ``columns`` columns; raises StoreError, sqlite3.Error."""
    with RunReader(folder) as reader:
        measured = next(one for one in results_of(reader).conditions() if one.info.condition == number)
        return _row(measured), tuple(
            RepeatRow(
                one.repeat,
                one.result.mu_resultant if isfinite(one.result.mu_resultant) else None,
                one.result.status.value,
                measured.exclusion(one),
                _who(measured.left_out_by(one)),
                _trace(reader, number, one.repeat, columns),
            )
            for one in measured.repeats
        )


def _who(word: StoredExclusion | None) -> str:
    return f"{word.operator or 'somebody'}, {word.utc[:16].replace('T', ' ')} UTC" if word is not None else ""


def _trace(reader: RunReader, condition: int, repeat: int, columns: int) -> tuple[Bin | None, ...]:
    """Return the accepted samples' coefficient, least and greatest in each column."""
    import numpy as np

    found = reader.samples(condition, repeat)
    accepted = (found["gate"] == 0) & (found["force_z_n"] > 0.0)
    force = np.hypot(found["force_x_n"][accepted], found["force_y_n"][accepted])
    mu = force / found["force_z_n"][accepted]
    if not len(mu):
        return ()
    pieces = np.array_split(mu, min(columns, len(mu)))
    return tuple((float(piece.min()), float(piece.max())) for piece in pieces)


def row_words(row: Row) -> str:
    """Return a condition's setpoints in words."""
    load_n, slip_mm_s, temperature_c, sideslip_deg = row.at
    return f"{row.compound}: {slip_mm_s:g} mm/s, {load_n:g} N, {sideslip_deg:g}°, {temperature_c:g} °C"


def series(stored: Stored, row: Row, axis: int) -> list[Row]:
    """Return the conditions with a value that differ from ``row`` along one axis at most."""

    def others(one: Row) -> tuple[object, ...]:
        return one.compound, *one.at[:axis], *one.at[axis + 1 :]

    return [one for one in stored.rows if one.mu is not None and others(one) == others(row)]


def points(stored: Stored, axis: int, chosen: Row | None = None) -> list[Point]:
    """Return the conditions as points of mu against an axis; the sign is the compound's first letter or digit.

    Where a ``chosen`` row has a series along the axis, that is drawn as ``●`` and everything else as ``·``.
    """
    marked = series(stored, chosen, axis) if chosen is not None else []

    def own(row: Row) -> str:
        return _sign(row) if len(marked) < 2 else SERIES

    return [
        Point(row.at[axis], row.mu, OTHER if len(marked) > 1 and row not in marked else row.mark or own(row))
        for row in stored.rows
        if row.mu is not None
    ]


def _sign(row: Row) -> str:
    return next((c for c in row.compound if c.isalnum() and c.isascii()), "o")
