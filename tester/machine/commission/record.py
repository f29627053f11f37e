"""The record of a rig's commissioning: a file of JSON lines that is only appended to.

Each entry holds time, author, rig file (its SHA-256), step and result, and the hash of the previous entry, which
reveals a changed or removed line. An entry is written, flushed and synced before anything else happens. If a kill cuts
a line off, the reader skips it, and the next entry begins on a line of its own.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Final

from tester.inputs.rig import Rig
from tester.machine.commission.commission_step import CommissionStep, sections_sha256
from tester.store.disk import sync_folder

BEGUN, READING, DONE, REFUSED = "begun", "reading", "done", "refused"
"""Kinds of entry about a step: its beginning, a reading, success, refusal."""
FIRST: Final = "0" * 64
FOLDER: Final = "commissioning"
"""Folder, inside the folder of the runs, with one record for each rig."""


def record_path(runs: Path, rig: str) -> Path:
    """Return the path of a rig's record, by the rig's name, in the folder of the runs."""
    slug = re.sub(r"[^a-z0-9]+", "-", rig.lower()).strip("-") or "rig"
    return runs / FOLDER / f"{slug}.jsonl"


class RecordError(Exception):
    """The record is unreadable or its chain is broken; the message gives the place."""


@dataclass(frozen=True, slots=True)
class RecordEntry:
    """One entry. ``values``: numbers and texts by name, with units in the names."""

    at: str
    by: str
    rig: str
    rig_sha256: str
    sections: str
    """SHA-256 of the parts of the rig file that the step depends on."""
    step: str
    what: str
    text: str = ""
    values: Mapping[str, Any] = field(default_factory=dict[str, Any])
    previous: str = FIRST
    sha256: str = ""

    def body(self) -> str:
        """Return the line without its own hash."""
        fields = {name: value for name, value in asdict(self).items() if name != "sha256"}
        return json.dumps(fields, ensure_ascii=False, allow_nan=False)


class CommissionRecord:
    """The entries of a rig, oldest first."""

    def __init__(self, path: Path, utc: Callable[[], str], by: str) -> None:
        """Read the existing entries; raises RecordError, OSError. ``by``: the author of new entries."""
        self.path = path
        self.by = by
        self.entries: list[RecordEntry] = []
        self.torn = False
        """Whether the last line is incomplete."""
        self._utc = utc
        self._read()

    def _read(self) -> None:
        if not self.path.exists():
            return
        data = self.path.read_bytes()
        lines = data.split(b"\n")
        self.torn = lines[-1] != b""
        last = FIRST
        for number, raw in enumerate(lines, 1):
            if not raw.strip():
                continue
            entry = _entry(raw)
            if entry is None:
                continue  # cut off by a kill; a changed line would show in the next line's hash
            if entry.previous != last:
                raise RecordError(f"{self.path}: line {number} does not follow from the one before: a line was changed")
            last = entry.sha256
            self.entries.append(entry)

    def add(
        self,
        rig: str,
        rig_sha256: str,
        sections: str,
        step: str,
        what: str,
        text: str = "",
        values: Mapping[str, Any] | None = None,
    ) -> RecordEntry:
        """Append an entry and sync it to the disk before returning. Raises OSError, or ValueError if a value is not a
        number.
        """
        previous = self.entries[-1].sha256 if self.entries else FIRST
        at = self._utc()
        unsigned = RecordEntry(at, self.by, rig, rig_sha256, sections, step, what, text, values or {}, previous)
        body = unsigned.body()
        entry = replace(unsigned, sha256=hashlib.sha256(body.encode()).hexdigest())
        written = f'{body[:-1]}, "sha256": "{entry.sha256}"}}\n'
        new = not self.path.exists()
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab") as file:
            file.write(b"\n" * self.torn + written.encode())
            file.flush()
            os.fsync(file.fileno())
        self.torn = False
        if new:
            sync_folder(self.path.parent)
        self.entries.append(entry)
        return entry

    def last(self, step: str) -> RecordEntry | None:
        """Return the newest entry of a step that is not a reading."""
        return next((entry for entry in reversed(self.entries) if entry.step == step and entry.what != READING), None)

    def standing(self, step: str, sections: str) -> RecordEntry | None:
        """Return the entry that records the step's success with these sections of the rig file; None if it is not
        done.
        """
        entry = self.last(step)
        return entry if entry is not None and entry.what == DONE and entry.sections == sections else None


def _entry(raw: bytes) -> RecordEntry | None:
    """Return a line's entry; None if the line is not an entry or its hash is wrong."""
    try:
        fields: dict[str, Any] = json.loads(raw)
        sha256 = str(fields.pop("sha256"))
        entry = RecordEntry(**fields, sha256=sha256)
    except (ValueError, TypeError, KeyError, AttributeError):
        return None
    return entry if hashlib.sha256(entry.body().encode()).hexdigest() == sha256 else None


@dataclass(frozen=True, slots=True)
class StepStanding:
    """The state of one step: its valid entry (None if it is not done), and its newest entry (None if it has none)."""

    step: CommissionStep
    stands: RecordEntry | None
    last: RecordEntry | None

    @property
    def words(self) -> str:
        """Return the state in words, for people."""
        if self.stands is not None:
            return f"done on {self.stands.at[:10]}, {self.stands.by}: {self.stands.text}"
        if self.last is None:
            return "to be done"
        why = {BEGUN: "was cut off", DONE: "the rig file has changed under it"}.get(self.last.what, self.last.what)
        text = f": {self.last.text}" if self.last.text else ""
        return f"to be done again ({why}, {self.last.at[:10]}){text}"


def standing_of(record: CommissionRecord, steps: Sequence[CommissionStep], rig: Rig) -> tuple[StepStanding, ...]:
    """Return the state of each step under a rig file."""
    return tuple(
        StepStanding(step, record.standing(step.name, sections_sha256(rig, step.sections)), record.last(step.name))
        for step in steps
    )
