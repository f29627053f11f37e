"""Errors that people can mend: their base classes, and errors of the operating system in words."""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Mapping
from typing import Final

_IN_WORDS: Final[Mapping[int, tuple[str, str]]] = {
    errno.ENOENT: ("there is no such file or folder", "check the name, and that the folder it lies in is there"),
    errno.EISDIR: ("it is a folder, and a file is wanted", "name a file"),
    errno.ENOTDIR: ("a part of the name is a file, and not a folder", "name another folder"),
    errno.EEXIST: ("it is there already", "name another, or move it away"),
    errno.EACCES: ("permission denied", "choose a folder of your own, or ask its owner"),
    errno.EPERM: ("permission denied", "choose a folder of your own, or ask its owner"),
    errno.EROFS: ("it lies on a read-only file system", "choose another folder"),
    errno.ENOSPC: ("the disk is full", "make room, or choose a folder on another disk"),
    errno.EDQUOT: ("your share of the disk is used up", "make room, or choose a folder on another disk"),
    errno.EFBIG: ("the file would be larger than is allowed", "choose a folder on another disk"),
    errno.ENAMETOOLONG: ("the name is too long", "choose a shorter one"),
    errno.EMFILE: ("too many files are open", "close other programs, or raise the limit (ulimit -n)"),
    errno.ENFILE: ("too many files are open", "close other programs"),
    errno.EIO: ("the disk cannot be read or written", "look at the disk, and at the system's log"),
    errno.EADDRINUSE: ("the address is in use", "choose another port, or stop what uses it"),
    errno.EADDRNOTAVAIL: ("this machine has no such address", "choose one of its own"),
    errno.ECONNREFUSED: ("no program listens there", "start it"),
    errno.EPIPE: ("its reader is gone", ""),
}
"""Reason and remedy by errno."""
_OF_SQLITE: Final[Mapping[int, int]] = {sqlite3.SQLITE_FULL: errno.ENOSPC, sqlite3.SQLITE_IOERR: errno.EIO}
"""Disk errors by SQLite's code."""


class TroubleError(Exception):
    """An error that a person can mend; the message gives the reason. A command prints it and ends with exit code 1."""


class MisuseError(TroubleError):
    """An error of the person's input: a command prints it with its usage line and ends with exit code 2."""


def in_words(error: BaseException) -> str:
    """Return an error in words: ``FILE: why: what to do``; any other than the system's unchanged.

    System errors without an entry get the system's own words.
    """
    if isinstance(error, sqlite3.Error):
        code = getattr(error, "sqlite_errorcode", 0) & 0xFF  # of an extended code the primary one
        return ": ".join(_IN_WORDS[_OF_SQLITE[code]]) if code in _OF_SQLITE else str(error)
    if not isinstance(error, OSError) or error.errno is None:
        return str(error)
    why, advice = _IN_WORDS.get(error.errno, (_system_words(error), ""))
    files = " to ".join(os.fsdecode(name) for name in (error.filename, error.filename2) if _is_name(name))
    return ": ".join(part for part in (files, why, advice) if part)


def _system_words(error: OSError) -> str:
    words = error.strerror or os.strerror(error.errno or 0)
    return words[:1].lower() + words[1:]


def _is_name(name: object) -> bool:
    return isinstance(name, str | bytes) and bool(name)
