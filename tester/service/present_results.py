"""The results of a run as its clients see them while it is under way, worked out from its record."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from typing import Any

from pydantic import JsonValue, TypeAdapter

from tester.base.axes import condition_words
from tester.base.trouble import TroubleError, in_words
from tester.results.columns import Table
from tester.results.conditions_table import ConditionRow, conditions_table, value_words
from tester.results.run_results import RunResults, results_of
from tester.results.so_far import OpenRepeat, growth, open_repeat
from tester.run.folder import PARTS
from tester.service.asked_process import RefusedQuestionError
from tester.service.results_view import ConditionValue, GivenResults, GrowingView, GrownValue, OpenValue
from tester.store.record_file import DATABASE
from tester.store.run_folders import under_way
from tester.store.run_reader import RunReader

VIEW: TypeAdapter[GivenResults] = TypeAdapter(GivenResults)
_STATE = (
    "SELECT (SELECT count(*) FROM repeat WHERE status NOT IN ('open', 'void')) AS repeats,"
    " (SELECT count(*) FROM condition WHERE started_s IS NOT NULL) AS begun,"
    " (SELECT count(*) FROM condition WHERE status <> 'not measured') AS ended,"
    " (SELECT count(*) FROM exclusion) AS decisions, (SELECT status FROM run) AS status"
)


class PresentResults:
    """The results of the run that was asked for last: conditions are reduced anew only once a repeat, a condition or a
    person's decision is new on record.
    """

    def __init__(self, runs: Path) -> None:
        """``runs``: folder of the runs."""
        self._runs = runs
        self._kept: dict[Path, tuple[object, RunResults]] = {}

    def answer(self, run: JsonValue) -> JsonValue:
        """Return the results of a run, as ``GivenResults``. Raises RefusedQuestionError."""
        folder = self._runs / str(run)
        if not isinstance(run, str) or Path(run).name != run or not (folder / DATABASE).is_file():
            raise RefusedQuestionError("no such run")
        running = under_way(folder) is not None
        # The parts of a simulated run have records of their own until the run's end.
        parts = sorted((folder / PARTS).glob(f"*/{DATABASE}"), key=lambda record: record.parent.name)
        try:
            views = [self._view(part.parent, run, running=running) for part in parts or [folder / DATABASE]]
        except (TroubleError, OSError, sqlite3.Error) as error:
            raise RefusedQuestionError(in_words(error)) from error
        values = {value.condition: value for view in views for value in view.conditions}
        growing = next((view.growing for view in reversed(views) if view.growing is not None), None)
        whole = GivenResults(run, tuple(values[number] for number in sorted(values)), growing, not running)
        return VIEW.dump_python(whole, mode="json")

    def _view(self, folder: Path, run: str, *, running: bool) -> GivenResults:
        with RunReader(folder) as reader:
            state = (running, *(tuple(row.items()) for row in reader.rows(_STATE)))
            kept = self._kept.get(folder)
            if kept is None or kept[0] != state:
                self._kept = {place: found for place, found in self._kept.items() if run in place.parts}
                kept = self._kept[folder] = state, results_of(reader)
            return results_view(reader, kept[1], run, running=running)


def results_view(reader: RunReader, results: RunResults, run: str, *, running: bool) -> GivenResults:
    """Return the results of a run of some name as its record shows them now; ``running``: whether a process works on
    it. Raises StoreError.
    """
    table = conditions_table(results)
    rows = [row for row in table.rows if row.measured is not None and row.measured.begun]
    values = [_value(row, table) for row in rows]
    values.sort(key=lambda value: value.condition)
    present = next((row for row in rows if row.measured is not None and row.measured.condition.status is None), None)
    growing = grown_view(reader, results, table, present) if running and present is not None else None
    return GivenResults(run, tuple(values), growing, not running)


def grown_view(
    reader: RunReader, results: RunResults, table: Table[ConditionRow], row: ConditionRow
) -> GrowingView:
    """Return how a condition, a row of ``table``, has grown. Raises StoreError."""
    grown = tuple(
        GrownValue(
            len(one.measured.repeats) if one.measured is not None else 0, _number(table, "mu", one),
            _number(table, "u_expanded", one), value_words(table, one),
        )
        for one in growth(reader, results, row)
    )  # fmt: skip
    return GrowingView(
        row.info.condition, condition_words(row.info.setpoint), row.info.repeats_planned, grown,
        _open(open_repeat(reader), row.info.condition),
    )  # fmt: skip


def _value(row: ConditionRow, table: Table[ConditionRow]) -> ConditionValue:
    return ConditionValue(
        row.info.condition, _number(table, "mu", row), _number(table, "u_expanded", row), value_words(table, row),
        ", ".join(row.result.doubts), row.measured is not None and row.measured.condition.status is not None,
    )  # fmt: skip


def _number(table: Table[ConditionRow], key: str, row: ConditionRow) -> Any:
    return table[key].as_json(row)


def _open(repeat: OpenRepeat | None, condition: int) -> OpenValue | None:
    if repeat is None or repeat.condition != condition:
        return None
    return OpenValue(repeat.repeat, repeat.mu, repeat.revolutions)
