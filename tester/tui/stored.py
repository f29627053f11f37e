"""A stored run as the Results screen shows it. Reading takes long enough to be done in a thread."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from tester.analysis.flags import FLAGS, flags_in
from tester.base.axes import Axes, Axis, ListWords, Setpoint, condition_words
from tester.base.quantities import GATE
from tester.results.columns import Output, Table
from tester.results.conditions_table import ConditionRow, axis_keys, conditions_table
from tester.results.repeats_table import repeats_table
from tester.results.run_results import RunResults, results_of
from tester.results.tally import flag_words, tally_of
from tester.store.catalogue import find_run
from tester.store.reader import RunReader
from tester.store.records import StoredExclusion
from tester.tui.plot import OTHER, SERIES, Bin, Point


@dataclass(frozen=True, slots=True)
class Row:
    """One condition: cells of ``Stored.header``, what is held, mu (None: none), its number in the store."""

    cells: tuple[str, ...]
    held: Setpoint
    compound: str
    mu: float | None
    condition: int
    mark: str = ""
    """Of mu (tester.analysis.results): "" where it is trusted."""
    figures: str = ""
    """What the columns behind the setpoints say, with their headings."""
    flags: tuple[str, ...] = ()
    """What each of its flags means, and what to do about it."""


@dataclass(frozen=True, slots=True)
class RepeatRow:
    """One repeat of a condition: number, coefficient, status, why it is not in the mean, its trace of mu."""

    repeat: int
    figures: str
    """Its coefficient with its heading."""
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
    header: tuple[str, ...]
    """The paper's axes, one for each further axis that is off its default, and the columns that a screen shows; what
    all rows share is in ``common`` instead where there are more axes than the paper's."""
    common: str
    rows: tuple[Row, ...]
    axes: Axes
    record_head: str = ""
    """Of the chain over the run's record; "" where there is none."""
    conditions: int = 0
    """Of the recipe, without references; replicates of one are one."""
    values: int = 0
    """Of these, those with a value to be trusted."""

    @property
    def plotted(self) -> tuple[Axis, ...]:
        """What the coefficient can be plotted against: the paper's axes, and others that differ here."""
        more = self.axes.differing(row.held for row in self.rows)
        shown = (one for one in self.axes if not one.choices and (one.paper or one in more))
        return tuple(sorted(shown, key=lambda one: one.plotted))


def read(name: str, runs: Path) -> Stored:
    """Read a run's conditions; raises StoreError, OSError, sqlite3.Error."""
    folder = find_run(name, runs)
    with RunReader(folder) as reader:
        results = results_of(reader)
    return stored_of(folder, results)


def stored_of(folder: Path, results: RunResults) -> Stored:
    """Return a run's table."""
    conditions = list(results.conditions())
    held = [measured.info.setpoint for measured in conditions]
    shown, common = results.axes.columns(held), ""
    if len(held) > 1 and any(not one.paper for one in shown):
        # A narrow screen has room for the axes that differ; what all conditions share is told once, above.
        words = ListWords(held)
        shown, common = words.axes, words.common
    table = conditions_table(results)
    table = table.of(one for one in table.rows if one.measured is not None)
    view = table.view(Output.SCREEN, axis_keys(shown))
    header = tuple(one.narrow_head for one in view.columns)
    rows = tuple(_row(one, view) for one in table.rows)
    run = results.run
    if run.info.risk:
        common = f"RISK ACCEPTED: {run.info.risk}{'; ' + common if common else ''}"
    status, head, tally = results.status.value, results.record_head, tally_of(results)
    return Stored(folder.name, folder, run.info.recipe_name, status, header, common, rows, results.axes, head,
                  tally.conditions, tally.valued)  # fmt: skip


def _row(one: ConditionRow, view: Table[ConditionRow]) -> Row:
    """Return a condition with its cells of ``view``."""
    held, result = one.info.setpoint, one.result
    figures = "  ".join(
        f"{column.heading} {column.text(one)} {column.unit}".rstrip()
        for column in view.columns
        if Output.SCREEN in column.views
    )
    mu = result.mu if isfinite(result.mu) else None
    flags = tuple(flag_words(FLAGS[word]) for word in flags_in(result.flags) if word in FLAGS)
    cells = tuple(column.text(one) for column in view.columns)
    return Row(cells, held, held.compound, mu, one.info.condition, one.mark, figures, flags)


def condition(folder: Path, number: int, columns: int) -> tuple[Row, tuple[RepeatRow, ...]]:
    """Read a condition and its repeats with traces of ``columns`` columns; raises StoreError, sqlite3.Error."""
    with RunReader(folder) as reader:
        results = results_of(reader)
        conditions, repeats = conditions_table(results), repeats_table(results)
        row = next(one for one in conditions.rows if one.measured is not None and one.info.condition == number)
        mu = repeats["mu_as_measured"]
        return _row(row, conditions.view(Output.SCREEN)), tuple(
            RepeatRow(
                one.repeat.repeat,
                f"{mu.heading} {mu.text(one)}",
                one.result.status.value,
                one.exclusion,
                _who(one.measured.left_out_by(one.repeat)),
                _trace(reader, number, one.repeat.repeat, columns),
            )
            for one in repeats.rows
            if one.measured is row.measured
        )


def _who(word: StoredExclusion | None) -> str:
    return f"{word.operator or 'somebody'}, {word.utc[:16].replace('T', ' ')} UTC" if word is not None else ""


def _trace(reader: RunReader, condition: int, repeat: int, columns: int) -> tuple[Bin | None, ...]:
    """Return the accepted samples' coefficient, least and greatest in each column."""
    import numpy as np

    found, roles = reader.samples(condition, repeat), reader.quantities().roles
    accepted = (found[GATE] == 0) & (found[roles.normal] > 0.0)
    force = np.hypot.reduce([found[name][accepted] for name in roles.friction], initial=0.0)
    mu = force / found[roles.normal][accepted]
    if not len(mu):
        return ()
    pieces = np.array_split(mu, min(columns, len(mu)))
    return tuple((float(piece.min()), float(piece.max())) for piece in pieces)


def row_words(row: Row) -> str:
    """Return a condition's setpoints in words."""
    return condition_words(row.held)


def series(stored: Stored, row: Row, along: Axis) -> list[Row]:
    """Return the conditions with a value that differ from ``row`` along one axis at most."""

    def others(one: Row) -> tuple[object, ...]:
        return one.compound, *(other.of(one.held) for other in one.held.axes if other.name != along.name)

    return [one for one in stored.rows if one.mu is not None and others(one) == others(row)]


def points(stored: Stored, along: Axis, chosen: Row | None = None) -> list[Point]:
    """Return the conditions as points of mu against an axis; the sign is the compound's first letter or digit.

    Where a ``chosen`` row has a series along the axis, that is drawn as ``●`` and everything else as ``·``.
    """
    marked = series(stored, chosen, along) if chosen is not None else []

    def own(row: Row) -> str:
        return _sign(row) if len(marked) < 2 else SERIES

    return [
        Point(along.number(row.held), row.mu, OTHER if len(marked) > 1 and row not in marked else row.mark or own(row))
        for row in stored.rows
        if row.mu is not None
    ]


def _sign(row: Row) -> str:
    return next((c for c in row.compound if c.isalnum() and c.isascii()), "o")
