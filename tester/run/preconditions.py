"""Checks before a run begins: reads and plans its recipe, checks the disk space, locks buses and folder."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path

from recipes import find
from tester import kinds
from tester.base import clock
from tester.base.lock import RUN_LOCK, ExclusiveUse, RigInUseError
from tester.base.processes import EXIT_INVALID
from tester.inputs.recipe.loader import LoadedRecipe
from tester.inputs.recipe.plan import Plan
from tester.inputs.recipe.time_estimate import Estimate
from tester.inputs.rig import Rig
from tester.inputs.rig.checks import other_settings
from tester.inputs.rig.rig_keys import value_at
from tester.inputs.rig.risks import counts_as_simulated
from tester.machine.commission.record import CommissionRecord, RecordError, record_path, standing_of
from tester.machine.run import Outcome
from tester.run.endings import EXIT_CODES, CannotStartError
from tester.run.folder import Work, work_of
from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
from tester.run.run_materials import UsedMaterials, law_file, used_materials
from tester.run.session_options import SessionOptions
from tester.store.disk import expected_bytes, too_little_room


def enough_room(folder: Path, plan: Plan, rig: Rig, expected: Estimate | None = None) -> None:
    """Raise CannotStartError unless twice the run's expected size is free; ``expected``: the run's estimate."""
    missing = too_little_room(folder, expected_bytes(plan, expected or recipe_part(rig).estimate(plan, rig)))
    if missing:
        raise CannotStartError(missing, EXIT_CODES[Outcome.FAILED])


def hold_rig(use: ExclusiveUse, rig: Rig, run: str) -> None:
    """Lock a rig's buses; do nothing for a rig simulated in this process. Raises CannotStartError."""
    try:
        use.lock(buses_of(rig), run)
    except RigInUseError as error:
        raise CannotStartError(str(error), EXIT_CODES[Outcome.UNREACHABLE]) from error


def hold_run(use: ExclusiveUse, folder: Path) -> None:
    """Lock a run's folder, so that no other process resumes a run under way. Raises CannotStartError."""
    try:
        use.lock_file(f"the run {folder.name}", folder / RUN_LOCK, folder.name, lasting=False)
    except RigInUseError as error:
        raise CannotStartError(str(error)) from error


def buses_of(rig: Rig) -> list[str]:
    """Return the names of a rig's buses; only one process may use each."""
    if rig.can.interface == "sim":
        return []
    lines = [f"line {line.port}" for line in rig.lines.values()]
    return [f"can {rig.can.interface}:{rig.can.channel}", *lines]


def unmeasured(rig: Rig, runs: Path) -> str:
    """Return the required steps of commissioning that are not on record for a real rig's file, "" for none.

    ``runs``: the folder of the runs, with the record. An axis that a person sets needs no step.
    """
    part = kinds.find(rig.kind).commissions
    if part is None or counts_as_simulated(rig):
        return ""
    path = record_path(runs, rig.name)
    try:
        standing = standing_of(CommissionRecord(path, clock.utc_now, ""), part().steps, rig)
    except (RecordError, OSError) as error:
        return str(error)
    missing = [
        f"{state.step.name}: {state.words}"
        for state in standing
        if state.step.required and state.stands is None and _has(rig, state.step.sections[0])
    ]
    return f"{'; '.join(missing)} (tester commission, record {path})" if missing else ""


def _has(rig: Rig, section: str) -> bool:
    return value_at(rig, tuple(section.split("."))) not in (None, False)


def not_measured(options: SessionOptions, rig: Rig) -> str:
    """Return ``unmeasured`` of the file of a run's rig; raises CannotStartError unless its risks are accepted."""
    if counts_as_simulated(rig):
        return ""
    missing = unmeasured(load_rig(options.rig, (), options.accept_risk) if options.overrides else rig, options.out)
    if missing and not options.accept_risk:
        raise CannotStartError(f"{missing}: commission the rig, or accept it: --accept-risk REASON", EXIT_INVALID)
    return missing


def warnings_before(rig: Rig, today: date) -> list[str]:
    """Return warnings before a rig starts: expired certificates, lines with other settings.

    Raises CannotStartError if a certificate has expired and the rig file forbids a start in that case
    (``calibration.overdue``).
    """
    calibration = rig.certificates()
    over = calibration.over(today)
    if over and calibration.overdue == "refuse":
        raise CannotStartError(f"calibration overdue: {over} (calibration.overdue: refuse)", EXIT_INVALID)
    lines = [] if rig.simulated else [f"warning: {text}" for text in other_settings(rig)]
    return [f"calibration overdue: {over}", *lines] if over else lines


@dataclass(frozen=True, slots=True)
class Prepared:
    """A recipe planned for a rig, with its work and its estimate."""

    path: Path
    recipe: LoadedRecipe
    work: Work
    expected: Estimate
    materials: UsedMaterials


def prepared(recipe: str, rig_name: str, overrides: tuple[str, ...], accept_risk: str = "") -> Prepared:
    """Read and plan a recipe. Raises InvalidSource, UnknownRecipe."""
    rig = load_rig(rig_name, overrides, accept_risk)
    path = find(recipe)
    loaded = checked_recipe(path, rig)
    work = work_of(loaded.recipe, rig)
    materials = used_materials(loaded.recipe, path)
    materials = replace(materials, files=(*materials.files, *law_file(rig)))
    return Prepared(path, loaded, work, recipe_part(rig).estimate(work.plan, rig), materials)
