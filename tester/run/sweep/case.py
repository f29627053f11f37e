"""One run of a sweep. It runs in any process, and returns plain data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.analysis.results import WITH_CARE, ConditionStatus
from tester.base.axes import Setpoint
from tester.base.trouble import in_words
from tester.machine.context import Progress
from tester.machine.time_left import RunPosition
from tester.results.conditions_table import ConditionRow, conditions_table, recipe_rows, sweep_columns
from tester.results.run_results import results_of
from tester.results.table_cells import Cell
from tester.run.pool import stop_level
from tester.run.reporter import ReportScreen
from tester.run.run_materials import KeptFile, write_materials
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader

NAN = float("nan")
NOT_RUN = "not run"
"""Outcome of a case that raised an error or whose process was lost."""


@dataclass(frozen=True, slots=True)
class SweepTask:
    """One run as texts, so that it can be sent to another machine.

    ``case`` counts from 1: all seeds of the first point, then those of the next.
    """

    case: int
    point: tuple[str, ...]
    seed: int
    recipe_text: str
    rig_text: str
    materials: tuple[KeptFile, ...] = ()
    """Files of the recipe's compounds and surface, and of the kept law of the rig."""


@dataclass(frozen=True, slots=True)
class RowResult:
    """One row of the recipe's table: its nominal setpoints, and its cells in the table of conditions, by key."""

    row: int
    setpoint: Setpoint
    cells: Mapping[str, Cell]

    @property
    def ok(self) -> bool:
        """Whether the row has a trustworthy value."""
        return self.cells["status"] == ConditionStatus.OK

    @property
    def with_care(self) -> bool:
        """Whether the row's value carries a doubt."""
        return self.cells["mark"] == WITH_CARE

    def number(self, key: str) -> float:
        """Return a number of the row if its value is trustworthy; else NaN."""
        value = self.cells[key]
        return value if self.ok and isinstance(value, int | float) else NAN


@dataclass(frozen=True, slots=True)
class CaseResult:
    """How one run ended.

    The exit code is that of ``tester run``. Rig time is in s. The other fields give how often a specimen was mounted,
    and the rows of the run's table.
    """

    case: int
    point: tuple[str, ...]
    seed: int
    outcome: str
    reason: str
    exit_code: int
    rig_seconds: float = NAN
    mounted: int = 0
    rows: tuple[RowResult, ...] = ()

    @property
    def missing(self) -> int:
        """Number of rows without a trustworthy value."""
        return sum(not row.ok for row in self.rows)

    @property
    def with_care(self) -> int:
        """Number of rows whose value carries a doubt."""
        return sum(row.with_care for row in self.rows)


def run_case(task: SweepTask) -> CaseResult:
    """Run a recipe on a simulated rig as ``tester run --yes`` does, in a temporary folder."""
    with TemporaryDirectory(prefix="sweep-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        recipe, rig = folder / "recipe.yaml", folder / "rig.yaml"
        recipe.write_text(task.recipe_text, encoding="utf-8", newline="\n")
        rig.write_text(task.rig_text, encoding="utf-8", newline="\n")
        write_materials(folder, task.materials)
        screen = Unseen()
        options = SessionOptions(str(recipe), str(rig), out=folder / "runs", seed=task.seed, samples=False)
        session = screen.session = Session(options, screen)
        code = session.run()
        if session.folder is None or session.ending is None:
            return CaseResult(task.case, task.point, task.seed, NOT_RUN, " ".join(screen.messages), code)
        ending = session.ending
        with RunReader(session.folder) as reader:
            results = results_of(reader)
            mounted = len(reader.pieces())
        rows = tuple(_row(row) for row in recipe_rows(conditions_table(results)).rows)
        rig_s = results.run.rig_seconds
        return CaseResult(
            task.case, task.point, task.seed, ending.outcome.value, ending.reason, code, rig_s, mounted, rows
        )


def not_run(task: SweepTask, error: BaseException) -> CaseResult:
    """Return the result of a case that raised an error."""
    reason = f"{type(error).__name__}: {in_words(error)}".strip(": ")
    return CaseResult(task.case, task.point, task.seed, NOT_RUN, reason, 1)


def _row(row: ConditionRow) -> RowResult:
    return RowResult(row.info.row, row.info.setpoint, {column.key: column.cell(row) for column in sweep_columns()})


class Unseen(ReportScreen):
    """A screen without output; it forwards a stop of the pool to the session."""

    answer_yes = True

    def __init__(self) -> None:
        self.session: Session | None = None
        self.messages: list[str] = []

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Forward a stop of the sweep to the session."""
        level = stop_level()
        if level and self.session is not None:
            self.session.stop(level)

    def message(self, text: str) -> None:
        """Keep the message, in case the run does not begin."""
        self.messages.append(text)
