"""A sweep from the outside: its points and seeds, its runs wherever they are carried out, its folder, its exit code."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from recipes import find
from tester.campaign.endings import EXIT_INCOMPLETE, EXIT_INTERRUPTED
from tester.campaign.folder import make_folder
from tester.recipe.check import load_checked
from tester.rig import load_rig
from tester.sweep.case import CaseResult, Task, not_run, run_case
from tester.sweep.executors import Submit
from tester.sweep.files import SweepFiles, write_sources
from tester.sweep.grid import Axis, overrides_of, points_of

EXIT_DONE = 0


class Audience(Protocol):
    """Who is told how a sweep goes."""

    def begin(self, folder: Path, runs: int) -> None:
        """Hear that a sweep of so many runs has begun."""
        ...

    def ran(self, result: CaseResult, done: int) -> None:
        """Hear of a run's result; ``done`` runs are over now."""
        ...


class NotSimulatedError(Exception):
    """A sweep is for simulated rigs; the message says which rig is none."""


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """What is asked for."""

    recipe: str
    rig: str = "sim"
    axes: tuple[Axis, ...] = ()
    seeds: int = 1
    first_seed: int = 0
    out: Path = Path("sweeps")


@dataclass(frozen=True, slots=True)
class Sweep:
    """A sweep that is ready to be carried out: its tasks in order, and the texts they come from."""

    options: SweepOptions
    name: str
    recipe_text: str
    rig_text: str
    tasks: tuple[Task, ...]


def prepare_sweep(options: SweepOptions) -> Sweep:
    """Check the recipe on the rig of every point; return the sweep.

    Raises InvalidSource, FileNotFoundError, NotSimulatedError.
    """
    path = find(options.recipe)
    plain = load_rig(options.rig)
    if not plain.simulated:
        raise NotSimulatedError(f"--rig {options.rig}: a sweep is for simulated rigs, and this one is real")
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    tasks: list[Task] = []
    name = recipe_text = ""
    for point in points_of(options.axes):
        rig = load_rig(options.rig, overrides_of(options.axes, point))
        recipe = load_checked(path, rig)
        name, recipe_text, rig_text = recipe.recipe.recipe, recipe.tree.text, rig.text
        tasks += [Task(len(tasks) + i, point, seed, recipe_text, rig_text) for i, seed in enumerate(seeds, start=1)]
    return Sweep(options, name, recipe_text, plain.text, tuple(tasks))


def carry_out(sweep: Sweep, submit: Submit, audience: Audience) -> tuple[Path, int]:
    """Run every task; return the sweep's folder and its exit code.

    0: every run was done and gave every value; 6: not so; 130: interrupted, with the results that were there by then.
    Raises OSError where the folder cannot be written.
    """
    options = sweep.options
    folder = make_folder(options.out, sweep.name)
    write_sources(folder, sweep.recipe_text, sweep.rig_text, options.axes, options.first_seed, options.seeds)
    files = SweepFiles(folder, options.axes)
    audience.begin(folder, len(sweep.tasks))
    code = EXIT_DONE
    try:
        for result in _results(sweep.tasks, submit):
            files.add(result)
            audience.ran(result, len(files.results))
            if result.exit_code != EXIT_DONE:
                code = EXIT_INCOMPLETE
    except KeyboardInterrupt:
        code = EXIT_INTERRUPTED
    finally:
        files.finish()
    return folder, code


def _results(tasks: Sequence[Task], submit: Submit) -> Iterator[CaseResult]:
    """Yield results as they come; a run that raises is a result, too."""
    futures: dict[Future[CaseResult], Task] = {submit(run_case, task): task for task in tasks}
    for future in as_completed(futures):
        error = future.exception()
        yield future.result() if error is None else not_run(futures[future], error)
