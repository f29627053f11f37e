"""A stored run for the Results screen. Reading it is slow enough to need a thread."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from tester.analysis.flags import FLAGS, flags_in
from tester.base.axes import Axes, Axis, ListWords, Setpoint, condition_words
from tester.base.quantities import GATE
from tester.results.columns import Output, Table
from tester.results.conditions_table import ConditionRow, axis_keys, conditions_table, value_words
from tester.results.measured_tables import repeats_table
from tester.results.run_results import RunResults, results_of
from tester.results.tally import flag_words, tally_of
from tester.store.journal_records import StoredExclusion
from tester.store.run_folders import find_run
from tester.store.run_reader import RunReader
from tester.tui.plot import OTHER, SERIES, Bin, Point


@dataclass(frozen=True, slots=True)
class Row:
    """One condition: its cells under ``Stored.header``, its setpoint, mu (None if it has none), its number in the
    store.
    """

    cells: tuple[str, ...]
    held: Setpoint
    compound: str
    mu: float | None
    condition: int
    mark: str = ""
    """Mark of mu (tester.analysis.trust); "" if mu is trustworthy."""
    u: float | None = None
    """Expanded uncertainty of mu of the mounted piece; None if it has none."""
    short: str = ""
    """mu with its mark, and U, as every table prints them: 0.707 ± 0.029."""
    figures: str = ""
    """Text of the columns after the setpoints, with their headings."""
    flags: tuple[str, ...] = ()
    """Meaning of each flag, and the remedy."""


@dataclass(frozen=True, slots=True)
class RepeatRow:
    """One repeat of a condition: number, coefficient, status, why it is excluded from the mean, its trace of mu."""

    repeat: int
    figures: str
    """The repeat's coefficient with its heading."""
    status: str
    exclusion: str
    by_hand: str
    """Who excluded the repeat, and when; "" unless a person excluded it."""
    trace: tuple[Bin | None, ...]


@dataclass(frozen=True, slots=True)
class Stored:
    """A run's table."""

    name: str
    folder: Path
    recipe: str
    status: str
    header: tuple[str, ...]
    """The paper's axes, further axes that differ from their default, and the columns for a screen. If there are more
    axes than the paper's, ``common`` contains the values that all rows share.
    """
    common: str
    rows: tuple[Row, ...]
    axes: Axes
    record_head: str = ""
    """Head of the hash chain over the run's record; "" if it has none."""
    conditions: int = 0
    """Number of the recipe's conditions, without references; replicates count once."""
    values: int = 0
    """Number of these conditions that have a trustworthy value."""

    @property
    def plotted(self) -> tuple[Axis, ...]:
        """Axes against which to plot the coefficient: the paper's, and others that differ between these conditions."""
        more = self.axes.differing(row.held for row in self.rows)
        shown = (axis for axis in self.axes if not axis.textual and (axis.paper or axis in more))
        return tuple(sorted(shown, key=lambda axis: axis.plotted))


def read(name: str, runs: Path) -> Stored:
    """Read a run's conditions; raises StoreError, OSError, sqlite3.Error."""
    folder = find_run(name, runs)
    with RunReader(folder) as reader:
        results = results_of(reader)
    return stored_of(folder, results)


def stored_of(folder: Path, results: RunResults) -> Stored:
    """Return a run's table."""
    conditions = list(results.conditions())
    setpoints = [measured.info.setpoint for measured in conditions]
    shown, common = results.axes.columns(setpoints), ""
    if len(setpoints) > 1 and any(not axis.paper for axis in shown):
        # A narrow screen has room only for the axes that differ; shared values are shown once, above the table.
        words = ListWords(setpoints)
        shown, common = words.axes, words.common
    table = conditions_table(results)
    table = table.of(row for row in table.rows if row.measured is not None)
    view = table.view(Output.SCREEN, axis_keys(shown))
    header = tuple(column.narrow_head for column in view.columns)
    rows = tuple(_row(row, view) for row in table.rows)
    run = results.run
    if run.info.risk:
        common = f"RISK ACCEPTED: {run.info.risk}{'; ' + common if common else ''}"
    status, head, tally = results.status.value, results.record_head, tally_of(results)
    return Stored(folder.name, folder, run.info.recipe_name, status, header, common, rows, results.axes, head,
                  tally.conditions, tally.valued)  # fmt: skip


