"""Reads, checks and plans an item's recipe on the rig as it is now: when it is added, and again before it begins."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from datetime import date, datetime, timedelta
from hashlib import sha256
from pathlib import Path

import recipes
from tester.base import clock
from tester.base.lock import ExclusiveUse
from tester.base.screen import Check
from tester.base.source import InvalidSource
from tester.inputs.recipe.plan import Plan, PromptStep
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.time_estimate import Estimate
from tester.inputs.rig import Rig
from tester.inputs.rig.risks import counts_as_simulated
from tester.queue.decide import CALIBRATION, CEILINGS, DISK, FREE, RECIPE, RIG, SPECIMEN
from tester.queue.differences import differences
from tester.queue.items import Hashes, Needs, PersonAsk
from tester.queue.places import RIG_AS_ADDED, run_recipe
from tester.run.endings import CannotStartError
from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
from tester.run.preconditions import Prepared, enough_room, hold_rig, not_measured, prepared, warnings_before
from tester.run.provenance import calibration_of
from tester.run.reporter import ReportScreen
from tester.run.run_materials import UsedMaterials, kept_files, law_file, used_materials, write_materials
from tester.run.session_options import SessionOptions, check_faults, refusal
from tester.run.wall_time import price_s
from tester.store.disk import expected_bytes, write_text


@dataclass(frozen=True, slots=True)
class AssessTask:
    """An item to look at. ``folder``: the item's; ``runs``: the folder of the runs.

    ``text``: the recipe; "" when it is read from ``origin``, a file or the name of a packaged recipe. ``rig``,
    ``overrides``, ``accept_risk``: as for a run. ``then``: the hashes with which the item may run, None
    when it is added; ``known_rig`` and ``simulated``: its rig, "" when it is added.
    """

    folder: str
    runs: str
    rig: str
    origin: str = ""
    text: str = ""
    overrides: tuple[str, ...] = ()
    accept_risk: str = ""
    yes: bool = False
    speed: float | None = 1.0
    then: Hashes | None = None
    known_rig: str = ""
    simulated: bool = True
    copies: int = 1
    """Items that are added, each with a folder: ``folder``, whose name is the first one's number, and the next ones."""


@dataclass(frozen=True, slots=True)
class Assessment:
    """What was found. With ``problems`` the item cannot run, and the rest is empty.

    ``checks``: evidence that needs no connection to the rig. ``differs``: what changed since, in words.
    """

    problems: tuple[str, ...] = ()
    name: str = ""
    text: str = ""
    sha256: str = ""
    origin: str = ""
    rig: str = ""
    simulated: bool = True
    hashes: Hashes = field(default_factory=lambda: Hashes("", ""))
    needs: Needs = field(default_factory=lambda: Needs(0.0, 0.0, 0.0, 0, 0))
    checks: tuple[Check, ...] = ()
    differs: tuple[str, ...] = ()


class _AnsweringScreen(ReportScreen):
    """Stands for the service's screen in checks of a run's options."""

    can_ask = True

    def __init__(self, *, answer_yes: bool) -> None:
        self.answer_yes = answer_yes


def assess(task: AssessTask) -> Assessment:
    """Look at an item; every problem at once. Writes what its run reads into the item's folder. Raises OSError."""
    try:
        rig = load_rig(task.rig, task.overrides, task.accept_risk)
        text, origin = (task.text, task.origin) if task.text else _read(task.origin)
        found = _prepared(task, rig, text, origin)
    except InvalidSource as error:
        return Assessment(tuple(map(str, error.problems)))
    except (recipes.UnknownRecipe, CannotStartError) as error:
        return Assessment((str(error),))
    hashes = Hashes(_hash(rig.text), _hash(_calibration(rig)), tuple(_materials(found.materials)))
    needs = _needs(task, found, rig)
    differs: list[str] = []
    if task.then is None:
        first = Path(task.folder)
        for number in range(task.copies):
            folder = first.with_name(f"{int(first.name) + number}") if number else first
            folder.mkdir(parents=True, exist_ok=True)
            write_text(folder / RIG_AS_ADDED, rig.text)
    else:
        differs = differences(task.then, hashes, _kept_rig(Path(task.folder)), rig.text)
    return Assessment(
        (), found.work.plan.name, text, _hash(text), origin, rig.name, rig.simulated, hashes, needs,
        tuple(_checks(task, found, rig, needs, differs)), tuple(differs),
    )  # fmt: skip


def _read(origin: str) -> tuple[str, str]:
    """Return a recipe's text, and where it was read."""
    path = recipes.find(origin)
    packaged = path.parent == recipes.FOLDER and Path(origin) != path
    return path.read_text(encoding="utf-8"), origin if packaged else str(path.absolute())


def _prepared(task: AssessTask, rig: Rig, text: str, origin: str) -> Prepared:
    """Plan a recipe from the item's own folder, with the materials that its place has now."""
    file = run_recipe(Path(task.folder))
    shutil.rmtree(file.parent, ignore_errors=True)
    file.parent.mkdir(parents=True)
    write_text(file, text)
    loaded = checked_recipe(file, rig, origin or "the recipe")
    beside = file
    if origin:
        with suppress(recipes.UnknownRecipe):  # the file may be gone: its text is frozen, its materials are not
            beside = recipes.find(origin)
    used = used_materials(loaded.recipe, beside)
    write_materials(file.parent, kept_files(used.files))
    found = prepared(str(file), task.rig, task.overrides, task.accept_risk)
    return replace(found, materials=replace(used, files=(*used.files, *law_file(rig))))


