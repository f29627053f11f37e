"""A sweep: its tasks, the order of arrivals, and its files after any end."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.kinds import hardware_text
from tester.run.sweep import sweep as module
from tester.run.sweep.case import CaseResult, SweepTask, run_case
from tester.run.sweep.grid import axes_of
from tester.run.sweep.sweep import NotSimulatedError, Sweep, SweepOptions, carry_out, local, prepare_sweep
from tests.tester.inputs.kept_laws.kept_example import example_text
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.sweep.results import result, row

QUICK = SHORT.replace("14 rev", "7 rev")


class Audience:
    """An audience that may cancel."""

    def __init__(self, enough: int = 0) -> None:
        self.enough = enough
        self.cases: list[int] = []

    def begin(self, folder: Path, runs: int) -> None:
        self.folder, self.runs = folder, runs

    def ran(self, result: CaseResult, done: int) -> None:
        self.cases.append(result.case)
        assert done == len(self.cases)
        with (self.folder / "runs.csv").open(encoding="utf-8") as file:
            assert len(list(csv.reader(file))) == 1 + done  # it is in the file before it is reported
        if done == self.enough:
            raise KeyboardInterrupt


def at_once(result_of: Callable[[SweepTask], CaseResult]) -> Callable[..., Future[CaseResult]]:
    """Return an executor's submit with immediate results."""

    def submit(work: object, task: SweepTask, /) -> Future[CaseResult]:
        future: Future[CaseResult] = Future()
        try:
            future.set_result(result_of(task))
        except RuntimeError as error:
            future.set_exception(error)
        return future

    return submit


def sweep_of(home: Path, *axes: str, seeds: int = 2, first_seed: int = 0, rig: str = "sim") -> Sweep:
    recipe = home / "short.yaml"
    recipe.write_text(QUICK, encoding="utf-8")
    return prepare_sweep(SweepOptions(str(recipe), rig, axes_of(axes), seeds, first_seed, home / "sweeps"))


def rows_of(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_tasks_are_point_after_point_and_seed_after_seed(tmp_path: Path) -> None:
    tasks = sweep_of(tmp_path, "sim.noise=0,1", seeds=2, first_seed=5).tasks
    assert [(t.case, t.point, t.seed) for t in tasks] == [
        (1, ("0",), 5),
        (2, ("0",), 6),
        (3, ("1",), 5),
        (4, ("1",), 6),
    ]
    assert tasks[0].rig_text != tasks[2].rig_text and tasks[0].recipe_text == QUICK


def test_a_value_that_the_rig_file_refuses_is_named_before_anything_runs(tmp_path: Path) -> None:
    with pytest.raises(InvalidSource, match=r"sim\.noise=loud"):
        sweep_of(tmp_path, "sim.noise=0,loud")


def test_a_kept_law_goes_with_its_task(tmp_path: Path) -> None:
    law = tmp_path / "law.yaml"
    law.write_text(example_text(compound="1#"), encoding="utf-8")
    (task,) = sweep_of(tmp_path, f"sim.friction_model={law}", seeds=1).tasks
    law.unlink()
    found = run_case(task)
    assert (found.exit_code, found.missing) == (0, 0)


def test_a_real_rig_is_refused(tmp_path: Path) -> None:
    (tmp_path / "real.yaml").write_text(hardware_text(), encoding="utf-8")
    with pytest.raises(NotSimulatedError, match="this one is real"):
        sweep_of(tmp_path, rig=str(tmp_path / "real.yaml"))


def test_the_folder_records_the_swept_axes(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, "sim.noise=0,1", seeds=3, first_seed=7)
    folder, code = carry_out(sweep, at_once(lambda task: result(task.case, row(), point=task.point)), Audience())
    assert code == 0 and (folder / "recipe.yaml").read_text(encoding="utf-8") == QUICK
    said = json.loads((folder / "sweep.json").read_text(encoding="utf-8"))
    assert said == {"first_seed": 7, "seeds": 3, "set": {"sim.noise": ["0", "1"]}}


def test_a_run_that_ends_badly_is_a_row_and_the_sweep_is_incomplete(tmp_path: Path) -> None:
    def outcome(task: SweepTask) -> CaseResult:
        return result(task.case, row(), outcome="tripped" if task.seed == 1 else "done")

    folder, code = carry_out(sweep_of(tmp_path, seeds=3), at_once(outcome), Audience())
    assert code == 6 and [r["outcome"] for r in rows_of(folder, "runs.csv")] == ["done", "tripped", "done"]


def test_a_run_that_raises_is_a_row_with_the_reason(tmp_path: Path) -> None:
    def outcome(task: SweepTask) -> CaseResult:
        if task.seed == 0:
            raise RuntimeError("out of wheels")
        return result(task.case, row())

    folder, code = carry_out(sweep_of(tmp_path), at_once(outcome), Audience())
    first, second = rows_of(folder, "runs.csv")
    assert code == 6 and (first["outcome"], first["reason"]) == ("not run", "RuntimeError: out of wheels")
    assert second["outcome"] == "done" and len(rows_of(folder, "conditions.csv")) == 1


def test_an_interrupt_keeps_the_results_so_far_in_order(tmp_path: Path) -> None:
    audience = Audience(enough=3)
    folder, code = carry_out(sweep_of(tmp_path, seeds=5), at_once(lambda task: result(task.case, row())), audience)
    assert code == 130 and len(audience.cases) == 3
    assert [int(r["seed"]) for r in rows_of(folder, "runs.csv")] == sorted(audience.cases)
    assert rows_of(folder, "summary.csv")[0]["runs"] == "3" and rows_of(folder, "totals.csv")[0]["done"] == "3"


def test_a_case_gives_the_results_of_tester_run_in_any_process(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, *QUIET, seeds=1)
    found = run_case(sweep.tasks[0])
    (one,) = found.rows
    assert (found.outcome, found.exit_code, found.mounted, found.missing) == ("done", 0, 1, 0)
    assert found.rig_seconds > 60.0 and one.number("mu") == pytest.approx(0.73, abs=0.01)
    held = one.setpoint
    assert (held.compound, held.value("slip_velocity"), held.value("load"), one.cells["valid"]) == ("1#", 0.3, 200.0, 1)
    with local(1) as submit:
        there = submit(run_case, sweep.tasks[0]).result()
    assert repr(there) == repr(found)  # not-a-number is not equal to itself


def test_the_order_of_arrival_does_not_show_in_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def files(name: str) -> dict[str, bytes]:
        (tmp_path / name).mkdir()
        sweep = sweep_of(tmp_path / name, "sim.scatter=0,1", seeds=3)
        audience = Audience()
        folder, _ = carry_out(sweep, at_once(lambda task: result(task.case, row(), point=task.point)), audience)
        arrived.append(audience.cases)
        return {path.name: path.read_bytes() for path in folder.iterdir()}

    arrived: list[list[int]] = []
    monkeypatch.setattr(module, "as_completed", lambda futures: list(futures))
    first = files("first")
    monkeypatch.setattr(module, "as_completed", lambda futures: list(futures)[::-1])
    assert files("second") == first
    assert arrived == [[1, 2, 3, 4, 5, 6], [6, 5, 4, 3, 2, 1]]
