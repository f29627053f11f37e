"""Merged parts: times follow one another, keys are the run's, and a merge can be repeated."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tester.store.amend import add_exclusion
from tester.store.journal_records import StoredExclusion
from tester.store.merge import TABLES, Merge
from tester.store.record_schema import TIMES, StoreError, migrate
from tester.store.records import ConditionInfo, PieceInfo
from tester.store.run_reader import RunReader
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, open_writer, record, small_run

FIRST_S, SECOND_S = 2700.5, 100.25
ZEROS = {"force_x_n": 0.1, "force_y_n": 0.2, "force_z_n": 0.3, "moment_z_nm": 0.4}


def _condition(number: int) -> ConditionInfo:
    held = CONDITION.setpoint.but(load=100.0 * number)
    return replace(CONDITION, condition=number, row=number, setpoint=held)


def part_of(folder: Path, number: int, seconds: float, mu: list[float]) -> Path:
    """Write the record of a part that measured one condition; return its folder."""
    folder.mkdir(parents=True)
    writer = open_writer(folder)
    writer.begin_run(RUN, SPECIMENS, [_condition(number)])
    writer.piece_mounted(PieceInfo(number, 1, number, "1#", 2.0, 90.0, 89.5, updated_s=20.0))
    writer.event(1.0, "step", f"install wheel {number}")
    writer.prompt_answered(writer.prompt(1.5, "install"), 1.75, "yes")
    writer.tare(3.0, "reference", ZEROS, 0)
    writer.tare(4.0, "repeat", ZEROS, 1)
    writer.trip_acknowledged(writer.trip(50.0, "guard", "open"), 60.0, "ada")
    writer.bus_statistic(70.0, "can", "", "frames", 5.0)
    writer.truth(number, 1, 1, {"model": 0.7})
    writer.device_parameter(0.5, "wheel", "0x6083:00", "2000")
    record(writer, number, mu)
    writer.finish("done", rig_seconds=seconds)
    writer.close()
    return folder


@pytest.fixture
def run(tmp_path: Path) -> Path:
    """A run that was begun, with two parts beside it."""
    writer = open_writer(tmp_path)
    conditions = [_condition(i) for i in (1, 2, 3)]
    writer.begin_run(RUN, SPECIMENS, conditions)
    writer.close()
    part_of(tmp_path / "parts" / "1", 1, FIRST_S, [0.9, 0.91])
    part_of(tmp_path / "parts" / "2", 2, SECOND_S, [0.7, 0.71, 0.72])
    return tmp_path


HEADER = {
    "run", "axis", "metadata", "version", "specimen", "condition", "channel", "session", "change", "calibration",
    "budget_term", "known_slope", "material", "exclusion", "chain",
}  # fmt: skip
"""Tables of the whole run, which parts do not fill."""


def merge(run: Path) -> Path:
    with Merge(run) as merging:
        merging.add(run / "parts" / "1")
        merging.add(run / "parts" / "2")
        merging.finish("done", "", "2024-02-21T14:06:00.000Z")
    return run


@pytest.fixture
def merged(run: Path) -> Iterator[RunReader]:
    with RunReader(merge(run)) as reader:
        yield reader


def rows(folder: Path, sql: str) -> list[tuple[object, ...]]:
    with closing(sqlite3.connect(folder / "run.db")) as database:
        return database.execute(sql).fetchall()


def test_every_table_of_the_schema_is_known() -> None:
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as database:
        migrate(database)
        names = {name for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    assert names == TABLES.keys() | HEADER


@pytest.mark.parametrize("table", TABLES)
def test_a_table_has_the_columns_that_a_merge_names(table: str) -> None:
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as database:
        migrate(database)
        columns = {row[1] for row in database.execute(f"PRAGMA table_info({table})")}
    kind, times = TABLES[table], TIMES.get(table, ())
    assert {*times, *filter(None, (kind.key, kind.repeat))} <= columns
    # Every rig time is among them: names that end in _s and are neither a duration nor a rate.
    assert {name for name in columns if name.endswith("_s")} - set(times) <= {
        "wheel_speed_m_s",
        "belt_speed_m_s",
        "slip_m_s",
        "window_s",
    }


def test_rig_time_is_the_sum_of_the_parts(merged: RunReader) -> None:
    assert merged.run().rig_seconds == FIRST_S + SECOND_S and merged.run().status == "done"


def test_conditions_are_as_the_parts_left_them(merged: RunReader) -> None:
    first, second, third = merged.conditions()
    assert (first.started_s, second.started_s) == (5.0, FIRST_S + 5.0)
    assert (first.ended_s, second.ended_s) == (60.0, FIRST_S + 60.0)
    assert first.status is not None and second.status is not None and third.status is None


def test_repeats_have_keys_of_the_run_and_later_times(merged: RunReader) -> None:
    found = merged.repeats()
    assert [(r.key, r.condition, r.repeat) for r in found] == [(1, 1, 1), (2, 1, 2), (3, 2, 1), (4, 2, 2), (5, 2, 3)]
    assert [r.begun_s for r in found] == [9.0, 9.0, FIRST_S + 9.0, FIRST_S + 9.0, FIRST_S + 9.0]
    assert found[2].result.ended_s == FIRST_S + 43.5 and found[2].result.window_s == 10.6


def test_bursts_stay_with_their_repeats(merged: RunReader) -> None:
    assert [burst.started_s for burst in merged.bursts(1)] == [10.0, 40.0]
    assert [burst.started_s for burst in merged.bursts(4)] == [FIRST_S + 10.0, FIRST_S + 40.0]


def test_samples_are_later_and_carry_the_run_s_keys(run: Path) -> None:
    with RunReader(run / "parts" / "2") as reader:
        alone = reader.samples(2)
    with RunReader(merge(run)) as reader:
        together = reader.samples(2)
        assert set(reader.samples(1)["repeat_key"]) == {1.0, 2.0}
    assert np.array_equal(together["time_s"], np.round(alone["time_s"] + FIRST_S, 6))
    assert np.array_equal(together["repeat_key"], alone["repeat_key"] + 2.0)
    others = [name for name in alone if name not in ("time_s", "repeat_key")]
    assert all(np.array_equal(together[name], alone[name]) for name in others)


def test_the_first_part_s_samples_are_copied_byte_for_byte(run: Path) -> None:
    sql = "SELECT data FROM sample_block ORDER BY id"
    first = rows(run / "parts" / "1", sql)
    assert rows(merge(run), sql)[: len(first)] == first


def test_the_journal_continues(merged: RunReader) -> None:
    found = [(e.sequence, e.t_s, e.text) for e in merged.events()]
    assert found == [(1, 1.0, "install wheel 1"), (2, FIRST_S + 1.0, "install wheel 2")]


def test_wheels_trips_prompts_tares_and_devices_of_all_parts_are_there(run: Path) -> None:
    merge(run)
    assert rows(run, "SELECT piece, installed_s, updated_s FROM piece") == [
        (1, 2.0, 20.0),
        (2, FIRST_S + 2.0, FIRST_S + 20.0),
    ]
    assert rows(run, "SELECT id, t_s, acknowledged_s FROM trip") == [
        (1, 50.0, 60.0),
        (2, FIRST_S + 50.0, FIRST_S + 60.0),
    ]
    assert rows(run, "SELECT id, asked_s, answered_s FROM prompt")[1] == (2, FIRST_S + 1.5, FIRST_S + 1.75)
    # A tare of no repeat stays one; that of a part's first repeat is of the run's third.
    assert rows(run, "SELECT id, t_s, repeat_id FROM tare")[2:] == [(3, FIRST_S + 3.0, 0), (4, FIRST_S + 4.0, 3)]
    assert rows(run, "SELECT t_s FROM bus_statistic") == [(70.0,), (FIRST_S + 70.0,)]
    assert rows(run, "SELECT t_s FROM device_parameter") == [(0.5,), (FIRST_S + 0.5,)]


def test_merging_again_changes_nothing_and_the_chain_shows_it(run: Path) -> None:
    merge(run)
    tables = TABLES.keys() | HEADER - {"chain"}
    before = {table: rows(run, f"SELECT * FROM {table}") for table in tables}
    (entries,) = rows(run, "SELECT count(*) FROM chain")[0]
    merge(run)
    assert {table: rows(run, f"SELECT * FROM {table}") for table in tables} == before
    assert rows(run, "SELECT count(*) FROM chain")[0][0] > entries
    with RunReader(run) as reader:
        chain = reader.chain()
    assert chain.problems == ()


def test_a_part_that_cannot_be_read_leaves_the_parts_before_it(run: Path) -> None:
    (run / "parts" / "2" / "run.db").write_bytes(b"no database")
    with Merge(run) as merging:
        merging.add(run / "parts" / "1")
        with pytest.raises(StoreError):
            merging.add(run / "parts" / "2")
    with RunReader(run) as reader:
        assert [r.condition for r in reader.repeats()] == [1, 1]


def test_dropped_samples_are_counted_over_all_parts(run: Path) -> None:
    for number in (1, 2):
        with closing(sqlite3.connect(run / "parts" / str(number) / "run.db")) as database, database:
            database.execute("UPDATE run SET overruns = ?", (number,))
    with RunReader(merge(run)) as reader:
        assert reader.run().overruns == 3


def test_an_exclusion_of_a_repeat_survives_a_merge(tmp_path: Path) -> None:
    folder = small_run(tmp_path / "run")
    add_exclusion(folder, StoredExclusion(0, 1, 2, 1, 1, "debris", "ada", "2024-02-21T15:00:00.000Z", "0.1.0", ""))
    with Merge(folder):
        pass  # records of parts are removed, and come again from the parts
    with RunReader(folder) as reader:
        assert reader.repeats() == [] and [one.target for one in reader.exclusions()] == [(1, 2, 1)]
