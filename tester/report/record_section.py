"""The data of a run for a report, read from its record and folder once."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tester.analysis.results import RepeatStatus
from tester.analysis.ring_errors import RingRun
from tester.results.run_files import MANIFEST
from tester.results.run_results import RingPart, RunResults, results_of
from tester.results.table_rows import Measured
from tester.results.verify import Verification, verify
from tester.store.journal_records import StoredEvent, StoredExclusion, StoredPrompt, StoredTare, StoredTrip
from tester.store.records import Change, SessionInfo, StoredRepeat
from tester.store.run_reader import RunReader

ALARMING = frozenset({"alarm", "trip"})
"""Severities of events that a report lists one by one; warnings are counted by kind."""


@dataclass(frozen=True, slots=True)
class MachineWords:
    """Words of a kind of rig for a report."""

    title: str
    measurand: str
    """Name of its coefficient, as the end of "measured was"; "" where the kind has none."""
    commented: str = ""
    """The packaged rig file most like the run's, with its remarks."""
    packaged: str = ""
    """The same as a run stores it."""
    ring: RingPart | None = None
    """Slip ring to a device on a turning part; None without one."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """The data of a run for a report."""

    name: str
    """Name of its folder."""
    machine: MachineWords
    results: RunResults
    sessions: Sequence[SessionInfo]
    changes: Sequence[Change]
    prompts: Sequence[StoredPrompt]
    tares: Sequence[StoredTare]
    trips: Sequence[StoredTrip]
    events: Sequence[StoredEvent]
    """Warnings and worse, in order."""
    exclusions: Sequence[StoredExclusion]
    """Decisions of people on single repeats, in order."""
    void: Mapping[int, Sequence[StoredRepeat]]
    """Interrupted attempts, by condition."""
    verification: Verification
    files: Mapping[str, str]
    """SHA-256 of the folder's files, by its manifest."""
    ring: RingRun | None = None
    """Record of its ring, where its machine has one."""

    def left_out(self) -> list[tuple[Measured, StoredRepeat, str]]:
        """Return the repeats that are in no mean, each with its condition and the reason."""
        return [
            (condition, repeat, reason)
            for condition in self.results.conditions()
            for repeat in condition.repeats
            if (reason := condition.exclusion(repeat))
        ]


def read_record(folder: Path, machine: MachineWords) -> RunRecord:
    """Return the data of the run in ``folder``; raises StoreError where it cannot be read.

    Its coefficients are recomputed from their samples, and its record is checked against its hashes (``tester
    verify``).
    """
    with RunReader(folder) as reader:
        void: dict[int, list[StoredRepeat]] = {}
        for repeat in reader.repeats(attempts=True):
            if repeat.result.status in (RepeatStatus.VOID, RepeatStatus.OPEN):
                void.setdefault(repeat.condition, []).append(repeat)
        return RunRecord(
            name=folder.name,
            machine=machine,
            results=results_of(reader),
            sessions=reader.sessions(),
            changes=reader.changes(),
            prompts=[*reader.prompts()],
            tares=[*reader.tares()],
            trips=[*reader.trips()],
            events=[event for event in reader.events() if event.severity not in ("info", "debug")],
            exclusions=reader.exclusions(),
            void=void,
            verification=verify(folder),
            files=_files(folder),
            ring=machine.ring.of(reader, folder.name) if machine.ring is not None else None,
        )


def _files(folder: Path) -> dict[str, str]:
    """Return the hashes of the manifest; empty where it is missing or unreadable, which `verify` reports."""
    try:
        listed: object = json.loads((folder / MANIFEST).read_text("utf-8"))["files"]
        if not isinstance(listed, dict):
            return {}
        return {str(name): str(one["sha256"]) for name, one in listed.items()}  # pyright: ignore
    except (OSError, ValueError, KeyError, TypeError):
        return {}
