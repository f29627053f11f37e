"""Runs a sweep from start to finish: points and seeds, runs in processes here or on a cluster, folder, exit code."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import Future, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from recipes import find
from tester.base.axes import Axes
from tester.base.plugins import needs
from tester.base.processes import EXIT_DONE, EXIT_INCOMPLETE, EXIT_INTERRUPTED
from tester.base.trouble import MisuseError, in_words
from tester.run.folder import make_folder
from tester.run.kind_lookup import checked_recipe, load_rig, served_kind
from tester.run.pool import WorkerPool
from tester.run.run_materials import kept_files, law_file, used_materials
from tester.run.sweep.case import CaseResult, SweepTask, not_run, run_case
from tester.run.sweep.grid import SweepAxis, overrides_of, points_of
from tester.run.sweep.sweep_files import SweepFiles, write_sources


class NoClusterError(MisuseError):
    """The cluster is not usable; the message gives the reason."""


Submit: TypeAlias = Callable[[Callable[[SweepTask], CaseResult], SweepTask], Future[CaseResult]]
"""Starts a task, and returns the future of its result."""


class Audience(Protocol):
    """Receives the progress of a sweep."""

    def begin(self, folder: Path, runs: int) -> None:
        """Called when a sweep of ``runs`` runs has begun."""
        ...

    def ran(self, result: CaseResult, done: int) -> None:
        """Called with a run's result; ``done``: the number of runs that have ended."""
        ...


class NotSimulatedError(MisuseError):
    """A sweep needs simulated rigs; the message names the real rig."""


@dataclass(frozen=True, slots=True)
class SweepOptions:
    """Options of a sweep."""

    recipe: str
    rig: str = "sim"
    axes: tuple[SweepAxis, ...] = ()
    seeds: int = 1
    first_seed: int = 0
    out: Path = Path("sweeps")


@dataclass(frozen=True, slots=True)
class Sweep:
    """A sweep ready to run: its tasks in order, and the texts from which they are made."""

    options: SweepOptions
    name: str
    recipe_text: str
    rig_text: str
    condition_axes: Axes
    """Axes of the recipe's conditions."""
    worn: str
    """Name for people of the part of the machine that wears."""
    tasks: tuple[SweepTask, ...]


def prepare_sweep(options: SweepOptions) -> Sweep:
    """Check the recipe on the rig of every point; return the sweep.

    Raises InvalidSource, FileNotFoundError, NotSimulatedError.
    """
    path = find(options.recipe)
    plain = load_rig(options.rig)
    if not plain.simulated:
        raise NotSimulatedError(f"--rig {options.rig}: a sweep is for simulated rigs, and this one is real")
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    tasks: list[SweepTask] = []
    name = recipe_text = ""
    axes: Axes | None = None
    for point in points_of(options.axes):
        rig = load_rig(options.rig, overrides_of(options.axes, point))
        recipe = checked_recipe(path, rig)
        name, recipe_text, rig_text = recipe.recipe.recipe, recipe.tree.text, rig.text
        axes = recipe.recipe.axes
        materials = kept_files([*used_materials(recipe.recipe, path).files, *law_file(rig)])
        for stored in (file.stored for file in materials if file.stored.role == "law"):
            rig_text = rig_text.replace(stored.source, stored.file)  # its copy beside the rig file, on any machine
        tasks += [
            SweepTask(len(tasks) + i, point, seed, recipe_text, rig_text, materials)
            for i, seed in enumerate(seeds, start=1)
        ]
    assert axes is not None  # a sweep has at least one point, even without axes
    worn = served_kind(plain).machine.specimen
    return Sweep(options, name, recipe_text, plain.text, axes, worn, tuple(tasks))


def carry_out(sweep: Sweep, submit: Submit, audience: Audience) -> tuple[Path, int]:
    """Run every task; return the sweep's folder and its exit code.

    0: every run completed with every value; 6: at least one did not; 130: interrupted, with the results up to then.
    Raises OSError if the folder cannot be written.
    """
    options = sweep.options
    folder = make_folder(options.out, sweep.name)
    write_sources(folder, sweep.recipe_text, sweep.rig_text, options.axes, options.first_seed, options.seeds)
    files = SweepFiles(folder, options.axes, sweep.condition_axes, sweep.worn)
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


def _results(tasks: Sequence[SweepTask], submit: Submit) -> Iterator[CaseResult]:
    """Yield results as they arrive; a run that raises an error also gives a result."""
    futures: dict[Future[CaseResult], SweepTask] = {submit(run_case, task): task for task in tasks}
    for future in as_completed(futures):
        error = future.exception()
        yield future.result() if error is None else not_run(futures[future], error)


@contextmanager
def local(jobs: int) -> Generator[Submit]:
    """Provide up to ``jobs`` processes of this machine; leaving the block ends the runs under way."""
    with WorkerPool(jobs) as pool:
        yield lambda work, task: pool.submit(work, task)


@contextmanager
def dask(address: str) -> Generator[Submit]:
    """Provide the cluster whose scheduler is at ``address``, e.g. ``tcp://host:8786``; its workers need this package.

    Leaving the block early drops waiting tasks; a task that a worker has begun runs to its end there. Raises
    NoClusterError.
    """
    try:
        distributed: Any = import_module("distributed")  # it has no types, and may not be installed
    except ImportError as error:
        raise NoClusterError(f"{needs(f'--dask {address}', 'Dask', 'cluster')} ({error})") from error
    try:
        client = distributed.Client(address, set_as_default=False)
    except (OSError, ValueError) as error:
        raise NoClusterError(f"--dask {address}: no scheduler answers there: {in_words(error)}") from error
    try:
        # Not pure: equal tasks run again. No retries: the loss of a worker counts as a result.
        yield client.get_executor(pure=False, retries=0).submit
    finally:
        client.close()
