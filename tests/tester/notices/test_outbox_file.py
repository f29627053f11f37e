"""The outbox's file after a kill at any byte."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from tester.notices.mailing import KEPT_S, Mailing
from tester.notices.outbox_file import OutboxFile, entries_in, line_of, read_entries
from tests.tester.notices.scene import NOON_S, OutboxScene, PlayedChannel, mail_settings, notice


def test_records_are_read_as_they_were_written(tmp_path: Path) -> None:
    file = OutboxFile(tmp_path / ".notices" / "outbox")
    entries = [{"k": "note", "text": 'a "line"\nand \u20ac'}, {"k": "sent"}]
    for entry in entries:
        file.append(entry)
    assert read_entries(file.path) == entries


def test_a_file_cut_at_any_byte_gives_the_whole_records_before_it_and_takes_further_ones(tmp_path: Path) -> None:
    lines = [line_of({"k": "note", "number": n, "text": "x" * n}) for n in range(3)]
    whole = b"".join(lines)
    path = tmp_path / "outbox"
    for cut in range(len(whole) + 1):
        path.write_bytes(whole[:cut])
        file = OutboxFile(path)
        file.append({"k": "after"})
        file.close()
        found = [entry.get("number", entry["k"]) for entry in read_entries(path)]
        complete = sum(len(b"".join(lines[: n + 1])) - 1 <= cut for n in range(3))
        assert found == [*range(complete), "after"], cut


def test_a_changed_byte_makes_a_record_count_as_never_written() -> None:
    line = line_of({"k": "note", "number": 1})
    for place in range(len(line) - 1):
        changed = bytearray(line)
        changed[place] ^= 0x04
        assert list(entries_in(bytes(changed))) == [], place


@pytest.mark.skipif(os.name != "posix", reason="modes are POSIX's")
def test_only_its_owner_may_read_it(tmp_path: Path) -> None:
    file = OutboxFile(tmp_path / ".notices" / "outbox")
    file.append({"k": "note"})
    file.replace([{"k": "note"}])
    assert stat.S_IMODE(file.path.stat().st_mode) == 0o600
    assert stat.S_IMODE(file.path.parent.stat().st_mode) == 0o700


def test_a_large_outbox_loses_at_a_start_only_old_and_settled_notices(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    channel = PlayedChannel()
    settings = mail_settings(1)
    scene = OutboxScene(tmp_path, settings, channel=channel)
    scene.take(notice(1))
    scene.dispatch.channels = {}
    scene.take(notice(2))
    before = scene.file.size
    scene.close()
    monkeypatch.setattr("tester.notices.dispatch.LARGE", 10)
    later = OutboxScene(tmp_path, settings, channel=channel, now_s=NOON_S + KEPT_S + 1.0)
    assert [one.notice.number for one in later.dispatch.mailing.waiting()] == ["s1-2"]
    assert later.file.size < before
    later.work()
    assert [letter.notice.number for _, letter in channel.taken] == ["s1-1", "s1-2"]
    assert Mailing.of(read_entries(later.file.path)).waiting() == []
