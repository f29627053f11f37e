"""The folder of a sweep: results are written as they arrive, and sorted at the end."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from itertools import chain
from pathlib import Path
from typing import TextIO

from tester.base.axes import Axes
from tester.results.run_files import write_file
from tester.results.table_cells import encode, line
from tester.run.sweep import sweep_tables
from tester.run.sweep.case import CaseResult
from tester.run.sweep.grid import SweepAxis

RUNS, CONDITIONS, SUMMARY, TOTALS = "runs.csv", "conditions.csv", "summary.csv", "totals.csv"


class SweepFiles:
    """Writes results as they arrive; ``finish`` sorts them and adds the statistics.

    Raises OSError.
    """

    def __init__(self, folder: Path, axes: Sequence[SweepAxis], condition_axes: Axes, worn: str) -> None:
        """Create ``runs.csv`` and ``conditions.csv`` in ``folder``.

        ``condition_axes``: the axes of the recipe's conditions; ``worn``: name of the part that wears, in the headers.
        """
        self.folder = folder
        self.axes = axes
        self.condition_axes = condition_axes
        self.worn = worn
        self.results: list[CaseResult] = []
        self._runs = _begin(folder / RUNS, sweep_tables.run_header(axes, worn))
        self._conditions = _begin(folder / CONDITIONS, sweep_tables.condition_header(axes, condition_axes))

    def add(self, result: CaseResult) -> None:
        """Write a run's result; it is in the files when this returns."""
        self.results.append(result)
        _append(self._runs, [sweep_tables.run_row(result)])
        _append(self._conditions, sweep_tables.condition_rows(result))

    def finish(self) -> None:
        """Write every table in order, so that the files do not depend on the order in which results arrived."""
        results, axes = sorted(self.results, key=sweep_tables.case_of), self.axes
        self._runs.close()
        self._conditions.close()
        runs = (sweep_tables.run_row(result) for result in results)
        conditions = chain.from_iterable(sweep_tables.condition_rows(result) for result in results)
        for name, header, rows in (
            (RUNS, sweep_tables.run_header(axes, self.worn), runs),
            (CONDITIONS, sweep_tables.condition_header(axes, self.condition_axes), conditions),
            (SUMMARY, sweep_tables.summary_header(axes, self.condition_axes), sweep_tables.summary_rows(results)),
            (TOTALS, sweep_tables.totals_header(axes, self.worn), sweep_tables.totals_rows(results)),
        ):
            write_file(self.folder / name, encode(chain([header], rows)))


def write_sources(
    folder: Path, recipe_text: str, rig_text: str, axes: Sequence[SweepAxis], first_seed: int, seeds: int
) -> None:
    """Write the sources of a sweep: recipe, rig file before any value is set, seeds and values."""
    (folder / "recipe.yaml").write_text(recipe_text, encoding="utf-8", newline="\n")
    (folder / "rig.yaml").write_text(rig_text, encoding="utf-8", newline="\n")
    record = {"first_seed": first_seed, "seeds": seeds, "set": {axis.key: list(axis.values) for axis in axes}}
    text = json.dumps(record, indent=1, ensure_ascii=False) + "\n"
    (folder / "sweep.json").write_text(text, encoding="utf-8", newline="\n")


def _begin(path: Path, header: sweep_tables.Row) -> TextIO:
    file = path.open("w", encoding="utf-8", newline="\n")
    _append(file, [header])
    return file


def _append(file: TextIO, rows: Iterable[sweep_tables.Row]) -> None:
    file.writelines(line(row) for row in rows)
    file.flush()
