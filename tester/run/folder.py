"""A run's folder: its layout, and what a process needs from it to run a part."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import fsum
from pathlib import Path

from tester.base import clock
from tester.inputs.recipe.plan import Plan
from tester.inputs.recipe.recipe_schema import Recipe
from tester.inputs.recipe.time_estimate import Estimate
from tester.inputs.rig import Rig
from tester.machine.result_keeping import condition_records
from tester.machine.run_parts import History, Part
from tester.machine.time_left import Earlier, PartTime
from tester.run.endings import CannotStartError
from tester.run.kind_lookup import checked_recipe, load_rig_text, recipe_part, run_parts
from tester.run.run_materials import law_copies
from tester.run.set_up import GoodRun
from tester.store.disk import write_text
from tester.store.record_schema import StoreError
from tester.store.records import RunInfo, SpecimenInfo
from tester.store.resumable import ResumePoint
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter

PARTS = "parts"
"""Folder of the parts' records until they are merged; each part has a numbered run folder in it."""

Begin = Callable[[RunWriter], None]
"""Function that begins a record with the planned work."""


@dataclass(frozen=True, slots=True)
class Job:
    """A run as plain data: what a process needs to run a part, in addition to the files in the folder."""

    folder: Path
    seed: int = 0
    lapse: float | None = None
    """Rig seconds per second of wall time; None: as fast as possible."""
    bus_log: Path | None = None
    samples: bool = True
    """Whether samples are stored."""
    faults: tuple[str, ...] = ()
    """Lines of a fault script (sim.faults.language), in addition to the rig file's."""
    history: History | None = None
    """Facts about the rig from earlier runs, the same for every part; None if there are none."""
    good: GoodRun | None = field(default=None, compare=False)
    """The last good run on the rig, for comparison with the parameters read while connecting."""
    leaps: bool = True
    """Whether a simulated rig leaps time in which only heat flows."""
    hands: str = ""
    """HOST:PORT of the console of a simulated machine in another process; "" if nothing is asked of one."""


@dataclass(frozen=True, slots=True)
class Work:
    """The work of a run: rig, plan, and the plan's parts. ``point``: where an interrupted run resumes."""

    rig: Rig
    plan: Plan
    parts: tuple[Part, ...]
    point: ResumePoint | None = None

    def folder_of(self, part: Part, folder: Path) -> Path:
        """Return the folder of a part's record: the run's own folder if it is the only part."""
        return folder if len(self.parts) == 1 else folder / PARTS / str(part.number)


def work_of(recipe: Recipe, rig: Rig) -> Work:
    """Return the work of a recipe on a rig."""
    plan = recipe_part(rig).expand(recipe, rig)
    return Work(rig, plan, run_parts(rig).split(plan) if rig.simulated else (Part(1, plan),))


def part_time(rig: Rig, plan: Plan, expected: Estimate | None = None) -> PartTime:
    """Return a part's expected duration; ``expected``: the estimate of its plan, if already known."""
    estimate = expected or recipe_part(rig).estimate(plan, rig)
    seconds = tuple(step.seconds for step in estimate.steps)
    return PartTime(plan, seconds, max(estimate.rig_seconds - fsum(seconds), 0.0))


def parts_time(work: Work, expected: Estimate | None = None) -> list[PartTime]:
    """Return the expected duration of each part of a run; ``expected``: the estimate of the whole plan, if known."""
    whole = expected if len(work.parts) == 1 else None
    return [part_time(work.rig, part.plan, whole) for part in work.parts]


def earlier_of(point: ResumePoint | None) -> Earlier:
    """Return what earlier stretches of a run completed, from which the count of its steps continues."""
    if point is None:
        return Earlier()
    repeats = {number: len(condition.results) for number, condition in point.conditions.items()}
    return Earlier(point.origin_s, point.stand.ended, repeats)


def write_sources(folder: Path, recipe_text: str, rig: Rig) -> None:
    """Write the recipe and rig file of the run into its folder."""
    write_text(folder / "recipe.yaml", recipe_text)
    write_text(folder / "rig.yaml", rig.text)


def read_work(folder: Path) -> Work:
    """Return the work in a run's folder; raises InvalidSource if its files are no longer valid."""
    rig = load_rig_text(folder / "rig.yaml", _law_copies(folder))
    return work_of(checked_recipe(folder / "recipe.yaml", rig).recipe, rig)


def _law_copies(folder: Path) -> dict[str, str]:
    """Return the copies of kept laws that the run's record lists, none before it has begun."""
    try:
        with RunReader(folder) as reader:
            return law_copies(folder, reader.run().info.materials)
    except StoreError:
        return {}


def make_folder(out: Path, name: str) -> Path:
    """Create the run's folder, ``<date>T<time>-<slug>``; a second run in the same second has a number added."""
    slug = re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")[:40] or "run"
    base = f"{clock.local_stamp()}-{slug}"
    out.mkdir(parents=True, exist_ok=True)
    for number in range(1, 1000):
        folder = out / (base if number == 1 else f"{base}-{number}")
        try:
            folder.mkdir()
        except FileExistsError:
            continue
        return folder
    raise CannotStartError(f"{out} holds a thousand runs started in this second")


def specimens_of(plan: Plan) -> list[SpecimenInfo]:
    """Return a plan's specimens as records for the store."""
    return [SpecimenInfo(specimen.index, specimen.compound, specimen.note) for specimen in plan.specimens]


def beginning_of(part: Part, job: Job, work: Work) -> Begin:
    """Return the function that begins a part's record. Texts and provenance are only in the run's record, into which it
    is merged.
    """

    def begin(writer: RunWriter) -> None:
        info = RunInfo(
            name=f"{job.folder.name}, part {part.number}",
            recipe_name=work.plan.name,
            recipe_text="",
            rig_text="",
            started_utc=clock.utc_now(),
            simulated=work.rig.simulated,
            kind=work.plan.kind,
            axes=recipe_part(work.rig).axes,
            seed=job.seed,
        )
        writer.begin_run(info, specimens_of(part.plan), condition_records(part.plan))

    return begin
