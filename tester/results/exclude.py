"""Leaves a repeat out of a run's means, or includes it again: the decision is stored, then the tables are made anew."""

from __future__ import annotations

import re
from collections.abc import Generator, Iterable
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from tester import __version__
from tester.base import clock
from tester.base.lock import RUN_LOCK, ExclusiveUse, RigInUseError
from tester.base.trouble import TroubleError, in_words
from tester.base.words import plain_text
from tester.results.formats import FORMATS
from tester.results.run_files import MANIFEST, manifest_problems, write_all
from tester.store.amend import add_exclusion, standing
from tester.store.journal_records import StoredExclusion
from tester.store.notes import RunNote, add_note, checked, notes_of
from tester.store.record_file import DATABASE
from tester.store.records import StoredRepeat
from tester.store.run_reader import RunReader

MADE_ANEW = frozenset({DATABASE, *(kind.file for kind in FORMATS.values() if kind.kept is not None)})
"""Files of a run's folder that an exclusion changes, beside the manifest."""
LONGEST = 2000
"""Most characters of a reason."""


class CannotExcludeError(TroubleError):
    """The exclusion is refused; the message gives the reason, for people."""


@dataclass(frozen=True, slots=True)
class Word:
    """A person's decision on a repeat: out of the mean, or included again; why; who."""

    condition: int
    repeat: int
    excluded: bool
    reason: str
    operator: str


def parse_target(text: str) -> tuple[int, int]:
    """Return condition and repeat of a text such as ``3/2``; raises CannotExcludeError."""
    match = re.fullmatch(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*", text, re.ASCII)
    if match is None or not int(match[2]):  # a command of the service takes repeat 0 as all of them
        raise CannotExcludeError(f'expected CONDITION/REPEAT such as 3/2 (as in repeats.csv), got "{text}"')
    return int(match[1]), int(match[2])


def record_word(folder: Path, word: Word) -> None:
    """Store a person's decision and make the folder's tables and manifest anew.

    Refused while a process works on the run, for a repeat that is not committed, without a reason, and where the folder
    differs from its manifest: a new manifest would hide that. Raises CannotExcludeError, StoreError, OSError.
    """
    _check_words(word)
    with alone_with(folder) as before:
        with RunReader(folder) as reader:
            stored = reader.exclusions()
            repeat = _wanted(reader.repeats(), word)
            cut_off = is_cut_off(reader, before)
        if before:
            _check_manifest(folder, unfinished=cut_off)
        finishes = is_unfinished(stored, before) and (
            (stored[-1].target, stored[-1].excluded) == (repeat.target, int(word.excluded))
        )
        if not finishes:  # otherwise the decision is stored already, and only the tables are missing
            _refuse_contradiction(stored, repeat, word)
            now = clock.utc_now()
            add_exclusion(
                folder,
                StoredExclusion(0, *repeat.target, int(word.excluded), word.reason.strip(), word.operator.strip(), now,
                                __version__, before),
            )  # fmt: skip
        if before:  # a run without a manifest has no tables yet: they are made at its end
            write_all(folder)


def targets_of(folder: Path, word: Word) -> list[tuple[int, int, int]]:
    """Return condition, repeat and attempt that a decision on a run under way is about; its writer stores it.

    Repeat 0: each committed repeat of the condition that the decision changes. Raises CannotExcludeError, StoreError.
    """
    _check_words(word)
    with RunReader(folder) as reader:
        stored, repeats = reader.exclusions(), reader.repeats()
    if word.repeat:
        repeat = _wanted(repeats, word)
        _refuse_contradiction(stored, repeat, word)
        return [repeat.target]
    present = standing(stored)
    found = [r.target for r in repeats if r.condition == word.condition and (r.target in present) is not word.excluded]
    if not found:
        raise CannotExcludeError(f"condition {word.condition} has no committed repeat that this would change")
    return found


def _check_words(word: Word) -> None:
    if not word.reason.strip() or len(word.reason) > LONGEST:
        raise CannotExcludeError(f"a reason is needed, of at most {LONGEST} characters: it is recorded")
    try:
        plain_text(word.reason, "reason")
        plain_text(word.operator, "operator")
    except ValueError as error:
        raise CannotExcludeError(str(error)) from error


def record_note(folder: Path, text: str, tags: Iterable[str], by: str) -> None:
    """Store a person's note on a run that is not under way, with tags (a minus before one takes it back).

    Refused as ``record_word`` is. Raises CannotExcludeError, StoreError, OSError.
    """
    try:
        note = checked(RunNote(clock.utc_now(), by.strip(), text.strip(), tuple(tags)))
    except ValueError as error:
        raise CannotExcludeError(str(error)) from error
    with alone_with(folder) as before:
        if before:
            with RunReader(folder) as reader:
                cut_off = is_cut_off(reader, before)
            _check_manifest(folder, unfinished=cut_off)
        add_note(folder, replace(note, manifest_before=before))
        if before:
            write_all(folder)


@contextmanager
def alone_with(folder: Path) -> Generator[str]:
    """Keep other processes from a run; yield its manifest, "" where it has none. Raises CannotExcludeError."""
    with ExclusiveUse() as use:
        try:
            use.lock_file(folder.name, folder / RUN_LOCK, folder.name, lasting=False)
        except RigInUseError as error:
            raise CannotExcludeError(f"the run is under way, wait for its end: {error}") from error
        manifest = folder / MANIFEST
        yield manifest.read_text("utf-8") if manifest.is_file() else ""


def is_cut_off(reader: RunReader, manifest: str) -> bool:
    """Return whether a power cut or a kill came between the latest decision or note and the tables after it."""
    notes = notes_of(reader)
    noted = bool(notes) and bool(manifest) and notes[-1].manifest_before == manifest
    return noted or is_unfinished(reader.exclusions(), manifest)


def is_unfinished(exclusions: list[StoredExclusion], manifest: str) -> bool:
    """Return whether a power cut or a kill came between the latest decision and its tables."""
    return bool(exclusions) and bool(manifest) and exclusions[-1].manifest_before == manifest


def _wanted(repeats: list[StoredRepeat], word: Word) -> StoredRepeat:
    wanted = next(
        (repeat for repeat in repeats if (repeat.condition, repeat.repeat) == (word.condition, word.repeat)), None
    )
    if wanted is not None:
        return wanted
    committed = sorted(repeat.repeat for repeat in repeats if repeat.condition == word.condition)
    there = f"repeats {', '.join(map(str, committed))}" if committed else "no committed repeat"
    raise CannotExcludeError(
        f"{word.condition}/{word.repeat} is not a committed repeat: condition {word.condition} has {there}"
    )


def _refuse_contradiction(exclusions: list[StoredExclusion], repeat: StoredRepeat, word: Word) -> None:
    present = standing(exclusions).get(repeat.target)
    name = f"{word.condition}/{word.repeat}"
    if word.excluded and present is not None:
        by = f" by {present.operator}" if present.operator else ""
        raise CannotExcludeError(f"{name} is excluded already, {present.utc}{by}: {present.reason}")
    if not word.excluded and present is None:
        raise CannotExcludeError(f"{name} has not been excluded by anybody")


def _check_manifest(folder: Path, *, unfinished: bool) -> None:
    try:
        wrong = manifest_problems(folder)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise CannotExcludeError(f"{MANIFEST} cannot be read: {in_words(error)}") from error
    if unfinished:
        wrong = [line for line in wrong if line.partition(":")[0] not in MADE_ANEW]
    if wrong:
        raise CannotExcludeError(f"the run is not as it was left, see `tester verify`: {'; '.join(wrong)}")
