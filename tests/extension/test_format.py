"""A laboratory's export format, in its own package."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.base.plugins import plugins
from tester.cli.main import invoke
from tests.extension.installing import installed
from tests.tester.store.build import small_run


@pytest.fixture(autouse=True)
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A run below runs, where the laboratory's package is installed."""
    monkeypatch.chdir(tmp_path)
    small_run(tmp_path / "runs" / "one")
    with installed("format", tmp_path / "site", monkeypatch):
        yield tmp_path / "runs" / "one"


def test_a_run_leaves_in_it(capfdbinary: pytest.CaptureFixture[bytes]) -> None:
    assert invoke(["export", "one", "--format", "json"]) == 0
    found = [json.loads(line) for line in capfdbinary.readouterr().out.splitlines()]
    assert [(one["compound"], one["mu"]) for one in found] == [("1#", 0.9), ("1#", 0.73)]
    assert "200 N" in found[1]["condition"]


def test_it_goes_to_a_file(run: Path) -> None:
    assert invoke(["export", "one", "--format", "json", "--out", "one.jsonl"]) == 0
    assert len((run.parents[1] / "one.jsonl").read_text(encoding="utf-8").splitlines()) == 2


def test_it_is_listed_and_known_by_package_version_and_hash(capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["export", "--help"]) == 0
    assert "json" in capfd.readouterr().out and plugins().loaded == ()
    assert invoke(["export", "one", "--format", "json"]) == 0
    (loaded,) = plugins().loaded
    assert (loaded.distribution, loaded.version, loaded.target) == ("lab-json", "1.0", "lab_json:JSON")
