"""Possible contents of a disk after a power cut: everything synced, and any part of the rest."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from tests.campaigns.crash.syncs import Operation

SECTOR = 512
"""Smallest piece that a disk writes whole, bytes."""


@dataclass(slots=True)
class _File:
    """A file: its content certainly on the disk (None: no file), and later operations."""

    synced: bytearray | None = None
    unsynced: list[Operation] = field(default_factory=list[Operation])

    def settle(self) -> None:
        """Mark everything as on the disk."""
        for operation in self.unsynced:
            self.synced = applied(self.synced, operation)
        self.unsynced.clear()


def applied(content: bytearray | None, operation: Operation) -> bytearray | None:
    """Return a file's content after one operation."""
    if operation.kind == "delete":
        return None
    content = bytearray() if content is None else content
    if operation.kind == "truncate":
        del content[operation.at :]
        return content
    if len(content) < operation.at:
        content.extend(bytes(operation.at - len(content)))
    content[operation.at : operation.at + len(operation.data)] = operation.data
    return content


class Disk:
    """Replays operations and returns the images that a power cut between them may leave."""

    def __init__(self) -> None:
        self.files: dict[str, _File] = {}

    def play(self, operation: Operation) -> None:
        """Apply one operation."""
        if operation.kind == "mark":
            return
        file = self.files.setdefault(operation.file, _File())
        if operation.kind == "sync":
            file.settle()
        else:
            file.unsynced.append(operation)
            if operation.kind == "delete" and operation.at:
                file.settle()  # the folder was synced with it

    def image(self, random: Random) -> dict[str, bytes]:
        """Return the files after a cut now: of unsynced data all, nothing, or any sectors, the last one torn."""
        how = random.choice(("nothing", "all", "sectors", "sectors", "prefix", "prefix"))
        found: dict[str, bytes] = {}
        for name, file in self.files.items():
            content = None if file.synced is None else bytearray(file.synced)
            for operation in _survivors(file.unsynced, how, random):
                content = applied(content, operation)
            if content is not None:
                found[name] = bytes(content)
        return found


def _survivors(operations: list[Operation], how: str, random: Random) -> list[Operation]:
    if how == "nothing" or not operations:
        return []
    if how == "all":
        return operations
    if how == "prefix":
        count = random.randrange(len(operations) + 1)
        kept, torn = operations[:count], operations[count : count + 1]
        if torn and torn[0].kind == "write":
            kept = [*kept, _piece(torn[0], 0, random.randrange(len(torn[0].data) + 1))]
        return kept
    kept = []
    for operation in operations:
        if operation.kind != "write":
            if random.random() < 0.5:
                kept.append(operation)
            continue
        for first in range(0, len(operation.data), SECTOR):
            if random.random() < 0.5:
                kept.append(_piece(operation, first, SECTOR))
    return kept


def _piece(write: Operation, first: int, size: int) -> Operation:
    return Operation("write", write.file, write.at + first, write.data[first : first + size])


def put(image: dict[str, bytes], folder: Path) -> None:
    """Write an image into an empty folder; the shared-memory file never survives."""
    folder.mkdir(parents=True)
    for name, content in image.items():
        if not name.endswith("-shm"):
            (folder / name).write_bytes(content)
