"""A run in both directions of slip, from its recipe to its tables: complete, killed within a pair, and reported."""

from __future__ import annotations

import csv
import shutil
from math import degrees
from pathlib import Path

import pytest

from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.physics.parameters import SensorParameters
from tester.analysis.directions import is_reversed
from tester.analysis.results import RepeatStatus
from tester.cli.main import invoke
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.run.test_session import Screen

TEXT = (
    SHORT.replace("repeats: 1", "repeats: 3\n  both_directions: true")
    .replace("min_valid: 1", "min_valid: 3")
    .replace("window: 14 rev", "window: 8 rev\n  temperature_band: 4 degC")
    .replace("temperature: 25 degC", "temperature: 24 degC")
    .replace("load: 200 N", "load: 50 N")
)
SETS = ("sim.scatter=0", "sim.running_in=0", "sim.wear=0", "sim.friction_heat_fraction=0")
"""A rubber with a constant coefficient, and a cell with all its imperfections."""
SEED = 3


class StoppedError(Exception):
    """The process ends here, as the store sees it."""


def go(home: Path) -> Path:
    (home / "short.yaml").write_text(TEXT, encoding="utf-8")
    options = SessionOptions(recipe=str(home / "short.yaml"), out=home / "runs", overrides=SETS, seed=SEED)
    Session(options, Screen()).run()
    return next((home / "runs").iterdir())


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return go(tmp_path_factory.mktemp("whole"))


@pytest.fixture(scope="module")
def resumed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same run, killed as its fourth repeat began, the second of a pair, and resumed."""
    home = tmp_path_factory.mktemp("cut")
    begin = RunWriter.begin_repeat

    def dying(self: RunWriter, condition: int, repeat: int, *rest: float, **more: int) -> int:
        key = begin(self, condition, repeat, *rest, **more)  # type: ignore[arg-type]
        if repeat == 4:
            self.flush()
            raise StoppedError
        return key

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(RunWriter, "begin_repeat", dying)
        with pytest.raises(StoppedError):
            go(home)
    folder = next((home / "runs").iterdir())
    assert Session(SessionOptions(), Screen()).resume(folder, "") == 0
    return folder


def table(folder: Path, name: str) -> list[dict[str, str]]:
    with (folder / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def turned_deg(mu: float) -> float:
    """Return the apparent angle error of this session's cell, with crosstalk: half the sum of its readings."""
    still = SensorParameters(force_rms=0.0, moment_rms=0.0, zero_drift=0.0, linearity=0.0)
    cell = LoadCellSensor(still, 1.0, SEED, 23.0)
    (x, _, z, _), (back, _, pressed, _) = (cell.measure(side * mu * 50.0, 0.0, 50.0, 0.0) for side in (1.0, -1.0))
    return degrees(0.5 * (x / z + back / pressed) / (1.0 + mu * mu))


def test_repeats_alternate_and_each_has_a_tare_of_its_own(whole: Path) -> None:
    rows = table(whole, "repeats.csv")
    said = ["reversed" if is_reversed(repeat) else "as asked" for repeat in range(1, 7)]
    assert [row["direction"] for row in rows] == said
    assert [round(float(row["measured_belt_speed_m_s"]), 1) for row in rows] == [0.5, 1.1, 1.1, 0.5, 0.5, 1.1]
    assert [float(row["mu_longitudinal_as_measured"]) > 0.0 for row in rows] == [one == "as asked" for one in said]
    with RunReader(whole) as reader:
        assert len([one for one in reader.tares() if one.kind == "repeat"]) >= 5


def test_the_value_is_half_the_difference_and_free_of_the_cell_s_angle(whole: Path) -> None:
    (row,) = table(whole, "directions.csv")[:1]
    as_asked, back = float(row["mu_as_measured_as_asked"]), float(row["mu_as_measured_reversed"])
    (condition,) = table(whole, "conditions.csv")
    mu, mean = float(condition["mu_as_measured"]), 0.5 * (as_asked + back)
    assert mu == pytest.approx(mean, rel=1e-3) and (condition["valid"], condition["asked"]) == ("3", "3")
    assert abs(as_asked / mu - 1.0) > 0.004 and abs(back / mu - 1.0) > 0.004
    with RunReader(whole) as reader:
        assert results_of(reader).rows[0].result.both_ways is not None


def test_the_run_prints_the_cell_s_angle(whole: Path) -> None:
    run = table(whole, "directions.csv")[-1]
    mu = float(table(whole, "conditions.csv")[0]["mu"])
    assert run["level"] == "run" and float(run["misalignment_u_standard_deg"]) > 0.0
    assert float(run["misalignment_deg"]) == pytest.approx(turned_deg(mu), abs=0.1)


def test_a_run_killed_within_a_pair_resumes_in_the_same_direction(whole: Path, resumed: Path) -> None:
    with RunReader(resumed) as reader:
        attempts = [(r.repeat, r.attempt, r.result.status) for r in reader.repeats(attempts=True)]
    assert (4, 1, RepeatStatus.VOID) in attempts and (4, 2, RepeatStatus.VALID) in attempts
    rows, again = table(whole, "repeats.csv"), table(resumed, "repeats.csv")
    assert [row["direction"] for row in again] == [row["direction"] for row in rows]
    for one, other in zip(rows, again, strict=True):
        along, before = (float(row["mu_longitudinal_as_measured"]) for row in (other, one))
        assert along == pytest.approx(before, rel=0.01)
    (condition,) = table(resumed, "conditions.csv")
    assert condition["status"] == "ok" and condition["valid"] == "3"


def test_the_record_bears_out_its_tables(whole: Path, resumed: Path) -> None:
    assert invoke(["verify", str(whole)]) == 0 and invoke(["verify", str(resumed)]) == 0


def test_show_prints_the_angle_and_the_pairs(whole: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["show", str(whole)]) == 0
    out = capsys.readouterr().out
    assert "both directions: the cell's axes seem to be off by" in out and "3 of 3" in out


def test_a_repeat_that_is_excluded_takes_its_pair_out_of_the_mean(whole: Path, tmp_path: Path) -> None:
    folder = tmp_path / whole.name
    shutil.copytree(whole, folder)
    assert invoke(["results", "exclude", str(folder), "1/2", "--reason", "rubber torn"]) == 0
    rows = table(folder, "repeats.csv")
    assert [row["in_mean"] for row in rows] == ["0", "0", "1", "1", "1", "1"]
    assert rows[0]["exclusion"] == "the other repeat of its pair does not count"
    assert table(folder, "conditions.csv")[0]["valid"] == "2"


def test_a_run_in_one_direction_has_no_table_of_directions_and_no_such_column(tmp_path: Path) -> None:
    from tests.tester.store.build import small_run

    with RunReader(small_run(tmp_path)) as reader:
        results = results_of(reader)
    assert not results.both_directions
