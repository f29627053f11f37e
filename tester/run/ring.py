"""The ring of a stored run's machine, where its kind has one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tester.analysis.ring_runs import RingRun
from tester.kinds import UnknownKindError, find
from tester.results.ring_part import RingPart
from tester.store.reader import RunReader


@dataclass(frozen=True, slots=True)
class RingFound:
    """What a run has on record of its ring; ``rig``: the file of the rig that it ran on."""

    part: RingPart
    run: RingRun
    rig: str


def ring_part(kind: str) -> RingPart | None:
    """Return what a kind says of its ring; None where it has none, or is not installed."""
    try:
        found = find(kind).ring
    except UnknownKindError:
        return None
    return found() if found is not None else None


def ring_in(folder: Path) -> RingFound | None:
    """Return the ring of a run; None where its kind has none. Raises StoreError."""
    with RunReader(folder) as reader:
        info = reader.run().info
        part = ring_part(info.kind)
        return RingFound(part, part.of(reader, folder.name), info.rig_source) if part is not None else None


def of_one_rig(found: Sequence[RingFound], like: RingFound) -> list[RingFound]:
    """Return those of one rig, in order of time: rings of other rigs have an age of their own."""
    return sorted((one for one in found if one.rig == like.rig), key=lambda one: one.run.started)
