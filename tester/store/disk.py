"""Writes files that are complete or absent, even after a power cut; measures free disk space for a run."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from threading import Thread

from tester.inputs.recipe.plan import Plan
from tester.inputs.recipe.time_estimate import Estimate

ROW_BYTES = 60.0
"""Size of a recorded sample in its block, with its share of the log and of the tables, bytes (measured: 38 to 55)."""
CONTACT_ROWS_S = 60.0
"""Samples per rig second of a step in contact: 100 in slip, 20 while rolling (interface: exports). Simulated runs of
the shipped recipes record 25 to 40."""
IDLE_ROWS_S = 2.0
FIXED_BYTES = 2_000_000.0
"""Size of recipe, rig file, journal, device parameters, tables, and the log before its checkpoint, bytes."""
MARGIN = 2.0
"""Required free space, as a multiple of the estimate [A]."""


def free_bytes(folder: Path) -> int:
    """Return the free space under a folder, bytes; this may block for ever on a network share. Raises OSError."""
    return shutil.disk_usage(folder).free


class FreeRoom:
    """The latest known free space under a folder. A thread measures it, so that callers never wait for a disk that
    hangs.
    """

    def __init__(self, folder: Path, ask: Callable[[Path], int] = free_bytes) -> None:
        """``folder``: if it is missing, the working folder is measured; ``ask``: as ``free_bytes``."""
        self.folder = folder
        self.hangs = False
        """Whether the previous measurement was still running when the next was due."""
        self._free: int | None = None
        self._ask = ask
        self._asking: Thread | None = None

    @property
    def free(self) -> int | None:
        """Return the free space in bytes; None before the first result, after an error, or while the disk hangs."""
        return None if self.hangs else self._free

    def look(self) -> None:
        """Start a new measurement, unless one is still running; never waits."""
        self.hangs = self._asking is not None and self._asking.is_alive()
        if not self.hangs:
            self._asking = Thread(target=self._work, name="free room", daemon=True)
            self._asking.start()

    def wait(self, seconds: float) -> None:
        """Wait at most ``seconds`` for the result; for use while nothing is under control."""
        if self._asking is not None:
            self._asking.join(seconds)

    def _work(self) -> None:
        try:
            self._free = self._ask(self.folder if self.folder.is_dir() else Path())
        except OSError:
            self._free = None


def expected_bytes(plan: Plan, expected: Estimate) -> float:
    """Return the disk space that a run of the plan will take, bytes; ``expected`` is the plan's estimate."""
    rows = 0.0
    for step, estimate in zip(plan.steps, expected.steps, strict=True):
        in_contact = step.contact
        rows += estimate.seconds * (CONTACT_ROWS_S if in_contact else IDLE_ROWS_S)
    return FIXED_BYTES + ROW_BYTES * rows


def too_little_room(folder: Path, needed: float) -> str:
    """Return why the space under a folder is too small for ``needed`` bytes, with the numbers; empty if it is
    enough.
    """
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
    """Call ``fill`` to write a temporary file, sync it, and rename it to ``path``; raises OSError."""
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
    """Write a text as UTF-8 with unchanged line ends, completely or not at all, and sync it; raises OSError."""

    def fill(part: Path) -> None:
        part.write_bytes(text.encode())

    write_whole(path, fill)


RESERVE = ".reserve.part"
"""Suffix of a file that reserves space; no manifest lists these files."""


class Reserve:
    """Reserves disk space until it is needed."""

    def __init__(self, path: Path, size: int) -> None:
        """Reserve ``size`` bytes in a file next to ``path``; if there is less space, reserve none."""
        self._path = path.with_name(path.name + RESERVE)
        try:
            with self._path.open("wb") as file:
                if hasattr(os, "posix_fallocate"):
                    os.posix_fallocate(file.fileno(), 0, size)
                else:
                    file.write(bytes(size))
        except OSError:
            self.give_up()

    def give_up(self) -> None:
        """Release the space."""
        with suppress(OSError):
            self._path.unlink(missing_ok=True)


def file_identity(path: Path) -> tuple[int, int]:
    """Return device and inode of a file; raises OSError."""
    status = path.stat()
    return status.st_dev, status.st_ino


def sync_folder(folder: Path) -> None:
    """Sync the names in a folder: files created, replaced or deleted there. Do nothing on systems that cannot sync
    folders.
    """
    with suppress(OSError):  # Windows cannot open folders
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
