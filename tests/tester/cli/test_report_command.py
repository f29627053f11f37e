"""``tester report``."""

from __future__ import annotations

import sys
from html import unescape
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.results.run_results import results_of
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.results.test_settings_compared import CHANGED, repeated_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made_run(tmp_path / "runs" / "one", [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)])
    return tmp_path


def out(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    found = invoke(["report", *arguments])
    captured = capsys.readouterr()
    assert found == code, captured.err
    return captured.err if code else captured.out


def test_a_report_is_written_and_its_name_printed(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    assert out(capsys, "one").splitlines() == [str(Path("reports") / "one.html")]
    text = (home / "reports" / "one.html").read_text(encoding="utf-8")
    assert "rubber wheel on a belt" in text and "as published: 1#" in text
    assert "belief" not in text and "geometry.touch" not in text  # the made-up rig file has none of the packaged keys


def test_a_report_of_several_runs_goes_to_the_given_path(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    made_run(home / "runs" / "two", [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)])
    assert out(capsys, "one", "two", "one", "--out", "sent/both.html").splitlines() == [str(Path("sent") / "both.html")]
    assert "Runs compared" in (home / "sent" / "both.html").read_text(encoding="utf-8")


def test_a_setting_that_disagrees_is_in_the_report_in_the_words_of_show(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    repeated_run(home / "runs" / "again", CHANGED)
    with RunReader(home / "runs" / "again") as reader:
        lines = list(results_of(reader).watch_lines())
    out(capsys, "again")
    text = unescape((home / "reports" / "again.html").read_text(encoding="utf-8"))
    assert len(lines) == 2 and all(line in text for line in lines)


def test_a_kind_that_is_not_installed_has_a_report_without_its_words(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    made_run(home / "runs" / "own", [(25.0, 100.0, 0.3)], kind="ours")
    out(capsys, "own")
    assert "Measured was the friction coefficient." in (home / "reports" / "own.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("one", "--law", "v3"), "no law 'v3' with published parameters (expected paper, v2)"),
        (("two",), "no run two"),
        ((), "Missing argument"),
    ],
)
def test_missing_runs_are_refused(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], message: str
) -> None:
    assert message in out(capsys, *arguments, code=2)


@pytest.mark.parametrize("library", ["matplotlib", "jinja2"])
def test_without_the_extra_the_line_that_installs_it_is_named(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, library: str
) -> None:
    monkeypatch.setitem(sys.modules, library, None)
    assert 'pip install "friction-tester[report]"' in out(capsys, "one", code=2)
    assert not (home / "reports").exists()


def test_a_report_comes_with_a_workbook_of_each_run_where_that_is_asked_for(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    made_run(home / "runs" / "two", [(25.0, 100.0, 0.3)])
    printed = out(capsys, "one", "two", "--xlsx").splitlines()
    assert printed == [str(Path("reports") / name) for name in ("one.html", "one.xlsx", "two.xlsx")]
    assert all((home / name).read_bytes()[:2] == b"PK" for name in printed[1:])
