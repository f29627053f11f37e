"""Exclusive use of a rig: one lock a bus, held by the operating system, released by it when a process dies.

The lock files stay where they are (removing one would let two processes lock two files of the same name); what is in
one says who holds it. POSIX: flock. Windows: a locked byte behind the text (not tried there).
"""

from __future__ import annotations

import json
import os
import re
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from getpass import getuser
from hashlib import sha256
from pathlib import Path
from typing import cast

from tester import clock

FOLDER_VARIABLE = "TESTER_LOCKS"
"""Environment variable that names another folder for lock files; everybody at one rig has to use the same."""

RUN_LOCK = ".lock"
"""Name of the lock file in the folder of a run that is under way."""

_TEXT_AT_MOST = 4096
"""Bytes of a lock file that say who holds it; a locked byte on Windows lies behind them."""


@dataclass(frozen=True, slots=True)
class Holder:
    """Who uses a bus: process, user, since when (UTC), for which run."""

    pid: int
    user: str
    since_utc: str
    run: str

    def describe(self) -> str:
        """Return a line for people."""
        what = f", for {self.run}" if self.run else ""
        return f"process {self.pid} of user {self.user} since {self.since_utc}{what}"


class RigInUseError(Exception):
    """Somebody else uses the rig; the message says who."""


class ExclusiveUse:
    """Locks, held until ``release`` or the end of the process; use in a ``with`` block."""

    def __init__(self, folder: Path | None = None) -> None:
        """Hold nothing yet. ``folder``: of the lock files, by default one for the whole machine."""
        self._folder = folder
        self._held: list[int] = []
        self._files: list[Path] = []

    def lock(self, resources: Sequence[str], run: str) -> None:
        """Lock the buses of a rig (texts such as ``can socketcan:can0``); raises RigInUseError at once, OSError.

        ``run`` is told to whoever is refused.
        """
        for resource in sorted(set(resources)):
            self.lock_file(resource, (self._folder or lock_folder()) / _file_name(resource), run)

    def lock_file(self, resource: str, path: Path, run: str, *, lasting: bool = True) -> None:
        """Lock one file; one that is not ``lasting`` goes when it is released. Raises RigInUseError, OSError."""
        holder = Holder(os.getpid(), user(), clock.utc_now(), run)
        self._held.append(_locked(path, resource, holder, mode=0o666 if lasting else 0o644))
        if not lasting:
            self._files.append(path)

    def release(self) -> None:
        """Let go of every lock."""
        while self._files:
            self._files.pop().unlink(missing_ok=True)  # while it is still ours
        while self._held:
            os.close(self._held.pop())

    def __enter__(self) -> ExclusiveUse:
        """Return the locks."""
        return self

    def __exit__(self, *_: object) -> None:
        """Let go of every lock."""
        self.release()


def user_of(path: Path) -> Holder | None:
    """Return who holds a lock file at present, None where nobody does."""
    try:
        descriptor = os.open(path, os.O_RDONLY)
    except OSError:
        return None
    try:
        return None if _try_lock(descriptor) else holder_of(path) or Holder(0, "unknown", "unknown", "")
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
    """Return who last wrote into a lock file, None where that cannot be read."""
    try:
        said = cast(object, json.loads(path.read_bytes()[:_TEXT_AT_MOST].rstrip(b"\0 \n")))
    except (OSError, ValueError):
        return None
    if not isinstance(said, dict):
        return None
    texts = {str(key): str(value) for key, value in cast(dict[object, object], said).items()}
    pid = texts.get("pid", "")
    return Holder(int(pid) if pid.isdecimal() else 0, *(texts.get(key, "") for key in ("user", "since_utc", "run")))


def _file_name(resource: str) -> str:
    """Return the name of a resource's lock file; the short hash keeps names apart that differ in odd characters."""
    name = re.sub(r"[^A-Za-z0-9]+", "-", resource).strip("-")[:40]
    return f"friction-tester-{name}-{sha256(resource.encode()).hexdigest()[:8]}.lock"


def _locked(path: Path, resource: str, holder: Holder, *, mode: int) -> int:
    """Return the descriptor of a lock file that is ours now."""
    while True:
        descriptor = _open(path, mode)
        try:
            if not _try_lock(descriptor):
                other = holder_of(path)
                who = other.describe() if other is not None else "another process"
                raise RigInUseError(f"{resource} is in use: {who}")
            if _still_there(path, descriptor):
                os.ftruncate(descriptor, 0)
                os.write(descriptor, json.dumps(asdict(holder), ensure_ascii=False).encode()[:_TEXT_AT_MOST])
                return descriptor
        except (RigInUseError, OSError):
            os.close(descriptor)
            raise
        os.close(descriptor)  # its holder removed it between our opening and our locking it


def _still_there(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _open(path: Path, mode: int) -> int:
    """Open a lock file; one for the whole machine may be locked by everybody, whoever made it."""
    try:
        # Not O_CREAT where it exists: Linux forbids that for somebody else's file in a sticky folder.
        return os.open(path, os.O_RDWR)
    except FileNotFoundError:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, mode)
    if hasattr(os, "fchmod"):
        os.fchmod(descriptor, mode)  # whatever the umask is
    return descriptor


if sys.platform == "win32":
    import msvcrt

    def _try_lock(descriptor: int) -> bool:
        os.lseek(descriptor, _TEXT_AT_MOST, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        os.lseek(descriptor, 0, os.SEEK_SET)
        return True

else:
    import fcntl

    def _try_lock(descriptor: int) -> bool:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True


def user() -> str:
    try:
        return getuser()
    except (KeyError, OSError):  # no such user here, as in many containers
        return "unknown"
