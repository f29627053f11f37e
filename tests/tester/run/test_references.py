"""Runs with references: the reserved wheel is mounted and removed, the belt stays, also across an interruption."""

from __future__ import annotations

import csv
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.record_file import DATABASE
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tester.tui.playback import load
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.cut_short import StoppedError
from tests.tester.run.test_session import Screen

TEXT = (
    SHORT.replace("window: 14 rev", "window: 4 rev\n  temperature_band: 4 degC")
    .replace("temperature: 25 degC", "temperature: 24 degC")
    .replace("load: 200 N", "load: [50 N, 80 N]")
    + "reference: {every: 2, wheel: ref-1, temperature: 24 degC, load: 60 N}\n"
)
"""Reference 1 on wheel 1, conditions 2 and 3 on wheel 2, reference 4 on wheel 1 again."""
SETS = (*QUIET, "sim.friction_heat_fraction=0", "sim.counterface.loss=0.1", "sim.counterface.loss_travel=100 m",
        "sim.record_truth=true")  # fmt: skip
AGAIN = 4


def options(home: Path) -> SessionOptions:
    (home / "watched.yaml").write_text(TEXT, encoding="utf-8")
    return SessionOptions(recipe=str(home / "watched.yaml"), out=home / "runs", overrides=SETS, seed=3)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A complete run."""
    home = tmp_path_factory.mktemp("whole")
    assert Session(options(home), Screen()).run() == 0
    return next((home / "runs").iterdir())


@pytest.fixture(scope="module")
def resumed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, float]:
    """A run that died with the reserved wheel mounted again, and was resumed; the belt's travel on record then."""
    home = tmp_path_factory.mktemp("resumed")
    begin = RunWriter.begin_repeat

    def dying(self: RunWriter, condition: int, *rest: float, **more: int) -> int:
        key = begin(self, condition, *rest, **more)  # type: ignore[arg-type]
        if condition == AGAIN:
            raise StoppedError
        return key

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RunWriter, "begin_repeat", dying)
        with pytest.raises(StoppedError):
            Session(options(home), Screen()).run()
    folder = next((home / "runs").iterdir())
    with RunReader(folder) as reader:
        before_m = resume_point(reader).stand.travels_m[""]
    assert Session(SessionOptions(), Screen()).resume(folder, "") == 0
    return folder, before_m


def belt(folder: Path) -> list[float]:
    """Return the belt's true grip at the start of each repeat."""
    with closing(sqlite3.connect(folder / DATABASE)) as database:
        return [value for (value,) in database.execute("SELECT value FROM truth WHERE name = 'belt' ORDER BY id")]


def pieces(folder: Path) -> list[tuple[int, int]]:
    """Return condition and wheel of each repeat."""
    with RunReader(folder) as reader:
        return [(one.condition, one.piece) for one in reader.repeats()]


def test_references_are_measured_on_the_reserved_wheel(whole: Path) -> None:
    assert pieces(whole) == [(1, 1), (2, 2), (3, 2), (4, 1)]
    with RunReader(whole) as reader:
        assert [one.specimen for one in reader.pieces()] == [2, 1]
        assert results_of(reader).status.value == "done"


def test_a_wheel_that_comes_on_again_is_as_worn_as_it_was(whole: Path) -> None:
    with RunReader(whole) as reader:
        travels = list(reader.travels().values())
        reserved, own = reader.pieces()
    assert travels[0].piece_m < travels[3].piece_m < reserved.sliding_m
    assert reserved.diameter_mm < 90.0 and own.diameter_mm < 90.0
    assert travels[1].piece_m < travels[2].piece_m <= own.sliding_m


def test_the_belt_is_the_same_for_all_of_them(whole: Path) -> None:
    with RunReader(whole) as reader:
        travelled = [one.counterface_m for one in reader.travels().values()]
    assert travelled == sorted(travelled) and travelled[0] > 0.0
    grip = belt(whole)
    assert grip == sorted(grip, reverse=True)
    # The run's estimate matches the rig's truth: a tenth in each 100 m, within the errors of speed and contact.
    assert [0.9 ** (one / 100.0) for one in travelled] == pytest.approx(grip, rel=0.01)


def test_it_resumes_with_the_reserved_wheel_and_the_same_belt(resumed: tuple[Path, float]) -> None:
    folder, before_m = resumed
    assert pieces(folder) == [(1, 1), (2, 2), (3, 2), (4, 1)]
    with RunReader(folder) as reader:
        last = max(one.counterface_m for one in reader.travels().values())
    assert last > before_m > 0.0
    grip = belt(folder)
    # From the record: everything after the last stored state, a second of wall time, is lost.
    assert grip[-1] < grip[0] and grip[-1] == pytest.approx(0.9 ** (last / 100.0), rel=0.01)


def test_a_resumed_run_exports_and_verifies(resumed: tuple[Path, float]) -> None:
    folder, _ = resumed
    with (folder / "reference.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(one["condition"], one["wheel"]) for one in rows] == [("1", "1"), ("4", "1")]
    assert all(0.0 < float(one["repeatability_expanded"]) < float(one["mu"]) for one in rows)
    assert "u_expanded" not in rows[0]  # which is U of the piece, in the table of conditions
    assert len((folder / "appendix.csv").read_text(encoding="utf-8-sig").splitlines()) == 3
    assert invoke(["verify", str(folder)]) == 0


def test_a_stored_run_with_references_can_be_watched_again(whole: Path) -> None:
    found = load(whole)
    assert [one.info.condition for one in found.conditions] == [2, 3, 1, 4]  # references behind the recipe's own rows
    assert any("mount again wheel 1" in event.text for event in found.events)