def _needs(task: AssessTask, found: Prepared, rig: Rig) -> Needs:
    plan, expected = found.work.plan, found.expected
    seconds = expected.rig_seconds
    if rig.simulated and task.speed is None:  # as fast as this computer goes
        pace = price_s(expected, rig.kind, Path(task.runs)) / seconds if seconds else 1.0
    else:
        pace = 1.0 / task.speed if rig.simulated and task.speed else 1.0
    asks = () if task.yes and counts_as_simulated(rig) else tuple(_asks(plan, expected, recipe_part(rig), pace))
    return Needs(
        pace * seconds, pace * expected.rig_seconds_low, pace * expected.rig_seconds_high,
        sum(1 for _ in plan.conditions()), round(expected_bytes(plan, expected)), round(expected.loss_mm, 4),
        len(plan.specimens), asks,
    )  # fmt: skip


def _asks(plan: Plan, expected: Estimate, part: RecipePart, pace: float) -> Iterator[PersonAsk]:
    """Yield the questions of a plan: specimens to mount, and prompts."""
    at_s = 0.0
    for step, estimate in zip(plan.steps, expected.steps, strict=True):
        if words := part.heading(plan, step):
            yield PersonAsk(round(pace * at_s, 1), words)
        elif isinstance(step, PromptStep):
            yield PersonAsk(round(pace * at_s, 1), step.title)
        at_s += estimate.seconds


def _checks(task: AssessTask, found: Prepared, rig: Rig, needs: Needs, differs: list[str]) -> Iterator[Check]:
    recipe, runs = str(run_recipe(Path(task.folder))), Path(task.runs)
    options = SessionOptions(recipe, task.rig, task.overrides, task.accept_risk, runs, lapse=task.speed)
    same = not task.known_rig or (rig.name, rig.simulated) == (task.known_rig, task.simulated)
    here = f'rig "{rig.name}"{", simulated" if rig.simulated else ""}'
    there = f'the item was added for rig "{task.known_rig}"{", simulated" if task.simulated else ""}'
    yield Check(RIG, same, here if same else f"{here}; {there}")
    yield Check(SPECIMEN, *_specimen(found.work.plan, recipe_part(rig)))
    yield Check(RECIPE, not differs, "; ".join(differs) or "as it was added")
    yield Check(FREE, *_tried(lambda: _hold(rig)))
    yield Check(DISK, *_tried(lambda: enough_room(_existing(runs), found.work.plan, rig, found.expected)))
    yield Check(CALIBRATION, *_calibrated(rig, needs))
    yield Check(CEILINGS, *_tried(lambda: _ceilings(task, options, rig)))


def _tried(check: Callable[[], object]) -> tuple[bool, str]:
    """Return whether a precondition of a run holds, and the reason if not."""
    try:
        check()
    except (CannotStartError, OSError) as error:
        return False, str(error)
    return True, "as a run asks"


def _hold(rig: Rig) -> None:
    with ExclusiveUse() as use:
        hold_rig(use, rig, "the queue")


def _ceilings(task: AssessTask, options: SessionOptions, rig: Rig) -> None:
    if rig.faults:
        check_faults(rig.faults, rig)
    if refused := refusal(options, rig, _AnsweringScreen(answer_yes=task.yes)):
        raise CannotStartError(refused)
    not_measured(options, rig)


def _calibrated(rig: Rig, needs: Needs) -> tuple[bool, str]:
    """Return whether certificates are valid to the item's latest expected end, as the rig file asks."""
    if rig.simulated:
        return True, "simulated sensors need none"
    today = date.fromisoformat(clock.utc_now()[:10])
    end = (datetime.fromisoformat(clock.utc_now()) + timedelta(seconds=needs.high_s)).date()
    try:
        warnings = [*warnings_before(rig, today), *warnings_before(rig, end)]
    except CannotStartError as error:
        return False, str(error)
    return True, "; ".join(dict.fromkeys(warnings)) or "valid to the end of the item"


def _specimen(plan: Plan, part: RecipePart) -> tuple[bool, str]:
    """Return whether the specimen of every condition is known: the plan mounts it new, with its wear foreseen.

    Whether it is thick enough is a precondition of the plan, which mounts another one in time.
    """
    for step in plan.steps:
        if words := part.heading(plan, step):
            return True, f"it begins with {words}"
        if step.contact:
            break
    return False, "the plan mounts none, and that on the rig is not known to it"


def _existing(folder: Path) -> Path:
    return folder if folder.is_dir() else Path()


def _kept_rig(folder: Path) -> str:
    try:
        return (folder / RIG_AS_ADDED).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return ""


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()


def _calibration(rig: Rig) -> str:
    rows = [asdict(one) for one in calibration_of(rig)]
    ends = {name: str(end) for name, end in rig.certificates().ends().items()}
    return json.dumps([rows, ends], sort_keys=True, default=str)


def same_rig(agreed: Hashes, rig: Rig) -> str:
    """Return why a run must not begin on a rig that was read again, "" if it is the rig with the agreed hash."""
    return "" if _hash(rig.text) == agreed.rig else "the rig file changed while the item was planned"


def _materials(used: UsedMaterials) -> Iterator[tuple[str, str]]:
    for file in used.files:
        yield f"{file.role} {file.name}", _hash(" ".join((file.sha256, *(data.sha256 for data in file.data))))
    for role, name in used.bare:
        yield f"{role} {name}", ""
