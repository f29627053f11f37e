"""Finding and listing runs."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.store.catalogue import find_run, list_runs
from tester.store.schema import StoreError
from tests.tester.store.build import small_run


def test_a_run_is_found_by_folder_file_or_name(tmp_path: Path) -> None:
    folder = small_run(tmp_path / "runs" / "one")
    assert find_run(str(folder)) == folder
    assert find_run(str(folder / "run.db")) == folder
    assert find_run("one", tmp_path / "runs") == folder


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(StoreError, match="no run empty"):
        find_run("empty", tmp_path)


def test_runs_are_listed_by_name_with_what_is_committed(tmp_path: Path) -> None:
    small_run(tmp_path / "2024-02-22")
    small_run(tmp_path / "2024-02-21", ([0.9],))
    (tmp_path / "notes.txt").touch()
    (tmp_path / "other").mkdir()
    found = list(list_runs(tmp_path))
    assert [item.name for item in found] == ["2024-02-21", "2024-02-22"]
    assert [(item.conditions, item.repeats) for item in found] == [(1, 1), (2, 6)]


def test_a_run_that_cannot_be_read_is_listed_with_its_problem(tmp_path: Path) -> None:
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "run.db").touch()
    (found,) = list_runs(tmp_path)
    assert found.run is None
    assert "schema 0" in found.problem


def test_no_folder_holds_no_runs(tmp_path: Path) -> None:
    assert list(list_runs(tmp_path / "nowhere")) == []
