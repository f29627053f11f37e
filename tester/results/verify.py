"""Verifies that a run is unchanged: the chain over its record, coefficients from their samples, the manifest, the
texts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tester import __version__
from tester.base.source import InvalidSource, read_tree
from tester.base.trouble import in_words
from tester.results.exclude import is_cut_off, is_unfinished
from tester.results.formats import Record
from tester.results.recomputed import coefficient_problems, table_problems
from tester.results.run_files import MANIFEST, file_sha256, manifest_head, manifest_problems
from tester.results.run_results import RunResults
from tester.store.amend import problems as exclusion_problems
from tester.store.amend import standing
from tester.store.chain import ChainFound
from tester.store.journal_records import StoredExclusion
from tester.store.record_schema import StoreError
from tester.store.records import StoredRun
from tester.store.run_folders import RunStatus, under_way
from tester.store.run_reader import RunReader
from tester.store.sql import calibration_sha256, text_sha256

LISTED = 5
"""Most rows newer than a kept head that are listed."""


@dataclass(frozen=True, slots=True)
class Verification:
    """Result of a verification: ``problems`` lists changes, a line each."""

    run: StoredRun | None
    status: RunStatus
    problems: tuple[str, ...]
    blocks: int = 0
    samples: int = 0
    """Amount read from the record: sample blocks, and samples in them."""
    excluded: int = 0
    """Repeats that people have left out of the means; the manifest covers the tables without them."""
    coefficients: int = 0
    """Number recomputed from their samples."""
    head: str = ""
    """The last head of the record's chain, hexadecimal; "" where the record cannot be read."""


def verify(folder: Path, kept: str = "") -> Verification:
    """Check a run's folder and return the result; never raises for faults of the folder.

    ``kept``: the head of the record's chain as a person has kept it, hexadecimal, 64 digits; "" for none.
    """
    problems = _manifest(folder)
    try:
        with RunReader(folder) as reader:
            record = Record(reader)
            results = record.results
            run = results.run
            chain = reader.chain()
            problems += _chain(chain, kept)
            problems += _finished(folder, results, chain)
            problems += _named(folder, run)
            reported = {problem.partition(":")[0] for problem in problems}
            by = _made_by(reader)
            problems += [f"{line}{by}" for name, line in table_problems(folder, record) if name not in reported]
            coefficients, differing = coefficient_problems(reader)
            problems += differing
            problems += [f"run.db: {problem}" for problem in reader.integrity_problems()]
            problems += _texts(folder, run)
            exclusions = reader.exclusions()
            problems += [
                f"run.db: {problem}" for problem in exclusion_problems(exclusions, reader.repeats(attempts=True))
            ]
            problems += _cut_off(folder, exclusions)
            blocks = samples = 0
            for block in reader.sample_blocks():
                blocks += 1
                samples += block.rows
    except StoreError as error:
        return Verification(None, RunStatus.UNREADABLE, (*problems, str(error)))
    out = len(standing(exclusions))
    return Verification(run, results.status, tuple(problems), blocks, samples, out, coefficients, chain.head)


def _chain(chain: ChainFound, kept: str) -> list[str]:
    """Return the contradictions to the chain, and whether it ends in the head that a person kept."""
    problems = [f"run.db: {problem}" for problem in chain.problems]
    if not kept or kept.lower() == chain.head:
        return problems
    heads = [head.hex() for head in chain.heads]
    if kept.lower() not in heads:
        return [*problems, f"run.db: another record than the one of the head {kept}: its own is {chain.head or 'none'}"]
    since = chain.names[heads.index(kept.lower()) + 1 :]
    return [*problems, f"run.db: has grown since the head {kept} by {len(since)} rows: {', '.join(since[-LISTED:])}"]


def _finished(folder: Path, results: RunResults, chain: ChainFound) -> list[str]:
    """Return what an ended run lacks: its manifest, with the chain's head."""
    # The manifest is written only at a run's end.
    if results.status in (RunStatus.RUNNING, RunStatus.INTERRUPTED) or under_way(folder) is not None:
        return []
    if not (folder / MANIFEST).is_file():
        return [f"{MANIFEST}: missing, and the run has ended"]
    try:
        if manifest_head(folder) != chain.head:
            return [f"{MANIFEST}: of a record with another head"]
    except (OSError, ValueError, AttributeError, KeyError, TypeError):
        pass  # unreadable: ``_manifest`` has reported it already
    return []


def _made_by(reader: RunReader) -> str:
    """Return which other version last wrote the folder's tables, in brackets; "" for this version."""
    exclusions, sessions = reader.exclusions(), reader.sessions()
    by = exclusions[-1].software_version if exclusions else sessions[-1].software_version if sessions else __version__
    return "" if by == __version__ else f" (version {by} wrote it, version {__version__} compares)"


def _named(folder: Path, run: StoredRun) -> list[str]:
    """Return whether the folder is another than the record's, by its name."""
    name = folder.resolve().name
    return [] if name == run.info.name else [f"run.db: the record of {run.info.name}, in a folder named {name}"]


def _cut_off(folder: Path, exclusions: list[StoredExclusion]) -> list[str]:
    """Return the remedy where a kill came between a person's decision on a repeat and the tables that follow it."""
    path = folder / MANIFEST
    manifest = path.read_text("utf-8", errors="replace") if path.is_file() else ""
    if not is_unfinished(exclusions, manifest):
        with RunReader(folder) as reader:
            noted = is_cut_off(reader, manifest)
        return [f"a note on {folder.name} was cut off before its manifest was made: another note makes it"] * noted
    last = exclusions[-1]
    command = f"tester results {'exclude' if last.excluded else 'include'} {folder.name} {last.condition}/{last.repeat}"
    return [f"`{command}` was cut off before the tables were made: the same command again makes them"]


def _manifest(folder: Path) -> list[str]:
    if not (folder / MANIFEST).is_file():
        return []  # written at a run's end; a run that was cut off has none
    try:
        return manifest_problems(folder)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        return [f"{MANIFEST} cannot be read: {in_words(error)}"]


def _texts(folder: Path, run: StoredRun) -> list[str]:
    """Return differences of the stored texts from their stored hashes, and of the folder's copies from both."""
    info = run.info
    stored = (
        ("recipe", info.recipe_text, run.recipe_sha256),
        ("rig", info.rig_text, run.rig_sha256),
    )
    problems = [f"run.db: the {name}'s text has another hash" for name, text, sha in stored if text_sha256(text) != sha]
    if calibration_sha256(info.calibration) != run.calibration_sha256:
        problems.append("run.db: the calibration has another hash")
    for name, _, sha in stored:
        path = folder / f"{name}.yaml"
        if not path.is_file():
            problems.append(f"{path.name}: missing")
        elif _sha256(path) != sha:
            problems.append(f"{path.name}: not what the run was made with")
    return [*problems, *_materials(folder, run)]


def _materials(folder: Path, run: StoredRun) -> Iterator[str]:
    """Yield differences of the files of compounds and surfaces: their texts on record, and the folder's copies."""
    for material in run.info.materials:
        if material.text is not None and text_sha256(material.text) != material.sha256:
            yield f"run.db: the text of {material.file} has another hash"
        path = folder / material.file
        if not path.is_file():
            yield f"{material.file}: missing"
        elif file_sha256(path) != material.sha256:
            yield f"{material.file}: not what the run was made with"


def _sha256(path: Path) -> str:
    try:
        return text_sha256(read_tree(path)[0].text)
    except InvalidSource:
        return ""
