"""``tester figure``."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run
from tests.tester.kinds.wheel_on_belt.fit.made import made_run


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made_run(tmp_path / "runs" / "one", [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)])
    return tmp_path


def out(capsys: pytest.CaptureFixture[str], *arguments: str, code: int = 0) -> str:
    found = invoke(["figure", *arguments])
    captured = capsys.readouterr()
    assert found == code, captured.err
    return captured.err if code else captured.out


def test_the_figures_of_a_run_are_named(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert [line.partition(":")[0] for line in out(capsys, "one", "--list").splitlines()] == [
        "load",
        "overview",
        "repeats-1",
        "repeats-2",
    ]
    assert not (home / "figures").exists()


@pytest.mark.parametrize(("ending", "begin"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")])
def test_a_figure_is_written_in_each_format(
    home: Path, capsys: pytest.CaptureFixture[str], ending: str, begin: bytes
) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    told = out(capsys, "one", "--name", "load", "--format", ending, "--law", "paper", "--out", "drawn")
    path = home / "drawn" / "one" / f"load.{ending}"
    assert told.splitlines() == [str(path.relative_to(home))]
    assert path.read_bytes().startswith(begin)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("one", "--name", "slip"), "no figure slip of one (there are load, overview, repeats-1, repeats-2)"),
        (("one", "--law", "v3"), "no law 'v3' with published parameters (expected paper, v2)"),
        (("two",), "no run two"),
    ],
)
def test_missing_runs_are_refused(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], message: str
) -> None:
    assert message in out(capsys, *arguments, code=2)


def test_several_runs_are_also_drawn_together(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    made_run(home / "runs" / "two", [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3)])
    told = [Path(line) for line in out(capsys, "one", "two").splitlines()]
    together = {path.name for path in told if path.parent.name == "several-runs"}
    assert together == {"load-of-runs.png", "overview-of-runs.png"}
    named = out(capsys, "one", "two", "--name", "load", "--out", "named").splitlines()
    assert named == [str(Path("named") / run / "load.png") for run in ("one", "two")]
    assert all(path.is_file() for path in told)
    assert {path.parent.name for path in told} == {"one", "two", "several-runs"}


def test_a_run_without_values_has_nothing_to_draw(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_run(home / "runs" / "none", [(25.0, 100.0, 0.3)], failed=[1])
    assert "there is nothing to draw" in out(capsys, "none", code=1)


def test_without_matplotlib_the_line_that_installs_it_is_named(
    home: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert "pip install" in out(capsys, "one", code=2)


@pytest.mark.parametrize("over", ["ra", "speed", "pressure"])
def test_the_parts_of_a_law_are_drawn_without_a_run(home: Path, capsys: pytest.CaptureFixture[str], over: str) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    told = out(capsys, "--components", "--over", over, "--format", "svg")
    path = home / "figures" / "greta-tread-road" / f"components-over-{over}.svg"
    assert told.splitlines() == [str(path.relative_to(home))] and path.stat().st_size > 5000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "no run is named"),
        (["one", "--components"], "takes no run"),
        (["--components", "--compound", "treat"], "did you mean"),
        (["--components", "--law", "power"], "not made of materials"),
        (["--components", "--speed", "0 m/s"], "above 0"),
    ],
)
def test_parts_of_a_law_that_cannot_be_drawn_are_reported(
    home: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], message: str
) -> None:
    assert message in " ".join(out(capsys, *arguments, code=2).split())


def test_a_run_on_a_track_has_its_master_curve_and_logarithmic_speeds(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from tester.cli.figure_command import figures_of
    from tester.cli.stored_runs import results_named
    from tests.tester.kinds.specimen_on_track.fit.made import made_track_run

    folder = made_track_run(home / "track")
    assert invoke(["figure", str(folder), "--list"]) == 0
    assert "master: SBR, dry, 20 N: collapses" in capsys.readouterr().out.splitlines()
    charts = {one.name: one for one in figures_of(folder, results_named(str(folder)), "", published=False)}
    assert getattr(charts["track_speed-by-temperature"], "log_x", None) is True
    assert getattr(charts["temperature-by-track_speed"], "log_x", None) is False


def test_a_run_that_friction_heats_has_no_master_curve(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from tests.tester.kinds.wheel_on_belt.fit.made import made_run

    assert invoke(["figure", str(made_run(home / "wheel")), "--list"]) == 0
    assert "master" not in capsys.readouterr().out


def test_of_a_kind_without_published_laws_none_is_expected(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    made_track_run(home / "runs" / "track", (0.0, 20.0), (1e-4, 1e-3))
    assert invoke(["figure", "track", "--law", "wlf_bell"]) == 2
    said = capsys.readouterr().err
    assert "no law 'wlf_bell' with published parameters (of this kind of rig no law has any" in said
    assert "expected" not in said
