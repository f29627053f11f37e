"""Prepares an interrupted run to resume: the rest of its plan, and a check that recipe and rig are unchanged.

The run's folder holds the texts with which it began. These, or the files from which they were copied, may have been
changed on purpose. Hashes reveal both cases, and each is reported with the remedy.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tester.base import clock
from tester.base.source import read_tree
from tester.inputs.materials.files import MaterialFile
from tester.inputs.recipe.plan import Plan
from tester.inputs.recipe.recipe_schema import Recipe
from tester.inputs.rig import Rig
from tester.inputs.rig.profiles import LawCopies
from tester.machine.result_keeping import condition_records
from tester.run.folder import write_sources
from tester.run.kind_lookup import checked_recipe, load_rig, load_rig_text, recipe_part
from tester.run.provenance import PACKAGED, accepted_risks, calibration_of, session_info
from tester.run.run_materials import (
    KeptFile,
    kept_files,
    law_copies,
    law_file,
    put_back,
    used_materials,
    write_materials,
)
from tester.store.records import LOOSE_KEYS, Change, ConditionInfo, SessionInfo, StoredCondition, StoredRun, risk_text
from tester.store.resumable import ResumePoint, resume_point
from tester.store.run_reader import RunReader
from tester.store.sql import calibration_sha256, text_sha256
from tester.store.writer import RunWriter

LATER = "asked for once it is known with which text the run resumes"
"""Placeholder for the reason that a rig's risks require, while texts are compared."""


@dataclass(frozen=True, slots=True)
class Resumed:
    """An interrupted run, ready to resume."""

    rig: Rig
    plan: Plan
    """The rest of the plan."""
    seed: int
    point: ResumePoint
    begin: Callable[[RunWriter], None]
    summary: str
    """Summary for people, in one line."""


@dataclass(frozen=True, slots=True)
class Found:
    """The texts with which to resume, and their changes."""

    recipe_text: str
    rig: Rig
    recipe_source: str
    rig_source: str
    changes: tuple[Change, ...]
    where: tuple[str, ...]
    """The files that differ, as text, a line each."""

    @property
    def subjects(self) -> list[str]:
        """Return what has changed: recipe, rig, calibration."""
        return [change.subject for change in self.changes]


def prepare(folder: Path, reason: str, operator: str, accept_risk: str = "") -> Resumed | str:
    """Return the run in a folder, ready to resume, or the reason for refusing.

    ``reason``: why it may resume although recipe, rig or calibration changed; stored with each change. ``accept_risk``:
    why safety keys of the rig may be looser than they should be; needed again at every resume. Raises StoreError for an
    unreadable record, InvalidSource for a recipe or rig file that is no longer valid.
    """
    with RunReader(folder) as reader:
        run, stored, point = reader.run(), reader.conditions(), resume_point(reader)
    # The rig's law is read with the rig, so its copy is put back first.
    laws, _ = put_back(folder, [file for file in run.info.materials if file.role == "law"])
    found = _found(folder, run, point.session, reason)
    if found.changes and not reason:
        subjects, where = ", ".join(found.subjects), "; ".join(found.where)
        return f"{subjects} changed since the run began ({where}): --reason TEXT resumes all the same"
    risks = accepted_risks(found.rig, accept_risk)
    if risks and not accept_risk:
        return f"{risks[LOOSE_KEYS]}: --accept-risk REASON resumes all the same"
    part = recipe_part(found.rig)
    recipe = checked_recipe(found.recipe_text, found.rig, str(folder / "recipe.yaml"))
    plan = part.expand(recipe.recipe, found.rig)
    conditions = list(condition_records(plan))
    refused = _another_plan(conditions, stored)
    if refused:
        return refused
    restored, lost = put_back(folder, run.info.materials)
    if lost:
        return f"{', '.join(lost)}: changed since the run began, and the record has only its hash: put it back"
    added = _added_materials(folder, run, recipe.recipe, found)
    begun = {s.info.condition for s in stored if _begun(s)}
    to_come = [c for c in conditions if c.condition not in begun]
    session = session_info(point.session, point.origin_s, operator)
    if "calibration" in found.subjects:
        # After a change of scale or zero the old reference means nothing.
        point = replace(point, reference_tare=None)
    return Resumed(
        rig=found.rig,
        plan=part.remaining(plan, point.stand),
        seed=run.info.seed or 0,
        point=point,
        begin=_beginning(folder, session, found, to_come, added, risks, reason),
        summary=_summary(folder, point, len(conditions), [*laws, *restored]),
    )


def _beginning(
    folder: Path,
    session: SessionInfo,
    found: Found,
    to_come: Sequence[ConditionInfo],
    added: Sequence[KeptFile],
    risks: Mapping[str, str],
    reason: str,
) -> Callable[[RunWriter], None]:
    """Return the function that records the resumption, and writes changed texts and added materials into the folder."""

    def begin(writer: RunWriter) -> None:
        writer.begin_session(session)
        writer.resume_run(found.changes)
        if "recipe" in found.subjects:
            writer.replace_recipe(found.recipe_text, to_come, found.recipe_source)
        if {"rig", "calibration"} & set(found.subjects):
            writer.replace_rig(found.rig.text, calibration_of(found.rig), session.session, found.rig_source)
        if added:
            write_materials(folder, added)
            writer.add_materials([file.stored for file in added])
        if found.changes:
            write_sources(folder, found.recipe_text, found.rig)
        writer.add_metadata(risks)
        if risks:
            writer.event(0.0, "risk", risk_text(risks), "warning")
        writer.event(0.0, "resume", f"stretch {session.session} of the run{': ' + reason if reason else ''}")

    return begin


