"""Finding and listing runs."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import pytest

from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.machine.run import Outcome
from tester.store.record_schema import StoreError
from tester.store.run_folders import RunStatus, cut_off, find_run, run_folders, run_status, under_way
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, open_writer, small_run


def test_a_run_is_found_by_folder_file_or_name(tmp_path: Path) -> None:
    folder = small_run(tmp_path / "runs" / "one")
    assert find_run(str(folder)) == folder
    assert find_run(str(folder / "run.db")) == folder
    assert find_run("one", tmp_path / "runs") == folder


def test_a_beginning_names_the_run_that_alone_begins_so(tmp_path: Path) -> None:
    first = small_run(tmp_path / "2024-02-22T10-00-00-a")
    second = small_run(tmp_path / "2024-02-22T10-30-00-b")
    assert find_run("2024-02-22T10-3", tmp_path) == second
    assert find_run(str(tmp_path / "2024-02-22T10-00")) == first
    with pytest.raises(StoreError, match="2 runs begin so: 2024-02-22T10-00-00-a, 2024-02-22T10-30-00-b"):
        find_run("2024-02-22", tmp_path)


def test_a_folder_that_is_no_run_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(StoreError, match="no run empty"):
        find_run("empty", tmp_path)


def test_latest_is_the_newest_run_by_the_date_of_its_name(tmp_path: Path) -> None:
    small_run(tmp_path / "2024-02-22T10-00-00-a")
    small_run(tmp_path / "2024-02-21T10-00-00-b")
    small_run(tmp_path / "zz-a-copy")
    assert find_run("latest", tmp_path).name == "2024-02-22T10-00-00-a"
    assert find_run(str(tmp_path / "latest")).name == "2024-02-22T10-00-00-a"


def test_latest_of_one_second_is_the_one_numbered_last(tmp_path: Path) -> None:
    for name in ("2024-02-22T10-00-00-a", "2024-02-22T10-00-00-a-10", "2024-02-22T10-00-00-a-9"):
        small_run(tmp_path / name)
    assert find_run("latest", tmp_path).name.endswith("-10")


def test_latest_where_no_name_has_a_date_goes_by_the_records(tmp_path: Path) -> None:
    small_run(tmp_path / "one")
    (tmp_path / "another").mkdir()
    writer = open_writer(tmp_path / "another")
    writer.begin_run(replace(RUN, started_utc="2025-01-01T00:00:00.000Z"), SPECIMENS, CONDITIONS)
    writer.close()
    assert find_run("latest", tmp_path).name == "another"


def test_latest_without_a_run_is_reported(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="there is no run under"):
        find_run("latest", tmp_path)


def test_a_name_that_is_nearly_one_is_named(tmp_path: Path) -> None:
    small_run(tmp_path / "2024-02-22T10-00-00-quickstart")
    with pytest.raises(StoreError, match=r"did you mean 2024-02-22T10-00-00-quickstart\?"):
        find_run("2024-02-22T10-00-00-quikstart", tmp_path)


def test_run_folders_are_those_with_a_record_by_name(tmp_path: Path) -> None:
    small_run(tmp_path / "2024-02-22")
    small_run(tmp_path / "2024-02-21", ([0.9],))
    (tmp_path / "notes.txt").touch()
    (tmp_path / "other").mkdir()
    assert [folder.name for folder in run_folders(tmp_path)] == ["2024-02-21", "2024-02-22"]


def test_no_folder_holds_no_runs(tmp_path: Path) -> None:
    assert list(run_folders(tmp_path / "nowhere")) == []


def test_a_run_without_a_manifest_was_cut_off(tmp_path: Path) -> None:
    small_run(tmp_path / "whole")
    (tmp_path / "whole" / "manifest.json").touch()
    small_run(tmp_path / "cut")
    assert [folder.name for folder in cut_off(tmp_path)] == ["cut"]


def test_a_run_that_is_under_way_was_not_cut_off(tmp_path: Path) -> None:
    folder = small_run(tmp_path / "busy")
    with ExclusiveUse() as use:
        use.lock_file("busy", folder / RUN_LOCK, "busy", lasting=False)
        holder = under_way(folder)
        assert holder is not None and holder.run == "busy" and cut_off(tmp_path) == []
    assert under_way(folder) is None and [f.name for f in cut_off(tmp_path)] == ["busy"]


R = RunStatus
TABLE = {
    # recorded: not held, every value there; a value missing; held; held, a value missing
    "running": (R.INTERRUPTED, R.INTERRUPTED, R.RUNNING, R.RUNNING),
    "interrupted": (R.INTERRUPTED, R.INTERRUPTED, R.RUNNING, R.RUNNING),
    "done": (R.DONE, R.INCOMPLETE, R.DONE, R.INCOMPLETE),
    "stopped": (R.STOPPED, R.STOPPED, R.RUNNING, R.RUNNING),
    "tripped": (R.TRIPPED, R.TRIPPED, R.RUNNING, R.RUNNING),
    "failed": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
    "rig unreachable": (R.UNREACHABLE, R.UNREACHABLE, R.RUNNING, R.RUNNING),
    "a word of tomorrow": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
    "": (R.FAILED, R.FAILED, R.RUNNING, R.RUNNING),
}


@pytest.mark.parametrize("recorded", TABLE)
def test_the_status_over_all_states(recorded: str) -> None:
    found = [run_status(recorded, held=held, missing=missing) for held, missing in product((False, True), repeat=2)]
    assert tuple(found) == TABLE[recorded]


def test_every_outcome_of_a_run_is_in_the_table() -> None:
    assert {outcome.value for outcome in Outcome} <= TABLE.keys()
    assert {status for row in TABLE.values() for status in row} == set(RunStatus) - {R.UNREADABLE}


def test_runs_that_may_be_resumed() -> None:
    assert {status for status in RunStatus if status.can_resume} == {
        R.INTERRUPTED, R.STOPPED, R.TRIPPED, R.FAILED, R.UNREACHABLE,
    }  # fmt: skip
    assert {status for status in RunStatus if status.over} == {R.DONE, R.INCOMPLETE}
