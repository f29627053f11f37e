"""Is a run as it was left? The manifest's hashes, SQLite's own check, every sample block, the texts' hashes."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tester.export.exclude import is_unfinished
from tester.export.manifest import MANIFEST, manifest_problems
from tester.export.results import results_of
from tester.source import InvalidSource, read_tree
from tester.store.exclusions import problems as exclusion_problems
from tester.store.exclusions import standing
from tester.store.reader import RunReader
from tester.store.recorder import calibration_sha256, text_sha256
from tester.store.records import StoredExclusion, StoredRun
from tester.store.schema import StoreError
from tester.store.status import RunStatus
from tester.trouble import in_words


@dataclass(frozen=True, slots=True)
class Verification:
    """What was found: ``problems`` where something is not as it was left, a line each."""

    run: StoredRun | None
    status: RunStatus
    problems: tuple[str, ...]
    blocks: int = 0
    samples: int = 0
    """What was read of the record: sample blocks, and samples in them."""
    excluded: int = 0
    """Repeats that people have left out of the means; the manifest is of the tables without them."""


def verify(folder: Path) -> Verification:
    """Check a run's folder; never raises for what it finds wrong in it."""
    problems = _manifest(folder)
    try:
        with RunReader(folder) as reader:
            results = results_of(reader)
            run = results.run
            problems += [f"run.db: {problem}" for problem in reader.integrity_problems()]
            problems += _texts(folder, run)
            said = reader.exclusions()
            problems += [f"run.db: {problem}" for problem in exclusion_problems(said, reader.repeats(attempts=True))]
            problems += _cut_off(folder, said)
            blocks = samples = 0
            for block in reader.sample_blocks():
                blocks += 1
                samples += block.rows
    except StoreError as error:
        return Verification(None, RunStatus.UNREADABLE, (*problems, str(error)))
    return Verification(run, results.status, tuple(problems), blocks, samples, len(standing(said)))


def _cut_off(folder: Path, said: list[StoredExclusion]) -> list[str]:
    """Return what to do where a kill came between a person's word on a repeat and the tables without it."""
    path = folder / MANIFEST
    if not path.is_file() or not is_unfinished(said, path.read_text("utf-8", errors="replace")):
        return []
    last = said[-1]
    command = f"tester {'exclude' if last.excluded else 'include'} {folder.name} {last.condition}/{last.repeat}"
    return [f"`{command}` was cut off before the tables were made: the same command again makes them"]


def _manifest(folder: Path) -> list[str]:
    if not (folder / MANIFEST).is_file():
        return []  # written at a run's end; what is left of one that was cut off has none
    try:
        return manifest_problems(folder)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        return [f"{MANIFEST} cannot be read: {in_words(error)}"]


def _texts(folder: Path, run: StoredRun) -> list[str]:
    """Hold the stored texts against their stored hashes, and the folder's copies against both."""
    info = run.info
    stored = (
        ("recipe", info.recipe_text, run.recipe_sha256),
        ("rig", info.rig_text, run.rig_sha256),
    )
    problems = [f"run.db: the {name}'s text has another hash" for name, text, sha in stored if text_sha256(text) != sha]
    if run.calibration_sha256 and calibration_sha256(info.calibration) != run.calibration_sha256:
        problems.append("run.db: the calibration has another hash")
    for name, _, sha in stored:
        path = folder / f"{name}.yaml"
        if not path.is_file():
            problems.append(f"{path.name}: missing")
        elif _sha256(path) != sha:
            problems.append(f"{path.name}: not what the run was made with")
    return problems


def _sha256(path: Path) -> str:
    try:
        return text_sha256(read_tree(path)[0].text)
    except InvalidSource:
        return ""