def _added_materials(folder: Path, run: StoredRun, recipe: Recipe, found: Found) -> tuple[KeptFile, ...]:
    """Return the files that the changed recipe or rig names in addition; files already recorded stay as they are."""
    recorded = run.info.materials
    added: list[MaterialFile] = []
    if "recipe" in found.subjects:
        source = Path(found.recipe_source) if found.recipe_source else folder / "recipe.yaml"
        added += used_materials(recipe, source, [file.name for file in recorded if file.role != "data"]).files
    if "rig" in found.subjects:
        copies = law_copies(folder, recorded).values()
        added += [file for file in law_file(found.rig) if str(file.path) not in copies]
    return kept_files(added, [file.file for file in recorded])


def _summary(folder: Path, point: ResumePoint, conditions: int, restored: Sequence[str]) -> str:
    over = len(point.stand.ended)
    at = point.next_repeat
    where = f", resumes at repeat {at[1]} of condition {at[0]}" if at is not None else ""
    back = f"; {', '.join(restored)} put back as recorded" if restored else ""
    return f"{folder.name}: {over} of {conditions} conditions are over{where}{back}"


# -- what changed -------------------------------------------------------------------------------------------------


def _found(folder: Path, run: StoredRun, session: int, reason: str) -> Found:
    where: list[str] = []
    stored, copies = run.info.rig_text, law_copies(folder, run.info.materials)
    recipe_text, recipe_source = _present(
        run.info.recipe_text, folder / "recipe.yaml", _text_of, run.info.recipe_source, _recipe_at_source(run), where
    )
    rig_text, rig_source = _present(
        stored,
        folder / "rig.yaml",
        lambda path: _rig_text(path, stored, copies),
        run.info.rig_source,
        _rig_at_source(run, copies),
        where,
    )
    rig = load_rig_text(rig_text, copies)
    figures = calibration_sha256(calibration_of(rig))
    utc = clock.utc_now()
    changes = [
        Change(session, utc, subject, before, after, text, reason)
        for subject, before, after, text in (
            ("recipe", run.recipe_sha256, text_sha256(recipe_text), run.info.recipe_text),
            ("rig", run.rig_sha256, text_sha256(rig_text), run.info.rig_text),
            ("calibration", run.calibration_sha256, figures, ""),
        )
        if before != after
    ]
    if changes and not where:
        where.append("the profile of a device")
    return Found(recipe_text, rig, recipe_source, rig_source, tuple(changes), tuple(where))


def _present(
    stored: str, copy: Path, read: Callable[[Path], str], source: str, at_source: str | None, where: list[str]
) -> tuple[str, str]:
    """Return the text with which to resume, and its source: the folder's copy if that was changed, else the original
    file.
    """
    if copy.is_file():
        text = read(copy)
        if text != stored:
            where.append(str(copy))
            return text, ""
    if at_source is not None and at_source != stored:
        where.append(f"the original of {copy.name}, {source}")
        return at_source, source
    return stored, source


def _text_of(path: Path) -> str:
    return read_tree(path)[0].text


def _rig_text(path: Path | str, stored: str, copies: LawCopies, overrides: Sequence[str] = ()) -> str:
    """Return a rig file's present text; the stored text if it describes the same rig and only an older version wrote
    it.
    """
    rig = load_rig(path, overrides, LATER, copies)
    return stored if rig == load_rig_text(stored, copies) else rig.text


def _recipe_at_source(run: StoredRun) -> str | None:
    source = run.info.recipe_source
    if not source or source.startswith(PACKAGED) or not Path(source).is_file():
        return None
    return _text_of(Path(source))


def _rig_at_source(run: StoredRun, copies: LawCopies) -> str | None:
    """Return the rig file's present text; None for a packaged rig, which changes only with the program."""
    where, *overrides = shlex.split(run.info.rig_source) or [""]
    if not (Path(where).is_absolute() and Path(where).is_file()):
        return None
    return _rig_text(where, run.info.rig_text, copies, overrides)


def _begun(stored: StoredCondition) -> bool:
    return stored.started_s == stored.started_s


def _another_plan(conditions: Sequence[ConditionInfo], stored: Sequence[StoredCondition]) -> str:
    """Return why a changed recipe is a different test: it omits or alters a condition that has begun."""
    now = {condition.condition: condition for condition in conditions}
    for begun in stored:
        if _begun(begun) and now.get(begun.info.condition) != begun.info:
            return (
                f"the recipe is a different test: it lacks or alters condition {begun.info.condition}, which has "
                "measurements; begin a new run"
            )
    return ""
