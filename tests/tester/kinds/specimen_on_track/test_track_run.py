"""A run of a specimen on a track from the command line: stopped, resumed, verified, exported, shown."""

from __future__ import annotations

import csv
from collections.abc import Awaitable, Callable
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.store.run_reader import RunReader
from tester.tui.playback import load
from tester.tui.replay import ReplayApp
from tests.tester.kinds.specimen_on_track.bench import DISC
from tests.tester.tui.stage import screen_text
from tests.tester.tui.test_replay import replay


@pytest.fixture(scope="module")
def stopped(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run stopped by its operator in the second row, on the wet disc."""
    home = tmp_path_factory.mktemp("disc")
    (home / "disc.yaml").write_text(DISC, encoding="utf-8")
    arguments = ["--rig", "pin-on-disc", "--yes", "--out", str(home / "runs"), "--fault", "t=28 s: operator stop"]
    assert invoke(["run", str(home / "disc.yaml"), *arguments]) == 5
    return next((home / "runs").glob("2*"))


@pytest.fixture(scope="module")
def run(stopped: Path) -> Path:
    """The same run, resumed to its end."""
    assert invoke(["resume", str(stopped), "--yes"]) == 0
    return stopped


def test_a_resumed_run_has_every_row_and_one_specimen(run: Path) -> None:
    with RunReader(run) as reader:
        rows = [(r.condition, r.result.valid) for r in reader.repeats()]
        assert rows == [(1, True), (2, True)] and len(reader.pieces()) == 1
        assert reader.run().info.kind == "specimen_on_track" and reader.run().info.worn == "specimen"


def test_a_resumed_run_asks_for_weights_and_interface_again(run: Path) -> None:
    with RunReader(run) as reader:
        asked = [prompt.text for prompt in reader.prompts()]
    assert "hang 10 N of weights on the arm and make the track wet" in asked
    assert "the run continues with specimen 1 on the raised arm: SBR" in asked


def test_it_is_verified(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["verify", str(run)]) == 0
    assert "as it was left, done" in capfd.readouterr().out


def test_it_leaves_as_a_table_with_its_interface(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert invoke(["export", str(run), "--format", "conditions"]) == 0
    rows = list(csv.DictReader(capfd.readouterr().out.splitlines()))
    assert [row["interface"] for row in rows] == ["dry", "wet"]
    dry, wet = (float(row["mu"]) for row in rows)
    assert 0.5 < wet / dry < 0.7  # 0.6 and two repeats' scatter of 2 %
    assert all(float(row["measured_sliding_mm_s"]) == pytest.approx(200.0, rel=0.01) for row in rows)


def test_its_screens_show_its_own_values(run: Path) -> None:
    async def act(app: ReplayApp, press: Callable[..., Awaitable[None]]) -> None:
        await press("f3")
        text = screen_text(app)
        assert "Track speed" in text and "Friction mu" in text and "Jacket" not in text

    replay(run, load(run), act)
