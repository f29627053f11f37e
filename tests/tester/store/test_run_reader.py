"""The reader returns the recorded values."""

from __future__ import annotations

import sqlite3
from dataclasses import replace
from hashlib import sha256
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.record_schema import StoreError
from tester.store.records import PieceInfo
from tester.store.run_reader import RunReader
from tests.tester.store.build import (
    BURSTS,
    CONDITION,
    CONDITIONS,
    RUN,
    SPECIMENS,
    open_writer,
    result,
    row,
    small_run,
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return small_run(tmp_path / "run")


def test_the_run_comes_back(folder: Path) -> None:
    with RunReader(folder) as reader:
        run = reader.run()
        assert run.info == RUN
        assert (run.status, run.rig_seconds, run.overruns) == ("done", 2700.5, 0)
        assert run.recipe_sha256 == sha256(RUN.recipe_text.encode()).hexdigest()
        assert run.ended_utc == "2024-02-21T14:06:00.000Z"


def test_conditions_come_back_in_recipe_order(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    late = replace(CONDITION, condition=1, row=2)
    early = replace(CONDITION, condition=2, row=1)
    again = replace(CONDITION, condition=3, row=1, replicate=2)
    writer.begin_run(RUN, SPECIMENS, [late, early, again])
    writer.close()
    with RunReader(tmp_path) as reader:
        assert [stored.info for stored in reader.conditions()] == [early, again, late]


def test_a_condition_that_was_not_left_has_no_status(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.begin_condition(1, 12.0)
    writer.end_condition(2, ConditionStatus.CANNOT_HOLD, "warming 3 K/s", 40.0, warming_k_s=3.0, holdable_band_k=5.0)
    writer.close()
    with RunReader(tmp_path) as reader:
        first, second = reader.conditions()
        assert (first.status, first.started_s, isnan(first.ended_s)) == (None, 12.0, True)
        assert (second.status, second.reason) == (ConditionStatus.CANNOT_HOLD, "warming 3 K/s")
        assert (second.ended_s, second.warming_k_s, second.holdable_band_k) == (40.0, 3.0, 5.0)


def test_repeats_come_back_with_every_figure(folder: Path) -> None:
    with RunReader(folder) as reader:
        found = reader.repeats(2)
        assert [(r.condition, r.repeat, r.attempt, r.piece) for r in found] == [(2, i, 1, 1) for i in (1, 2, 3)]
        assert found[0].result == result(0.73)
        assert reader.bursts(found[0].key) == BURSTS


def test_values_that_do_not_exist_come_back_as_none_or_nan(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(replace(RUN, seed=None), SPECIMENS, CONDITIONS)
    nothing = replace(result(status=RepeatStatus.TOO_FEW), mu_resultant=float("nan"), revolutions=0)
    writer.commit_repeat(writer.begin_repeat(1, 1, 1), nothing)
    writer.close()
    with RunReader(tmp_path) as reader:
        assert reader.run().info.seed is None
        assert isnan(reader.repeats()[0].result.mu_resultant)
        assert reader.conditions()[0].info.window_s is None


def test_of_several_attempts_the_last_committed_counts(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.void_repeat(writer.begin_repeat(1, 1, 1), "held")
    writer.commit_repeat(writer.begin_repeat(1, 1, 2), result(0.5))
    writer.begin_repeat(1, 2, 1)
    writer.close()
    with RunReader(tmp_path) as reader:
        assert [(r.repeat, r.attempt) for r in reader.repeats()] == [(1, 2)]
        assert [(r.repeat, r.attempt) for r in reader.repeats(attempts=True)] == [(1, 1), (1, 2), (2, 1)]


def test_samples_of_a_repeat_come_back_as_arrays(folder: Path) -> None:
    with RunReader(folder) as reader:
        samples = reader.samples(1, 2)
        assert tuple(samples) == QUANTITIES.names
        np.testing.assert_array_equal(samples["time_s"], [1200.0 + 0.01 * i for i in range(5)])
        assert samples["time_s"].dtype == np.float64
        assert set(samples["repeat_key"]) == {2.0}


def test_samples_of_a_condition_are_those_of_its_repeats(folder: Path) -> None:
    with RunReader(folder) as reader:
        assert len(reader.samples(2)["time_s"]) == 15
        assert len(reader.samples()["time_s"]) == 30


def test_samples_of_unmeasured_repeats_are_empty(folder: Path) -> None:
    with RunReader(folder) as reader:
        assert len(reader.samples(1, 9)["time_s"]) == 0


def test_samples_of_an_attempt_can_be_asked_for(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    for attempt in (1, 2):
        key = writer.begin_repeat(1, 1, attempt)
        writer.sample(row(float(attempt), float(key)))
        writer.void_repeat(key, "held")
    writer.close()
    with RunReader(tmp_path) as reader:
        assert list(reader.samples(1, 1, 1)["time_s"]) == [1.0]
        assert list(reader.samples(1, 1)["time_s"]) == [2.0]


def test_sample_blocks_come_in_order_of_time(folder: Path) -> None:
    with RunReader(folder) as reader:
        times = [t for block in reader.sample_blocks() for t in block.columns["time_s"]]
    assert times == sorted(times)
    assert len(times) == 30


def test_an_open_run_has_the_rig_time_of_the_last_record(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.sample(row(77.5))
    writer.event(60.0, "step", "heating", "alarm")
    with RunReader(tmp_path) as reader:
        assert (reader.run().status, reader.run().rig_seconds) == ("running", 77.5)
    writer.close()


def test_wheels_and_specimens_come_back(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    wheel = PieceInfo(3, 1, 1, "1#", 100.0, 90.0, 90.0)
    writer.piece_mounted(wheel)
    writer.piece_state(3, 89.2, 1234.0, 500.0)
    writer.close()
    with RunReader(tmp_path) as reader:
        assert reader.pieces() == [replace(wheel, diameter_mm=89.2, sliding_m=1234.0, updated_s=500.0)]
        assert reader.specimens() == SPECIMENS


def test_the_rest_of_the_record_is_in_its_tables(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.device_parameter(0.5, "wheel", "0x6083:00", "2000", "profile acceleration")
    writer.bus_statistic(9.0, "can", "", "load_percent", 26.0)
    writer.tare(3.0, "repeat", {"force_x_n": 0.1, "force_z_n": float("nan"), "moment_z_nm": 0.4}, 7)
    writer.prompt_answered(writer.prompt(1.0, "Install wheel 1"), 2.0, "done", "ada")
    writer.trip_acknowledged(writer.trip(4.0, "overload", "460 N", 460.0, 450.0), 5.0, "ada")
    writer.close()
    connection = sqlite3.connect(tmp_path / "run.db")
    assert connection.execute("SELECT device, parameter, value FROM device_parameter").fetchall() == [
        ("wheel", "0x6083:00", "2000")
    ]
    assert connection.execute("SELECT bus, counter, value FROM bus_statistic").fetchall() == [
        ("can", "load_percent", 26.0)
    ]
    assert connection.execute("SELECT kind, repeat_id, force_x_n, force_z_n FROM tare").fetchall() == [
        ("repeat", 7, 0.1, None)
    ]
    assert connection.execute("SELECT text, asked_s, answered_s, answer, answered_by FROM prompt").fetchall() == [
        ("Install wheel 1", 1.0, 2.0, "done", "ada")
    ]
    assert connection.execute("SELECT interlock, value, limit_value, acknowledged_by FROM trip").fetchall() == [
        ("overload", 460.0, 450.0, "ada")
    ]
    connection.close()


def test_a_folder_without_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="no run in"):
        RunReader(tmp_path)


def test_a_file_that_is_no_database_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.db").write_bytes(b"not a database, but long enough to look at" * 100)
    with pytest.raises(StoreError, match="cannot be read"):
        RunReader(tmp_path)


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.db").touch()
    with pytest.raises(StoreError, match="not begun"):
        RunReader(tmp_path)


def test_a_run_that_was_not_begun_is_refused(tmp_path: Path) -> None:
    open_writer(tmp_path).close()
    with RunReader(tmp_path) as reader, pytest.raises(StoreError, match="not begun"):
        reader.run()


def test_a_damaged_sample_block_is_named(folder: Path) -> None:
    connection = sqlite3.connect(folder / "run.db")
    connection.execute("UPDATE sample_block SET data = x'00' WHERE id = 1")
    connection.commit()
    connection.close()
    with RunReader(folder) as reader:
        with pytest.raises(StoreError, match="block 1"):
            reader.samples(1, 1)
        with pytest.raises(StoreError, match="block 1"):
            list(reader.sample_blocks())


def test_reading_does_not_change_the_file(folder: Path) -> None:
    before = (folder / "run.db").read_bytes()
    with RunReader(folder) as reader:
        reader.samples()
    assert (folder / "run.db").read_bytes() == before
    assert len(list(folder.iterdir())) == 1


def test_a_name_with_spaces_and_marks_is_just_a_name(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path / "a run? 100% #1")) as reader:
        assert reader.run().status == "done"


def test_a_record_states_its_own_channels(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path / "run")) as reader:
        found = reader.quantities()
    assert found.channels == QUANTITIES.channels
    assert found.roles == QUANTITIES.roles
