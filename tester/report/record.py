"""Everything that a report tells of a run, read off its record and folder once."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from tester.analysis.results import RepeatStatus
from tester.analysis.ring_runs import RingRun
from tester.results.manifest import MANIFEST
from tester.results.ring_part import RingPart
from tester.results.run_results import Measured, RunResults, results_of
from tester.results.verify import Verification, verify
from tester.store.reader import RunReader
from tester.store.records import (
    Change,
    SessionInfo,
    StoredEvent,
    StoredExclusion,
    StoredPrompt,
    StoredRepeat,
    StoredTare,
    StoredTrip,
)

ALARMING = frozenset({"alarm", "trip"})
"""Severities of events that a report names each; of warnings it names the kinds."""


@dataclass(frozen=True, slots=True)
class MachineWords:
    """What the kind of a rig says of itself."""

    title: str
    measurand: str
    """What its coefficient is, in words that follow "measured was"; "" where the kind does not say."""
    commented: str = ""
    """Its packaged rig file that a run's is like, with its remarks."""
    packaged: str = ""
    """The same as a run stores it."""
    ring: RingPart | None = None
    """Over which a device on a turning part is reached; None: there is none."""


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A run as a report tells it."""

    name: str
    """Of its folder."""
    machine: MachineWords
    results: RunResults
    sessions: Sequence[SessionInfo]
    changes: Sequence[Change]
    prompts: Sequence[StoredPrompt]
    tares: Sequence[StoredTare]
    trips: Sequence[StoredTrip]
    events: Sequence[StoredEvent]
    """Warnings and worse, in order."""
    said: Sequence[StoredExclusion]
    """What people have said of single repeats, in order."""
    void: Mapping[int, Sequence[StoredRepeat]]
    """Attempts that were interrupted, by condition."""
    verification: Verification
    files: Mapping[str, str]
    """SHA-256 of the folder's files, as its manifest says."""
    ring: RingRun | None = None
    """What is on record of its ring, where its machine has one."""

    def left_out(self) -> list[tuple[Measured, StoredRepeat, str]]:
        """Return the repeats that are in no mean, each with its condition and the reason."""
        return [
            (one, repeat, reason)
            for one in self.results.conditions()
            for repeat in one.repeats
            if (reason := one.exclusion(repeat))
        ]


def read_record(folder: Path, machine: MachineWords) -> RunRecord:
    """Return what a report tells of the run in ``folder``; raises StoreError where it cannot be read.

    Its coefficients are recomputed from their samples, and its record held against its hashes (``tester verify``).
    """
    with RunReader(folder) as reader:
        void: dict[int, list[StoredRepeat]] = {}
        for one in reader.repeats(attempts=True):
            if one.result.status in (RepeatStatus.VOID, RepeatStatus.OPEN):
                void.setdefault(one.condition, []).append(one)
        return RunRecord(
            name=folder.name,
            machine=machine,
            results=results_of(reader),
            sessions=reader.sessions(),
            changes=reader.changes(),
            prompts=[*reader.prompts()],
            tares=[*reader.tares()],
            trips=[*reader.trips()],
            events=[one for one in reader.events() if one.severity not in ("info", "debug")],
            said=reader.exclusions(),
            void=void,
            verification=verify(folder),
            files=_files(folder),
            ring=machine.ring.of(reader, folder.name) if machine.ring is not None else None,
        )


def _files(folder: Path) -> dict[str, str]:
    """Return the hashes of the manifest; none where it is missing or is not to be read, which `verify` tells."""
    try:
        listed: object = json.loads((folder / MANIFEST).read_text("utf-8"))["files"]
        if not isinstance(listed, dict):
            return {}
        return {str(name): str(one["sha256"]) for name, one in listed.items()}  # pyright: ignore
    except (OSError, ValueError, KeyError, TypeError):
        return {}
