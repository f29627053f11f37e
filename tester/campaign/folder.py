"""A run's folder: what lies where in it, and what the store is told at the beginning."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from tester import clock
from tester.campaign.split import Part, split
from tester.engine.results import condition_records
from tester.recipe.check import load_checked
from tester.recipe.expand import expand
from tester.recipe.loader import LoadedRecipe
from tester.recipe.plan import Plan
from tester.rig import RigConfig, load_rig
from tester.store.recorder import Recorder
from tester.store.records import RunInfo, SpecimenInfo

PARTS = "parts"
"""Folder of the parts' records, each a run folder by its number; gone once merged, with nothing left to do."""

SHOWN_VERSIONS = ("friction-tester", "numpy", "pymodbus", "python-can", "pydantic")
"""Distributions whose versions are stored with a run."""


class CannotStartError(Exception):
    """The run cannot begin; the message says why."""


@dataclass(frozen=True, slots=True)
class Job:
    """A run as plain data: what a process that carries out a part of it needs besides the folder's files."""

    folder: Path
    seed: int = 0
    lapse: float | None = None
    """Rig seconds per second of wall time; None: as fast as it goes."""
    bus_log: Path | None = None
    operator: str = ""
    samples: bool = True
    """Whether samples are kept."""


@dataclass(frozen=True, slots=True)
class Work:
    """What is to be done: rig, recipe, plan, and the plan's parts."""

    rig: RigConfig
    recipe: LoadedRecipe
    plan: Plan
    parts: tuple[Part, ...]

    def folder_of(self, part: Part, folder: Path) -> Path:
        """Return where a part's record lies: the run's own folder where it is the only one."""
        return folder if len(self.parts) == 1 else folder / PARTS / str(part.number)


def prepare(recipe: LoadedRecipe, rig: RigConfig) -> Work:
    """Return the work that a recipe is on a rig."""
    plan = expand(recipe.recipe, rig)
    return Work(rig, recipe, plan, split(plan, simulated=rig.simulated))


def write_sources(work: Work, folder: Path) -> None:
    """Write recipe and rig file, as they are used, into the run's folder."""
    (folder / "recipe.yaml").write_text(work.recipe.tree.text, encoding="utf-8", newline="\n")
    (folder / "rig.yaml").write_text(work.rig.text, encoding="utf-8", newline="\n")


def read_work(folder: Path) -> Work:
    """Return the work of a run's folder; raises InvalidSource where its files are not as they were written."""
    rig = load_rig(folder / "rig.yaml")
    return prepare(load_checked(folder / "recipe.yaml", rig), rig)


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


def begin_record(recorder: Recorder, work: Work, plan: Plan, job: Job, name: str) -> None:
    """Tell a record what is going to be done: ``plan`` is the whole one or a part's."""
    used = {step.specimen for step in plan.conditions()}
    specimens = [one for one in plan.specimens if one.index in used or plan is work.plan]
    recorder.begin_run(
        run_info(name, work, seed=job.seed, operator=job.operator),
        [SpecimenInfo(one.index, one.compound, one.note) for one in specimens],
        condition_records(plan),
    )


def run_info(name: str, work: Work, *, seed: int, operator: str = "") -> RunInfo:
    """Return what the store keeps of a run's beginning."""
    return RunInfo(
        name=name,
        recipe_name=work.plan.name,
        recipe_text=work.recipe.tree.text,
        rig_text=work.rig.text,
        started_utc=clock.utc_now(),
        simulated=work.rig.simulated,
        seed=seed if work.rig.simulated else None,
        software_version=_version("friction-tester"),
        operator=operator,
        metadata=dict(work.plan.metadata),
        versions={package: _version(package) for package in SHOWN_VERSIONS},
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "unknown"
