"""The outbox's file: one record a line, only ever appended to and synced, readable after a kill at any byte.

A line is the CRC-32 of its content (8 hexadecimal digits), a blank and JSON. A line that does not match is what a kill
or a power cut left of a record that counts as never written: the reader skips it, and a writer ends it first.
"""

from __future__ import annotations

import os
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from pydantic import JsonValue
from pydantic_core import from_json, to_json

from tester.store.disk import sync_folder, write_whole

FOLDER: Final = ".notices"
"""Folder of the outbox, in that of the runs."""
FILE: Final = "outbox"
LARGE: Final = 4_000_000
"""Size above which a start leaves out old, settled records, bytes [A]: some thousand notices."""

Entry = Mapping[str, JsonValue]


def outbox_path(runs: Path) -> Path:
    """Return the place of the outbox of the runs in a folder, which need not exist."""
    return runs / FOLDER / FILE


def line_of(entry: Entry) -> bytes:
    """Return a record as a line."""
    content = to_json(entry)
    return b"%08x %s\n" % (zlib.crc32(content), content)


def entries_in(data: bytes) -> Iterator[dict[str, JsonValue]]:
    """Yield the whole records in a file's content, the oldest first."""
    for line in data.split(b"\n"):
        mark, _, content = line.partition(b" ")
        if len(mark) == 8 and b"%08x" % zlib.crc32(content) == mark:
            entry: JsonValue = from_json(content)
            if isinstance(entry, dict):
                yield entry


def read_entries(path: Path) -> list[dict[str, JsonValue]]:
    """Return the records of an outbox; none where there is no file. Raises OSError."""
    try:
        return list(entries_in(path.read_bytes()))
    except FileNotFoundError:
        return []


class OutboxFile:
    """The open file. Only one process may have it open (``tester.base.lock``)."""

    def __init__(self, path: Path) -> None:
        """Open or create the file (mode 0600), and end a line that was cut off. Raises OSError."""
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        self.path = path
        self._file = self._open()
        sync_folder(path.parent)
        if self._cut_off():
            self._write(b"\n")

    def _open(self) -> int:
        return os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0), 0o600)

    def _cut_off(self) -> bool:
        size = os.fstat(self._file).st_size
        if not size:
            return False
        with self.path.open("rb") as file:
            file.seek(size - 1)
            return file.read(1) != b"\n"

    def append(self, entry: Entry) -> None:
        """Append a record; it is on the disk when this returns. Raises OSError; the record may then be there in part.
        """
        self._write(line_of(entry))

    def _write(self, data: bytes) -> None:
        try:
            while data:
                data = data[os.write(self._file, data) :]
            os.fsync(self._file)
        except OSError:
            self._end_line()
            raise

    def _end_line(self) -> None:
        """End a line of which the disk took only a part, so that the next record begins a line."""
        try:
            if self._cut_off():
                os.write(self._file, b"\n")
        except OSError:
            return  # the next start ends it

    def replace(self, entries: list[Entry]) -> None:
        """Replace the whole file at once: after a kill there is the old one or the new one. Raises OSError."""
        os.close(self._file)  # Windows replaces no open file
        try:
            write_whole(self.path, lambda part: _fill(part, entries))
        finally:
            self._file = self._open()

    @property
    def size(self) -> int:
        """Size of the file, bytes."""
        return os.fstat(self._file).st_size

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


def _fill(part: Path, entries: list[Entry]) -> None:
    part.touch(mode=0o600)
    part.write_bytes(b"".join(map(line_of, entries)))
