"""Files that are whole or absent, also after a power cut; room on the disk for a run, twice over."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Thread

from tester.inputs.recipe.estimate import Estimate
from tester.inputs.recipe.plan import Plan

ROW_BYTES = 60.0
"""A recorded sample in its block, with its share of the log and of the tables (measured: 38 to 55)."""
CONTACT_ROWS_S = 60.0
"""Samples per rig second of a step in contact: 100 in slip, 20 while rolling (interface: exports). Simulated runs of
the shipped recipes record 25 to 40."""
IDLE_ROWS_S = 2.0
FIXED_BYTES = 2_000_000.0
"""Recipe, rig file, journal, device parameters, tables, and the log before it is folded in."""
MARGIN = 2.0
"""Free room is to be this many times the estimate [A]."""


def free_bytes(folder: Path) -> int:
    """Return the room that is free under a folder, bytes; on a network share this may take for ever. Raises OSError."""
    return shutil.disk_usage(folder).free


class FreeRoom:
    """The room under a folder as it was told last. A thread asks: whoever looks never waits for a disk that hangs."""

    def __init__(self, folder: Path, ask: Callable[[Path], int] = free_bytes) -> None:
        """``folder``: the working folder stands in until it is there; ``ask`` as ``free_bytes``."""
        self.folder = folder
        self.hangs = False
        """A question was still waiting for its answer when the next one was due."""
        self._told: int | None = None
        self._ask = ask
        self._asking: Thread | None = None

    @property
    def free(self) -> int | None:
        """Bytes; None where nothing was told yet, an error was, or the disk hangs."""
        return None if self.hangs else self._told

    def look(self) -> None:
        """Have it asked for anew, unless an answer is still due; never waits."""
        self.hangs = self._asking is not None and self._asking.is_alive()
        if not self.hangs:
            self._asking = Thread(target=self._work, name="free room", daemon=True)
            self._asking.start()

    def wait(self, seconds: float) -> None:
        """Wait so long at most for the answer; for a moment when nothing is under control."""
        if self._asking is not None:
            self._asking.join(seconds)

    def _work(self) -> None:
        try:
            self._told = self._ask(self.folder if self.folder.is_dir() else Path())
        except OSError:
            self._told = None


def expected_bytes(plan: Plan, expected: Estimate) -> float:
    """Return what a run of the plan will take on disk, bytes; ``expected`` is the plan's estimate."""
    rows = 0.0
    for step, one in zip(plan.steps, expected.steps, strict=True):
        in_contact = step.contact
        rows += one.seconds * (CONTACT_ROWS_S if in_contact else IDLE_ROWS_S)
    return FIXED_BYTES + ROW_BYTES * rows


def too_little_room(folder: Path, needed: float) -> str:
    """Return why there is not room for ``needed`` bytes under a folder, with the numbers; empty where there is."""
    free = free_bytes(folder)
    if free >= MARGIN * needed:
        return ""
    return (
        f"{_mb(free)} free under {folder}, and {_mb(MARGIN * needed)} are asked for: "
        f"{MARGIN:g} times the {_mb(needed)} that the run is expected to take"
    )


def _mb(size: float) -> str:
    return f"{size / 1e6:,.1f} MB"


def write_whole(path: Path, fill: Callable[[Path], None]) -> None:
    """Let ``fill`` write a file beside ``path``, then put it in its place, synced; raises OSError."""
    part = path.with_name(f"{path.name}.part")
    try:
        fill(part)
        with part.open("rb+") as file:
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    sync_folder(path.parent)


def write_text(path: Path, text: str) -> None:
    """Write a text as UTF-8, line ends as they are, whole and synced; raises OSError."""

    def fill(part: Path) -> None:
        part.write_bytes(text.encode())

    write_whole(path, fill)


def sync_folder(folder: Path) -> None:
    """Make names in a folder last: files made, replaced or deleted there. Nothing where folders cannot be synced."""
    with suppress(OSError):  # Windows opens no folders
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
