"""A stored run as the Results screen shows it. Reading takes long enough to be done in a thread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from tester.analysis.repeats import ConditionResult
from tester.analysis.trust import mark_of
from tester.axes import Axes, Axis, ListWords, Setpoint, condition_words, plain
from tester.quantities import GATE
from tester.results.run_results import Measured, RunResults, results_of
from tester.store.catalogue import find_run
from tester.store.reader import RunReader
from tester.store.records import StoredExclusion
from tester.tui.plot import OTHER, SERIES, Bin, Point

FIGURES = ("mu", "s", "n", "Status")


@dataclass(frozen=True, slots=True)
class Row:
    """One condition: cells of ``Stored.header``, what is held, mu (None: none), its number in the store."""

    cells: tuple[str, ...]
    held: Setpoint
    compound: str
    mu: float | None
    condition: int
    mark: str = ""
    """Of mu (tester.analysis.trust): "" where it is trusted."""
    uncertainty: str = ""
    """Of mu, in two lines: both expanded ones, and mu at the temperature that was asked for; "" where there is none."""


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
    header: tuple[str, ...]
    """The paper's columns, one for each further axis that is off its default, mu, s, n, status; what all rows share is
    in ``common`` instead where there are more axes than the paper's."""
    common: str
    rows: tuple[Row, ...]
    axes: Axes
    record_head: str = ""
    """Of the chain over the run's record; "" where there is none."""

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
    header = ("Formula", *(one.title for one in shown), *FIGURES)
    rows = tuple(_row(measured, shown, results.worn) for measured in conditions)
    run = results.run
    if run.info.risk:
        common = f"RISK ACCEPTED: {run.info.risk}{'; ' + common if common else ''}"
    status, head = results.status.value, results.record_head
    return Stored(folder.name, folder, run.info.recipe_name, status, header, common, rows, results.axes, head)


def _row(measured: Measured, shown: Sequence[Axis], worn: str) -> Row:
    i, r = measured.info, measured.result
    setpoints = [plain(one.of(i.setpoint)) for one in shown]
    mark = mark_of(r.status, r.flags) if isfinite(r.mu_resultant) else ""
    found = (_number(r.mu_resultant, 3) + mark, _number(r.s, 4), f"{r.n_valid}/{r.n}")
    status = f"{r.status.value}{': ' + r.reason if r.reason else ''} {r.flags}".strip()
    mu = r.mu_resultant if isfinite(r.mu_resultant) else None
    cells = (i.compound, *setpoints, *found, status)
    return Row(cells, i.setpoint, i.compound, mu, i.condition, mark, _uncertainty(r, worn))


def _uncertainty(result: ConditionResult, worn: str) -> str:
    """Return the coefficient's two expanded uncertainties in words, and the coefficient at its own temperature."""
    this, compound = result.budget.expanded, result.compound_budget.expanded
    if not isfinite(this):
        return ""
    told = f"U (95 %) {this:.4f} of this {worn}, {_number(compound, 4)} of the compound"
    return f"{told}\nmu at the temperature asked for: {_number(result.mu_corrected, 4)}"


def _number(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}" if isfinite(value) else "—"


def condition(folder: Path, number: int, columns: int) -> tuple[Row, tuple[RepeatRow, ...]]:
    """Read a condition and its repeats with traces of ``columns`` columns; raises StoreError, sqlite3.Error."""
    with RunReader(folder) as reader:
        results = results_of(reader)
        measured = next(one for one in results.conditions() if one.info.condition == number)
        return _row(measured, (), results.worn), tuple(
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