def _row(one: ConditionRow, view: Table[ConditionRow]) -> Row:
    """Return a condition with its cells in ``view``."""
    setpoint, result = one.info.setpoint, one.result
    figures = "  ".join(
        f"{column.heading} {column.text(one)} {column.unit}".rstrip()
        for column in view.columns
        if Output.SCREEN in column.views
    )
    mu = result.mu if isfinite(result.mu) else None
    flags = tuple(flag_words(FLAGS[word]) for word in flags_in(result.flags) if word in FLAGS)
    cells = tuple(column.text(one) for column in view.columns)
    u = result.budget.expanded
    known_u, short = u if isfinite(u) else None, value_words(view, one)
    return Row(cells, setpoint, setpoint.compound, mu, one.info.condition, one.mark, known_u, short, figures, flags)


def condition(folder: Path, number: int, columns: int) -> tuple[Row, tuple[RepeatRow, ...]]:
    """Read a condition and its repeats, with traces of ``columns`` columns; raises StoreError, sqlite3.Error."""
    with RunReader(folder) as reader:
        results = results_of(reader)
        conditions, repeats = conditions_table(results), repeats_table(results)
        row = next(c for c in conditions.rows if c.measured is not None and c.info.condition == number)
        mu = repeats["mu_as_measured"]
        return _row(row, conditions.view(Output.SCREEN)), tuple(
            RepeatRow(
                measured.repeat.repeat,
                f"{mu.heading} {mu.text(measured)}",
                measured.result.status.value,
                measured.exclusion,
                _who(measured.measured.left_out_by(measured.repeat)),
                _trace(reader, number, measured.repeat.repeat, columns),
            )
            for measured in repeats.rows
            if measured.measured is row.measured
        )


def _who(word: StoredExclusion | None) -> str:
    return f"{word.operator or 'a person'}, {word.utc[:16].replace('T', ' ')} UTC" if word is not None else ""


def _trace(reader: RunReader, condition: int, repeat: int, columns: int) -> tuple[Bin | None, ...]:
    """Return the trace of the accepted samples: least and greatest coefficient in each column."""
    import numpy as np

    samples, roles = reader.samples(condition, repeat), reader.quantities().roles
    accepted = (samples[GATE] == 0) & (samples[roles.normal] > 0.0)
    force = np.hypot.reduce([samples[name][accepted] for name in roles.friction], initial=0.0)
    mu = force / samples[roles.normal][accepted]
    if not len(mu):
        return ()
    pieces = np.array_split(mu, min(columns, len(mu)))
    return tuple((float(piece.min()), float(piece.max())) for piece in pieces)


def row_words(row: Row) -> str:
    """Return a condition's setpoints in words."""
    return condition_words(row.held)


def series(stored: Stored, row: Row, along: Axis) -> list[Row]:
    """Return the conditions with a value that differ from ``row`` at most along this axis."""

    def others(r: Row) -> tuple[object, ...]:
        return r.compound, *(other.of(r.held) for other in r.held.axes if other.name != along.name)

    return [r for r in stored.rows if r.mu is not None and others(r) == others(row)]


def points(stored: Stored, along: Axis, chosen: Row | None = None) -> list[Point]:
    """Return the conditions as points of mu against an axis; the sign is the compound's first letter or digit.

    If a ``chosen`` row has a series along the axis, its points are ``●`` and all others ``·``,
    without their U.
    """
    marked = series(stored, chosen, along) if chosen is not None else []

    found: list[Point] = []
    for row in stored.rows:
        if row.mu is None:
            continue
        other = len(marked) > 1 and row not in marked
        sign = OTHER if other else row.mark or (_sign(row) if len(marked) < 2 else SERIES)
        found.append(Point(along.number(row.held), row.mu, sign, 0.0 if other or row.u is None else row.u))
    return found


def _sign(row: Row) -> str:
    return next((c for c in row.compound if c.isalnum() and c.isascii()), "o")
