"""Exclusive use of a rig: one lock for each bus, held by the operating system, released by it when a process dies.

The locks are filelock's: flock on POSIX, a locked first byte on Windows. Lock files remain, except for a run's own.
From its second byte on, a lock file describes its holder.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from getpass import getuser
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, cast

from tester.base import clock

if TYPE_CHECKING:
    from filelock import FileLock

FOLDER_VARIABLE = "TESTER_LOCKS"
"""Environment variable that names another folder for lock files; all users of one rig must use the same."""

RUN_LOCK = ".lock"
"""Name of the lock file in the folder of a run in progress."""

_TEXT_AT_MOST = 4096
"""Bytes of a lock file that describe its holder, after the first, which no other process can read on Windows."""

_SETTLES_S = 0.02
"""Time for a releasing holder to remove its lock file, s [A]; after that the lock counts as held."""


@dataclass(frozen=True, slots=True)
class Holder:
    """The user of a bus: process, user, since when (UTC), for which run."""

    pid: int
    user: str
    since_utc: str
    run: str

    def describe(self) -> str:
        """Return a line for people."""
        what = f", for {self.run}" if self.run else ""
        return f"process {self.pid} of user {self.user} since {self.since_utc}{what}"


class RigInUseError(Exception):
    """Another process uses the rig; the message names it."""


class ExclusiveUse:
    """Locks, held until ``release`` or the end of the process; use in a ``with`` block."""

    def __init__(self, folder: Path | None = None) -> None:
        """Start without locks. ``folder``: of the lock files, by default one for the whole machine."""
        self._folder = folder
        self._held: list[tuple[FileLock, Path | None]] = []

    def lock(self, resources: Sequence[str], run: str) -> None:
        """Lock the buses of a rig (texts such as ``can socketcan:can0``); never waits; raises RigInUseError, OSError.

        ``run`` is shown to processes that are refused.
        """
        for resource in sorted(set(resources)):
            self.lock_file(resource, (self._folder or lock_folder()) / _file_name(resource), run)

    def lock_file(self, resource: str, path: Path, run: str, *, lasting: bool = True) -> None:
        """Lock one file; one that is not ``lasting`` is removed at its release. Raises RigInUseError, OSError."""
        from filelock import FileLock, Timeout  # only commands that lock pay for it

        holder = json.dumps(asdict(Holder(os.getpid(), user(), clock.utc_now(), run)), ensure_ascii=False).encode()

        def say(descriptor: int) -> None:
            os.ftruncate(descriptor, 0)
            os.write(descriptor, b"\n" + holder[:_TEXT_AT_MOST])

        lock = FileLock(
            path,
            mode=0o666 if lasting else 0o644,  # a lock for the whole machine must be open to all users
            thread_local=False,
            fallback_to_soft=False,  # a file that merely exists would outlive a killed process
            preserve_lock_file=lasting,
            on_acquired=say,
        )
        try:
            lock.acquire(timeout=_SETTLES_S, poll_interval=_SETTLES_S / 4)
        except Timeout:
            other = holder_of(path)
            who = other.describe() if other is not None else "another process"
            raise RigInUseError(f"{resource} is in use: {who}") from None
        self._held.append((lock, None if lasting else path))

    def release(self) -> None:
        """Release every lock."""
        while self._held:
            lock, path = self._held.pop()
            if path is not None:
                with suppress(PermissionError):  # Windows: filelock removes it once it is closed
                    path.unlink(missing_ok=True)  # while it is still ours
            lock.release()

    def __enter__(self) -> ExclusiveUse:
        """Return the locks."""
        return self

    def __exit__(self, *_: object) -> None:
        """Release every lock."""
        self.release()


def user_of(path: Path) -> Holder | None:
    """Return the present holder of a lock file, None without one."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    from filelock import lock_descriptor

    try:
        free = lock_descriptor(descriptor, blocking=False)
        return None if free else holder_of(path) or Holder(0, "unknown", "unknown", "")
    finally:
        os.close(descriptor)


def lock_folder() -> Path:
    """Return the folder of lock files: of ``TESTER_LOCKS``, the machine's for locks, or that of temporary files."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    machine = Path("/run/lock")
    return machine if os.access(machine, os.W_OK) else Path(tempfile.gettempdir())


def holder_of(path: Path) -> Holder | None:
    """Return the last holder described in a lock file, None where it cannot be read."""
    try:
        with path.open("rb") as file:
            file.seek(1)
            stored = cast(object, json.loads(file.read(_TEXT_AT_MOST)))
    except (OSError, ValueError):
        return None
    if not isinstance(stored, dict):
        return None
    texts = {str(key): str(value) for key, value in cast(dict[object, object], stored).items()}
    pid = texts.get("pid", "")
    return Holder(int(pid) if pid.isdecimal() else 0, *(texts.get(key, "") for key in ("user", "since_utc", "run")))


def _file_name(resource: str) -> str:
    """Return the name of a resource's lock file; the short hash separates names that differ in odd characters."""
    name = re.sub(r"[^A-Za-z0-9]+", "-", resource).strip("-")[:40]
    return f"friction-tester-{name}-{sha256(resource.encode()).hexdigest()[:8]}.lock"


def user() -> str:
    try:
        return getuser()
    except (KeyError, OSError):  # no such user here, as in many containers
        return "unknown"
