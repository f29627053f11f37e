"""The record of a commissioning: appended to, chained, synced, readable after a kill."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.machine.commission.commission_step import CommissionStep, sections_sha256
from tester.machine.commission.record import BEGUN, DONE, READING, REFUSED, CommissionRecord, RecordError, standing_of
from tester.run.kind_lookup import load_rig


def utc() -> str:
    return "2026-11-23T10:00:00Z"


def filled(path: Path) -> CommissionRecord:
    record = CommissionRecord(path, utc, "me")
    record.add("rig", "a" * 64, "s1", "one", BEGUN)
    record.add("rig", "a" * 64, "s1", "one", READING, "first", {"way_mm": 1.25})
    record.add("rig", "a" * 64, "s1", "one", DONE, "passed", {"scale": 1.0})
    return record


def test_an_added_entry_reads_back(tmp_path: Path) -> None:
    written = filled(tmp_path / "r.jsonl")
    read = CommissionRecord(tmp_path / "r.jsonl", utc, "you")
    assert read.entries == written.entries
    assert read.standing("one", "s1") == written.entries[-1]
    assert read.standing("one", "s2") is None
    assert read.standing("two", "s1") is None


@pytest.mark.parametrize("cut", range(1, 400, 7))
def test_a_line_cut_off_by_a_kill_is_skipped_and_work_continues_behind_it(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "r.jsonl"
    filled(path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    record = CommissionRecord(path, utc, "me")
    before = len(record.entries)
    record.add("rig", "a" * 64, "s1", "one", DONE, "again")
    assert len(CommissionRecord(path, utc, "me").entries) == before + 1
    record.add("rig", "a" * 64, "s1", "two", BEGUN)
    assert len(CommissionRecord(path, utc, "me").entries) == before + 2


def test_a_changed_line_is_found(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    filled(path)
    path.write_text(path.read_text().replace("1.25", "1.26"))
    with pytest.raises(RecordError, match="line 3"):
        CommissionRecord(path, utc, "me")


def test_a_line_taken_out_is_found(tmp_path: Path) -> None:
    path = tmp_path / "r.jsonl"
    filled(path)
    lines = path.read_text().splitlines(keepends=True)
    path.write_text(lines[0] + lines[2])
    with pytest.raises(RecordError, match="line 2"):
        CommissionRecord(path, utc, "me")


def test_not_a_number_is_not_written(tmp_path: Path) -> None:
    record = CommissionRecord(tmp_path / "r.jsonl", utc, "me")
    with pytest.raises(ValueError, match="JSON"):
        record.add("rig", "", "", "one", READING, "", {"x": float("nan")})
    assert not (tmp_path / "r.jsonl").exists()


STEP = CommissionStep("jog", "a jog", ("can",))


@pytest.mark.parametrize(
    ("what", "same", "words"),
    [
        (DONE, True, "done on 2026-11-23, me: told"),
        (DONE, False, "to be done again (the rig file has changed under it, 2026-11-23): told"),
        (BEGUN, True, "to be done again (was cut off, 2026-11-23): told"),
        (REFUSED, True, "to be done again (refused, 2026-11-23): told"),
    ],
)
def test_the_newest_entry_and_the_rig_file_decide_the_state_of_a_step(
    what: str, same: bool, words: str, tmp_path: Path
) -> None:
    rig = load_rig("sim")
    record = CommissionRecord(tmp_path / "r.jsonl", lambda: "2026-11-23T10:00:00Z", "me")
    (fresh,) = standing_of(record, (STEP,), rig)
    assert fresh.words == "to be done" and fresh.stands is None
    record.add("rig", "", sections_sha256(rig, STEP.sections) if same else "another", "jog", what, "told")
    (found,) = standing_of(record, (STEP,), rig)
    assert found.words == words and (found.stands is not None) == (what == DONE and same)
