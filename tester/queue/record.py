"""The queue's record: a file of one JSON object a line, which only grows, synced before a change counts.

A line holds an event and a hash over it and the line before it. After a power cut the file may end in part of a line,
or in the zeros of a block that was never written: that end was never confirmed and is cut off. Any other
difference from what was written is damage; the queue then refuses to begin anything.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from hashlib import sha256
from pathlib import Path
from typing import Final, Self

from pydantic import ValidationError

from tester.base import clock
from tester.queue.events import QUEUE_LINE, QueueEvent, QueueLine
from tester.queue.fold import Queue, QueueError, applied
from tester.store.disk import sync_folder

RECORD: Final = "queue.jsonl"
FIRST: Final = "0" * 32
"""The chain before the first line."""


class QueueRecordError(QueueError):
    """The record cannot be read or written; the message gives file, line and reason."""


def line_of(recorded: QueueLine, chain: str) -> tuple[bytes, str]:
    """Return an event as a line, and the chain after it; ``chain``: of the line before."""
    body = QUEUE_LINE.dump_json(recorded)
    after = _linked(chain, body)
    return b'{"chain":"' + after.encode() + b'","entry":' + body + b"}\n", after


def _linked(chain: str, body: bytes) -> str:
    return sha256(chain.encode() + body).hexdigest()[:32]


def read_lines(data: bytes, name: str = RECORD) -> Iterator[tuple[QueueLine, str, int]]:
    """Yield every confirmed event with the chain after it, and the place of its end in ``data``.

    Raises QueueRecordError for damage.
    """
    chain, at = FIRST, 0
    for number, line in enumerate(data.split(b"\n")[:-1], start=1):
        end = at + len(line) + 1
        recorded, after = _read(line, chain)
        if recorded is None or recorded.n != number:
            if b"\0" in line and not _any_valid(data[end:]):
                return  # blocks of the last line that were never written
            raise QueueRecordError(f"{name}:{number}: the line is damaged, or was changed by another program")
        yield recorded, after, end
        chain, at = after, end


def _read(line: bytes, chain: str) -> tuple[QueueLine | None, str]:
    head, parted, rest = line.partition(b',"entry":')
    if not parted or not rest.endswith(b"}"):
        return None, ""
    body = rest[:-1]
    after = _linked(chain, body)
    if head != b'{"chain":"' + after.encode() + b'"':
        return None, ""
    try:
        return QUEUE_LINE.validate_json(body), after
    except ValidationError:
        return None, ""


def _any_valid(rest: bytes) -> bool:
    """Return whether a complete line follows: then the damage is no torn end."""
    for line in rest.split(b"\n")[:-1]:
        try:
            json.loads(line)
        except ValueError:
            continue
        return True
    return False


def read_queue(folder: Path) -> Queue:
    """Return the queue in a folder without changing anything; empty where there is none. Raises QueueError."""
    path = folder / RECORD
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return Queue()
    except OSError as error:
        raise QueueRecordError(f"{path} cannot be read: {error}") from error
    queue = Queue()
    for recorded, _, _ in read_lines(data, str(path)):
        queue = applied(queue, recorded)
    return queue


class QueueRecord:
    """The record, open for one writer. ``queue`` is the fold of what is on the disk."""

    def __init__(self, folder: Path, utc: Callable[[], str] = clock.utc_now) -> None:
        """Open or make the record in ``folder``, and cut off a torn end. Raises QueueError, OSError."""
        folder.mkdir(parents=True, exist_ok=True)
        self.path = folder / RECORD
        self._utc = utc
        self.queue, self._chain, end = Queue(), FIRST, 0
        new = not self.path.exists()
        data = b"" if new else self.path.read_bytes()
        for recorded, chain, place in read_lines(data, str(self.path)):
            self.queue, self._chain, end = applied(self.queue, recorded), chain, place
        self.torn = len(data) - end
        """Bytes of an unconfirmed change that were cut off."""
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_BINARY", 0)
        self._file = os.open(self.path, flags, 0o600)
        try:
            if self.torn:
                os.ftruncate(self._file, end)
                os.fsync(self._file)
            os.lseek(self._file, end, os.SEEK_SET)
        except OSError:
            os.close(self._file)
            raise
        if new:
            sync_folder(folder)
        self._end = end

    def __enter__(self) -> Self:
        """Return the record."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        if self._file >= 0:
            os.close(self._file)
        self._file = -1

    def prepared(self, what: QueueEvent, queue: Queue | None = None) -> tuple[QueueLine, Queue]:
        """Return an event with its number, and the queue after it, without writing. Raises QueueError."""
        before = self.queue if queue is None else queue
        recorded = QueueLine(before.revision + 1, self._utc(), what)
        return recorded, applied(before, recorded)

    def append(self, what: QueueEvent) -> Queue:
        """Write an event and sync it; return the queue. Raises QueueError, and OSError: then nothing has changed."""
        recorded, after = self.prepared(what)
        line, chain = line_of(recorded, self._chain)
        try:
            self._write(line)
        except OSError:
            self._undo()
            raise
        self._end += len(line)
        self.queue, self._chain = after, chain
        return after

    def _write(self, line: bytes) -> None:
        rest = memoryview(line)
        while rest:
            rest = rest[os.write(self._file, rest) :]
        os.fsync(self._file)

    def _undo(self) -> None:
        """Remove what a failed write left; a record that cannot be put right is not written again."""
        try:
            os.ftruncate(self._file, self._end)
            os.lseek(self._file, self._end, os.SEEK_SET)
        except OSError:
            self.close()
