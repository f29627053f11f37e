"""The hardness of a simulated run, from the recipe to `tester show` and the report."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.hands import DUROMETER_SHORE_A, durometer
from tester.cli.main import invoke
from tester.results.hardness_read import hardness_lines
from tester.results.run_results import RunResults, results_of
from tester.results.verify import verify
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.test_session import Screen

OWN = """\
name: own
hardness: 64
hardness_tolerance: 0.01 Shore A
law: {form: power, figures: {a: 0.6, v0: 300 mm/s, n: 0.2, n0: 200 N, m: -0.1}}
"""
ASKED = SHORT.replace('compound: "1#"', "compound: own\n    measured: {hardness: prompt}")
SEED = 4


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run without a person, which asks for the hardness."""
    place = tmp_path_factory.mktemp("hardness")
    (place / "compounds").mkdir()
    (place / "compounds" / "own.yaml").write_text(OWN, encoding="utf-8")
    (place / "asked.yaml").write_text(ASKED, encoding="utf-8")
    screen = Screen()
    options = SessionOptions(str(place / "asked.yaml"), "sim", QUIET, out=place / "runs", seed=SEED)
    assert Session(options, screen).run() == 0
    return Path(screen.results[0])


@pytest.fixture(scope="module")
def results(run: Path) -> Iterator[RunResults]:
    with RunReader(run) as reader:
        yield results_of(reader)


def test_the_twin_reads_its_own_hardness_with_a_reading_s_scatter(results: RunResults) -> None:
    (piece,) = results.pieces
    assert piece.hardness_shore_a == pytest.approx(durometer(SEED, 1, 64.0), abs=0.05)
    assert abs(piece.hardness_shore_a - 64.0) < 4.0 * DUROMETER_SHORE_A
    assert piece.hardness_by == "automatic" and piece.hardness_utc > results.run.info.started_utc


def test_a_line_has_the_reading_and_its_doubt(results: RunResults) -> None:
    (line,) = hardness_lines(results)
    assert line.startswith("wheel 1 (own): hardness 6") and "Shore A (automatic, 2" in line
    assert "; doubt: " in line and line.endswith("(expected 64 of its file, within 0.01)")
    assert list(hardness_lines(results, "own")) == [line] and list(hardness_lines(results, "1#")) == []


def test_show_has_the_hardness(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["show", str(run)]) == 0
    assert "wheel 1 (own): hardness 6" in capsys.readouterr().out
    assert invoke(["show", str(run), "--json"]) == 0
    (wheel,) = json.loads(capsys.readouterr().out)["wheels"]
    assert wheel["hardness_by"] == "automatic" and 58.0 < wheel["hardness_shore_a"] < 70.0


def test_the_report_has_it_beside_the_compound_s(run: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    out = tmp_path / "report.html"
    assert invoke(["report", str(run), "--out", str(out)]) == 0
    text = out.read_text(encoding="utf-8")
    assert 0 < text.index("64 Shore A") < text.index("hardness read") and "read by" in text


def test_the_table_of_wheels_and_the_record_are_whole(run: Path) -> None:
    head, row = (run / "wheel.csv").read_text(encoding="utf-8").splitlines()[:2]
    assert head.endswith("hardness_shore_a,hardness_by,hardness_utc") and ",automatic," in row
    assert verify(run).problems == ()
