"""The queue's record: cut at any byte, damaged, written to a failing disk."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tester.queue.events import (
    ItemAdded,
    ItemAgreed,
    ItemBegan,
    ItemDropped,
    ItemEnded,
    ItemMoved,
    ItemReturned,
    ItemSkipped,
    ItemTaken,
    QueueEvent,
    QueueStarted,
    QueueStood,
)
from tester.queue.fold import Queue, QueueError
from tester.queue.items import End, Hashes
from tester.queue.record import RECORD, QueueRecord, QueueRecordError, read_queue
from tests.tester.queue.made import UTC, item, queue_of

STORY: tuple[QueueEvent, ...] = (
    ItemAdded(item(1, name="Ω \u2028 name")),
    ItemAdded(item(2)),
    ItemAdded(item(3)),
    ItemMoved(3, 1, "anna"),
    ItemSkipped(2, "anna"),
    QueueStarted("anna"),
    ItemTaken(3),
    ItemBegan(3, "run-3"),
    ItemEnded(3, End.DONE, "", "run-3"),
    ItemTaken(1),
    ItemReturned(1, "the disk is full"),
    ItemAgreed(1, Hashes("dd", "ee"), "anna"),
    ItemDropped(2, "anna"),
    QueueStarted("anna"),
    QueueStood("stood by anna", "anna"),
)
"""Every kind of event at least once."""


@pytest.fixture
def written(tmp_path: Path) -> bytes:
    with QueueRecord(tmp_path / "first", lambda: UTC) as record:
        for event in STORY:
            record.append(event)
    return (tmp_path / "first" / RECORD).read_bytes()


def ends(data: bytes) -> list[int]:
    return [at + 1 for at, byte in enumerate(data) if byte == ord("\n")]


def test_the_record_gives_the_queue_of_its_events(tmp_path: Path, written: bytes) -> None:
    assert read_queue(tmp_path / "first") == queue_of(*STORY)


def test_cut_at_any_byte_it_gives_the_queue_of_the_confirmed_events(tmp_path: Path, written: bytes) -> None:
    folder, whole = tmp_path / "cut", ends(written)
    folder.mkdir()
    queues = [queue_of(*STORY[:count]) for count in range(len(STORY) + 1)]
    every = {*range(whole[0] + 1), *range(whole[0], whole[-2], 3), *whole, *range(whole[-2], len(written) + 1)}
    for size in sorted(every):
        (folder / RECORD).write_bytes(written[:size])
        assert read_queue(folder) == queues[sum(end <= size for end in whole)], size


def test_a_torn_end_is_cut_off_and_the_record_continues(tmp_path: Path, written: bytes) -> None:
    folder = tmp_path / "cut"
    folder.mkdir()
    before = ends(written)[-2]
    for size in (before + 1, before + 40, len(written) - 1):
        (folder / RECORD).write_bytes(written[:size])
        with QueueRecord(folder, lambda: UTC) as record:
            assert record.torn == size - before
            record.append(STORY[-1])
        assert read_queue(folder) == queue_of(*STORY)


@pytest.mark.parametrize("tail", [b"\0" * 512, b"\0" * 90 + b'"}}\n', b'{"chain":"' + b"\0" * 100 + b"}}\n"])
def test_blocks_that_were_never_written_are_a_torn_end(tmp_path: Path, written: bytes, tail: bytes) -> None:
    (tmp_path / RECORD).write_bytes(written + tail)
    with QueueRecord(tmp_path) as record:
        assert (record.queue, record.torn) == (queue_of(*STORY), len(tail))


def test_any_changed_byte_of_a_confirmed_line_is_damage(tmp_path: Path, written: bytes) -> None:
    for at in range(0, len(written), 7):
        changed = bytearray(written)
        changed[at] ^= 1
        (tmp_path / RECORD).write_bytes(changed)
        if changed[at : at + 1] == b"\n" or written[at : at + 1] == b"\n":
            continue
        with pytest.raises(QueueRecordError, match=r"queue\.jsonl:\d+: the line is damaged"):
            read_queue(tmp_path)


def test_a_line_that_is_gone_is_damage(tmp_path: Path, written: bytes) -> None:
    lines = written.splitlines(keepends=True)
    for gone in range(len(lines) - 1):
        (tmp_path / RECORD).write_bytes(b"".join(lines[:gone] + lines[gone + 1 :]))
        with pytest.raises(QueueRecordError):
            read_queue(tmp_path)


def test_zeros_before_a_whole_line_are_damage(tmp_path: Path, written: bytes) -> None:
    lines = written.splitlines(keepends=True)
    (tmp_path / RECORD).write_bytes(b"".join(lines[:-1]) + b"\0" * 8 + b"\n" + lines[-1])
    with pytest.raises(QueueRecordError):
        read_queue(tmp_path)


def test_a_change_that_the_disk_refuses_has_not_happened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with QueueRecord(tmp_path, lambda: UTC) as record:
        record.append(STORY[0])

        def full(_file: int) -> None:
            raise OSError(28, "No space left on device")

        with monkeypatch.context() as patch:
            patch.setattr(os, "fsync", full)
            with pytest.raises(OSError, match="No space left"):
                record.append(STORY[1])
        assert record.queue == read_queue(tmp_path) == queue_of(STORY[0])
        record.append(STORY[1])
    assert read_queue(tmp_path) == queue_of(*STORY[:2])


def test_an_impossible_change_writes_nothing(tmp_path: Path) -> None:
    with QueueRecord(tmp_path) as record, pytest.raises(QueueError, match="no item 4: it is empty"):
        record.append(ItemDropped(4, "anna"))
    assert (tmp_path / RECORD).read_bytes() == b""


def test_each_line_is_on_the_disk_before_append_returns(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    real = os.fsync

    def fsync(file: int) -> None:
        real(file)
        synced.append(os.fstat(file).st_size)

    with QueueRecord(tmp_path, lambda: UTC) as record:
        monkeypatch.setattr(os, "fsync", fsync)
        for event in STORY[:3]:
            record.append(event)
            assert synced[-1] == (tmp_path / RECORD).stat().st_size
    assert len(synced) == 3


def test_no_record_is_an_empty_queue_and_makes_no_file(tmp_path: Path) -> None:
    assert read_queue(tmp_path / "none") == Queue()
    assert not (tmp_path / "none").exists()
