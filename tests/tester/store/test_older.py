"""A record of schema 7, as version 0.1 wrote it: it says neither its kind nor its axes."""

from __future__ import annotations

import lzma
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tester.base.axes import condition_words
from tester.kinds.wheel_on_belt.image.axes import AXES, KIND
from tester.results import results_of
from tester.results.budget import budget_table
from tester.results.catalogue.entries import read_entries
from tester.results.tables import appendix_rows
from tester.store import older
from tester.store.exclusions import add_exclusion
from tester.store.reader import RunReader
from tester.store.records import StoredExclusion
from tester.store.schema import migrate, version_of

RECORD = Path(__file__).parent / "records" / "schema7.db.xz"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "run.db").write_bytes(lzma.decompress(RECORD.read_bytes()))
    return tmp_path


def test_an_older_record_is_read_with_the_axes_that_it_was_made_with(folder: Path) -> None:
    before = (folder / "run.db").read_bytes()
    with RunReader(folder) as reader:
        assert reader.version == 7 and reader.run().info.kind == older.KIND == KIND
        assert reader.axes() is older.AXES
        told = [condition_words(one.info.setpoint) for one in reader.conditions()]
        found = reader.chain()
    assert told == ["1#, 300 mm/s, 100 N, 25 degC", "1#, 300 mm/s, 200 N, 25 degC"]
    assert found is not None and found.problems == ()
    assert (folder / "run.db").read_bytes() == before


def test_an_older_record_is_exported_and_catalogued(folder: Path) -> None:
    with RunReader(folder) as reader:
        header, *rows = appendix_rows(results_of(reader))
    assert header[:5] == ("Formula", "Slip Velocity /mm·s⁻¹", "Load /N", "Sideslip Angle /°", "Temperature /°C")
    assert [row[2] for row in rows] == ["100", "200"]
    entry, conditions = read_entries(folder, "", "")
    assert [one.setpoint(entry.table()).value("load") for one in conditions] == [100.0, 200.0]


def test_an_older_record_has_a_budget_of_its_kind_s_terms(folder: Path) -> None:
    with RunReader(folder) as reader:
        results = results_of(reader)
        header, *rows = budget_table(results).csv()
        assert reader.run().info.terms is older.TERMS
    named = {row[header.index("term")] for row in rows}
    assert {one.name for one in older.TERMS} <= named and "temperature sensitivity" in named


def test_an_older_record_that_is_amended_keeps_its_conditions_and_an_unbroken_chain(folder: Path) -> None:
    exclusion = StoredExclusion(1, 1, 1, 1, 1, "torn", "ada", "2026-01-01T00:00:00Z", "0.2", "")
    add_exclusion(folder, exclusion)
    with RunReader(folder) as reader:
        assert reader.version > 7 and reader.axes() is older.AXES and len(reader.conditions()) == 2
        found = reader.chain()
    assert found is not None and found.problems == ()


def test_an_older_record_without_a_run_gets_the_conditions_of_a_new_one() -> None:
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as database:
        migrate(database)
        names = {row[1] for row in database.execute("PRAGMA table_info(condition)")}
        assert version_of(database) >= 8 and not names & {axis.field for axis in AXES}


def test_the_axes_of_older_records_are_those_of_today_s_machine_under_the_same_names() -> None:
    assert older.AXES == AXES
    assert older.AXES.as_data() == AXES.as_data()
