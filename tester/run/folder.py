"""A run's folder: what lies where in it, and what of it a process needs that carries out a part."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import fsum
from pathlib import Path

from tester.base import clock
from tester.inputs.recipe.estimate import Estimate
from tester.inputs.recipe.plan import Plan
from tester.inputs.recipe.schema import Recipe
from tester.inputs.rig import Rig
from tester.machine.results import condition_records
from tester.machine.run_parts import Part
from tester.machine.served import History
from tester.machine.time_left import Earlier, PartTime
from tester.run.endings import CannotStartError
from tester.run.kinds import checked_recipe, load_rig_text, recipe_part, run_parts
from tester.run.set_up import GoodRun
from tester.store.disk import write_text
from tester.store.records import RunInfo, SpecimenInfo
from tester.store.resume import ResumePoint
from tester.store.writer import RunWriter

PARTS = "parts"
"""Folder of the parts' records, each a run folder by its number, until they are merged."""

Begin = Callable[[RunWriter], None]
"""Tells a record what is going to be done."""


@dataclass(frozen=True, slots=True)
class Job:
    """A run as plain data: what a process that carries out a part of it needs besides the folder's files."""

    folder: Path
    seed: int = 0
    lapse: float | None = None
    """Rig seconds per second of wall time; None: as fast as it goes."""
    bus_log: Path | None = None
    samples: bool = True
    """Whether samples are kept."""
    faults: tuple[str, ...] = ()
    """Lines of a fault script (sim.faults.language), beside those of the rig file."""
    history: History | None = None
    """What earlier runs make known of the rig, None for nothing: the same for every part."""
    good: GoodRun | None = field(default=None, compare=False)
    """The last good run on the rig, with whose parameters those read while connecting are compared."""


@dataclass(frozen=True, slots=True)
class Work:
    """What is to be done: rig, plan, and the plan's parts; ``point`` is where an interrupted run goes on."""

    rig: Rig
    plan: Plan
    parts: tuple[Part, ...]
    point: ResumePoint | None = None

    def folder_of(self, part: Part, folder: Path) -> Path:
        """Return where a part's record lies: the run's own folder where it is the only one."""
        return folder if len(self.parts) == 1 else folder / PARTS / str(part.number)


def work_of(recipe: Recipe, rig: Rig) -> Work:
    """Return the work that a recipe is on a rig."""
    plan = recipe_part(rig).expand(recipe, rig)
    return Work(rig, plan, run_parts(rig).split(plan) if rig.simulated else (Part(1, plan),))


def part_time(rig: Rig, plan: Plan, expected: Estimate | None = None) -> PartTime:
    """Return what a part is expected to take; ``expected``: of its plan, where that is known already."""
    found = expected or recipe_part(rig).estimate(plan, rig)
    seconds = tuple(one.seconds for one in found.steps)
    return PartTime(plan, seconds, max(found.rig_seconds - fsum(seconds), 0.0))


def parts_time(work: Work, expected: Estimate | None = None) -> list[PartTime]:
    """Return what each part of a run is expected to take; ``expected``: of the whole plan, where that is known."""
    whole = expected if len(work.parts) == 1 else None
    return [part_time(work.rig, part.plan, whole) for part in work.parts]


def earlier_of(point: ResumePoint | None) -> Earlier:
    """Return what earlier stretches of a run have done, for its count."""
    if point is None:
        return Earlier()
    repeats = {number: len(condition.results) for number, condition in point.conditions.items()}
    return Earlier(point.origin_s, point.stand.ended, repeats)


def write_sources(folder: Path, recipe_text: str, rig: Rig) -> None:
    """Write recipe and rig file, as they are used, into the run's folder."""
    write_text(folder / "recipe.yaml", recipe_text)
    write_text(folder / "rig.yaml", rig.text)


def read_work(folder: Path) -> Work:
    """Return the work of a run's folder; raises InvalidSource where its files are not as they were written."""
    rig = load_rig_text(folder / "rig.yaml")
    return work_of(checked_recipe(folder / "recipe.yaml", rig).recipe, rig)


def make_folder(out: Path, name: str) -> Path:
    """Create the run's folder, ``<date>T<time>-<slug>``; a second run within the second gets a number."""
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
    raise CannotStartError(f"{out} holds a thousand runs of this second")


def specimens_of(plan: Plan) -> list[SpecimenInfo]:
    """Return a plan's specimens as the store keeps them."""
    return [SpecimenInfo(one.index, one.compound, one.note) for one in plan.specimens]


def beginning_of(part: Part, job: Job, work: Work) -> Begin:
    """Return what begins a part's own record. Texts and provenance are in the run's, into which it is merged."""

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
