"""Every write, truncation, sync and deletion by SQLite, in order: the basis of simulated power cuts.

A thin layer around SQLite's own file layer (its "VFS"), put in with ctypes: it records the four calls that change a
file, then makes them. Works where Python's sqlite3 is linked against a shared SQLite, as in Linux distributions;
elsewhere ``unavailable`` gives the reason.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_POINTER = ctypes.c_void_p
_OPEN = ctypes.CFUNCTYPE(ctypes.c_int, _POINTER, _POINTER, _POINTER, ctypes.c_int, _POINTER)
_DELETE = ctypes.CFUNCTYPE(ctypes.c_int, _POINTER, _POINTER, ctypes.c_int)
_WRITE = ctypes.CFUNCTYPE(ctypes.c_int, _POINTER, _POINTER, ctypes.c_int, ctypes.c_int64)
_TRUNCATE = ctypes.CFUNCTYPE(ctypes.c_int, _POINTER, ctypes.c_int64)
_SYNC = ctypes.CFUNCTYPE(ctypes.c_int, _POINTER, ctypes.c_int)


class _Vfs(ctypes.Structure):
    """``sqlite3_vfs`` up to the replaced fields, and room for the rest of version 3."""

    _fields_ = [
        ("version", ctypes.c_int),
        ("file_size", ctypes.c_int),
        ("longest_path", ctypes.c_int),
        ("next", _POINTER),
        ("name", ctypes.c_char_p),
        ("data", _POINTER),
        ("open", _POINTER),
        ("delete", _POINTER),
        ("rest", _POINTER * 14),
    ]


class _Methods(ctypes.Structure):
    """``sqlite3_io_methods`` of version 3."""

    _fields_ = [
        ("version", ctypes.c_int),
        ("close", _POINTER),
        ("read", _POINTER),
        ("write", _POINTER),
        ("truncate", _POINTER),
        ("sync", _POINTER),
        ("rest", _POINTER * 13),
    ]


@dataclass(frozen=True, slots=True)
class Operation:
    """One call: ``kind`` write, truncate, sync, delete or mark. ``at``: offset, or size after a truncation."""

    kind: str
    file: str
    at: int = 0
    data: bytes = b""
    mark: tuple[Any, ...] = ()


class SyncLog:
    """The operations on the files of one folder, in order, and marks that the test puts between them."""

    def __init__(self) -> None:
        self.operations: list[Operation] = []

    def mark(self, *what: Any) -> None:
        """Record a mark here."""
        self.operations.append(Operation("mark", "", mark=what))


class _Layer:
    """The layer; one for the process, switched on by ``recording``."""

    def __init__(self) -> None:
        self.log: SyncLog | None = None
        self.folder = ""
        self.library = _library()
        find = self.library.sqlite3_vfs_find
        find.restype, find.argtypes = ctypes.POINTER(_Vfs), [ctypes.c_char_p]
        self.original = find(None)
        self.vfs = _Vfs.from_buffer_copy(self.original.contents)
        self.vfs.name = b"noting"
        self.names: dict[int, str] = {}
        self.methods: dict[int, tuple[_Methods, list[object]]] = {}
        self._open, self._delete = _OPEN(self.open), _DELETE(self.delete)
        self._real_open, self._real_delete = _OPEN(self.vfs.open), _DELETE(self.vfs.delete)
        self.vfs.open = ctypes.cast(self._open, _POINTER)
        self.vfs.delete = ctypes.cast(self._delete, _POINTER)
        register = self.library.sqlite3_vfs_register
        register.argtypes = [_POINTER, ctypes.c_int]
        self.register = register

    def noted(self, operation: str, file: str, at: int = 0, data: bytes = b"") -> None:
        if self.log is not None and file.startswith(self.folder):
            self.log.operations.append(Operation(operation, Path(file).name, at, data))

    def open(self, vfs: int, name: int, file: int, flags: int, out: int) -> int:
        code = self._real_open(vfs, name, file, flags, out)
        if code == 0 and name:
            self.names[file] = (ctypes.string_at(name)).decode()
            place = ctypes.cast(file, ctypes.POINTER(_POINTER))
            place[0] = ctypes.addressof(self._noting(place[0]))
        return code

    def delete(self, vfs: int, name: int, durable: int) -> int:
        code = self._real_delete(vfs, name, durable)
        if code == 0:
            self.noted("delete", ctypes.string_at(name).decode(), durable)
        return code

    def _noting(self, address: int) -> _Methods:
        if address in self.methods:
            return self.methods[address][0]
        methods = _Methods.from_buffer_copy(ctypes.cast(address, ctypes.POINTER(_Methods)).contents)
        write, truncate, sync = _WRITE(methods.write), _TRUNCATE(methods.truncate), _SYNC(methods.sync)

        def on_write(file: int, data: int, size: int, at: int) -> int:
            code = write(file, data, size, at)
            self.noted("write", self.names[file], at, ctypes.string_at(data, size))
            return code

        def on_truncate(file: int, size: int) -> int:
            code = truncate(file, size)
            self.noted("truncate", self.names[file], size)
            return code

        def on_sync(file: int, flags: int) -> int:
            code = sync(file, flags)
            self.noted("sync", self.names[file])
            return code

        kept: list[object] = [_WRITE(on_write), _TRUNCATE(on_truncate), _SYNC(on_sync)]
        for name, function in zip(("write", "truncate", "sync"), kept, strict=True):
            setattr(methods, name, ctypes.cast(function, _POINTER))  # type: ignore[arg-type]
        self.methods[address] = (methods, kept)
        return methods


def _library() -> ctypes.CDLL:
    """Return the SQLite that Python's own module uses; raises OSError where there is no such shared library."""
    name = ctypes.util.find_library("sqlite3")
    if name is None:
        raise OSError("there is no shared SQLite library")
    library = ctypes.CDLL(name)
    library.sqlite3_sourceid.restype = ctypes.c_char_p
    connection = sqlite3.connect(":memory:")
    ours = connection.execute("SELECT sqlite_source_id()").fetchone()[0]
    connection.close()
    if library.sqlite3_sourceid().decode() != ours:
        raise OSError("Python's sqlite3 has an SQLite of its own inside")
    return library


_layer: list[_Layer] = []


def unavailable(folder: Path) -> str:
    """Return why file operations cannot be recorded here; empty if they can. ``folder``: an empty one to try in."""
    try:
        with recording(folder) as log:
            connection = sqlite3.connect(folder / "try.db")
            connection.execute("CREATE TABLE t (x)")
            connection.close()
    except OSError as error:
        return str(error)
    return "" if any(o.kind == "sync" for o in log.operations) else "Python's sqlite3 does not use the shared SQLite"


@contextmanager
def recording(folder: Path) -> Iterator[SyncLog]:
    """Record SQLite's operations on files in a folder that are opened inside the block."""
    if not _layer:
        _layer.append(_Layer())
    layer, log = _layer[0], SyncLog()
    layer.log, layer.folder = log, str(folder.resolve())
    layer.register(ctypes.addressof(layer.vfs), 1)
    try:
        yield log
    finally:
        layer.register(ctypes.addressof(layer.original.contents), 1)
        layer.log = None
