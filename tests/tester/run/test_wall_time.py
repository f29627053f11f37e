"""Wall time of a dry run, total and remaining: on a clock that advances equally with every scan."""

from __future__ import annotations

import platform
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from tester.base import clock
from tester.inputs.recipe.time_estimate import Estimate
from tester.kinds.wheel_on_belt.image.axes import KIND
from tester.run.reporter import ReportScreen
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.run.wall_time import BESIDE_S, PLAIN, WallTime, price_s
from tester.store.records import SessionInfo
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.machine.test_leaps import TEMPERED
from tests.tester.store.build import CONDITIONS, RUN, SPECIMENS, open_writer

SCAN_S = 4e-4
"""Wall time of a scan, s."""
EXPECTED = Estimate((), 3000.0, 2000.0, 4000.0, 0.0, 0.0, 0.0, 0.0, leapt_s=600.0)
WARMER = SHORT.replace("25 degC", "40 degC").replace("repeats: 1", "repeats: 2")
SLOWER = TEMPERED.replace("[20 degC, 30 degC]", "20 degC").replace("3 mm/s", "[0.5 mm/s, 3 mm/s]")


def test_without_a_run_the_stated_pace_counts(tmp_path: Path) -> None:
    assert price_s(EXPECTED, KIND, tmp_path / "runs") == pytest.approx(BESIDE_S + 2400.0 / PLAIN)


def stored(under: Path, name: str, wall_s: float, *, kind: str = KIND, host: str = "", simulated: bool = True) -> None:
    """Store a run of 1000 s of rig time, 200 s of it leapt."""
    begun = datetime(2024, 2, 21, 14, tzinfo=UTC)
    (under / name).mkdir(parents=True)
    writer = open_writer(under / name)
    writer.begin_run(replace(RUN, started_utc=begun.isoformat(), kind=kind, simulated=simulated), SPECIMENS, CONDITIONS)
    writer.begin_session(SessionInfo(1, 0.0, begun.isoformat(), host or platform.node(), 0, "", "", "", ""))
    writer.event(500.0, "leap", "200 s were leapt", data="200.000")
    writer.finish("done", rig_seconds=1000.0, ended_utc=(begun + timedelta(seconds=wall_s)).isoformat())
    writer.close()


def test_the_newest_runs_here_show_the_pace(tmp_path: Path) -> None:
    for day, wall_s in enumerate((9.0, 4.0, 8.0, 7.0), start=1):
        stored(tmp_path, f"2024-02-0{day}", wall_s)
    assert price_s(EXPECTED, KIND, tmp_path) == pytest.approx(BESIDE_S + 2400.0 / (800.0 / 7.0))


@pytest.mark.parametrize("other", [{"kind": "another"}, {"host": "elsewhere"}, {"simulated": False}, {"wall_s": 900.0}])
def test_other_runs_do_not_count(tmp_path: Path, other: dict[str, object]) -> None:
    stored(tmp_path, "2024-02-01", **{"wall_s": 4.0, **other})  # type: ignore
    assert price_s(EXPECTED, KIND, tmp_path) == pytest.approx(BESIDE_S + 2400.0 / PLAIN)


def timed(monkeypatch: pytest.MonkeyPatch, home: Path, rig: str, text: str) -> tuple[float, Path, Estimate]:
    """Run a recipe on a clock that only scans move; return the wall time, the folder and the estimates."""
    recipe = home / "recipe.yaml"
    recipe.write_text(text, encoding="utf-8")
    session = Session(SessionOptions(recipe=str(recipe), rig=rig, out=home / "runs"), Answering())
    begun = datetime(2024, 2, 21, 14, tzinfo=UTC)

    def utc() -> str:
        scans = session.run_.engine.scans if session.run_ is not None else 0
        return (begun + timedelta(seconds=SCAN_S * scans)).isoformat()

    monkeypatch.setattr(clock, "utc_now", utc)
    expected = session.prepare().expected
    session.run()
    assert session.folder is not None and session.run_ is not None
    return SCAN_S * session.run_.engine.scans, session.folder, expected


class Answering(ReportScreen):
    """Shows nothing and answers every question."""

    answer_yes = True


@pytest.mark.parametrize(("rig", "first", "second"), [("sim", SHORT, WARMER), ("grosch", TEMPERED, SLOWER)])
def test_the_price_from_one_run_is_that_of_another_within_a_factor_of_two(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, rig: str, first: str, second: str
) -> None:
    _, folder, _ = timed(monkeypatch, tmp_path, rig, first)
    with RunReader(folder) as reader:
        kind = reader.run().info.kind
    shutil.move(folder, tmp_path / "kept" / folder.name)
    wall_s, _, expected = timed(monkeypatch, tmp_path, rig, second)
    assert 0.5 < (price_s(expected, kind, tmp_path / "kept") - BESIDE_S) / wall_s < 2.0


def test_the_time_left_follows_the_pace_so_far() -> None:
    times = iter([5.0, 5.5, 7.0])
    left = WallTime(lambda: next(times))
    assert [left.left_s(done_s, 3000.0 - done_s) for done_s in (100.0, 200.0, 500.0)] == [None, None, 12.5]


def test_a_hold_does_not_slow_the_pace() -> None:
    times = iter([0.0, 10.0, 70.0, 80.0])
    left = WallTime(lambda: next(times))
    assert [left.left_s(done_s, 100.0) for done_s in (0.0, 100.0, 100.0, 200.0)] == [None, 10.0, 10.0, 10.0]
