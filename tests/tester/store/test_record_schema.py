"""The schema, its version, and that it has a column for every field."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from dataclasses import fields
from pathlib import Path

import pytest

from tester import __version__
from tester.analysis.results import Burst, Judgement, RepeatResult, SoakCheck
from tester.analysis.wear_rate import WearCheck
from tester.store import record_schema
from tester.store.amend import add_exclusion
from tester.store.record_schema import APPLICATION_ID, VERSION, StoreError, migrate, version_of
from tester.store.records import ConditionInfo, PieceInfo, SpecimenInfo, StoredEvent, StoredExclusion
from tester.store.run_reader import RunReader
from tests.tester.store.build import small_run


@pytest.fixture
def database() -> sqlite3.Connection:
    connection = sqlite3.connect(":memory:", isolation_level=None)
    migrate(connection)
    return connection


def columns(database: sqlite3.Connection, table: str) -> set[str]:
    return {row[1] for row in database.execute(f"PRAGMA table_info({table})")}


@pytest.mark.parametrize(
    ("table", "record"),
    [
        ("repeat", RepeatResult),
        ("burst", Burst),
        ("condition", ConditionInfo),
        ("condition", Judgement),
        ("piece", PieceInfo),
        ("wear_check", WearCheck),
        ("soak", SoakCheck),
        ("specimen", SpecimenInfo),
        ("event", StoredEvent),
    ],
)
def test_every_field_of_a_record_has_a_column(database: sqlite3.Connection, table: str, record: type) -> None:
    # Columns of their own, added as the run begins: for each axis, and for each channel that is averaged.
    later = {"setpoint", "means"}
    assert {field.name for field in fields(record)} - later <= columns(database, table)


def test_a_new_database_carries_version_and_application(database: sqlite3.Connection) -> None:
    assert version_of(database) == VERSION
    assert database.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)


def test_migrating_twice_changes_nothing(database: sqlite3.Connection) -> None:
    before = database.execute("SELECT sql FROM sqlite_master ORDER BY name").fetchall()
    migrate(database)
    assert database.execute("SELECT sql FROM sqlite_master ORDER BY name").fetchall() == before


def test_a_database_of_another_version_is_refused_with_both_versions(database: sqlite3.Connection) -> None:
    database.execute(f"PRAGMA user_version = {VERSION + 1}")
    with pytest.raises(StoreError, match=rf"another version.*with schema {VERSION + 1}; version {__version__} reads"):
        migrate(database)


def test_somebody_elses_database_is_refused() -> None:
    connection = sqlite3.connect(":memory:")
    connection.execute("CREATE TABLE bookmarks (url TEXT)")
    with pytest.raises(StoreError, match="not made by"):
        migrate(connection)


@pytest.fixture
def second_version(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the present schema an invented one, 2, with a column more."""
    monkeypatch.setattr(record_schema, "MIGRATIONS", ("ALTER TABLE event ADD COLUMN room TEXT;",))
    monkeypatch.setattr(record_schema, "VERSION", 2)


@pytest.fixture
def first(tmp_path: Path) -> Path:
    return small_run(tmp_path / "run")


@pytest.mark.usefixtures("second_version")
def test_an_empty_database_gets_every_version_in_turn() -> None:
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as connection:
        migrate(connection)
        assert version_of(connection) == 2 and "room" in columns(connection, "event")


def test_a_record_of_the_first_version_is_read_by_the_second_and_left_as_it_is(
    first: Path, request: pytest.FixtureRequest
) -> None:
    with RunReader(first) as reader:
        before, repeats, head = (first / "run.db").read_bytes(), reader.repeats(), reader.record_head()
    request.getfixturevalue("second_version")
    with RunReader(first) as reader:
        assert (reader.repeats(), reader.record_head(), reader.chain().problems) == (repeats, head, ())
    assert (first / "run.db").read_bytes() == before


def test_a_record_that_is_amended_becomes_one_of_the_second_version_with_an_unbroken_chain(
    first: Path, request: pytest.FixtureRequest
) -> None:
    request.getfixturevalue("second_version")
    add_exclusion(first, StoredExclusion(1, 1, 1, 1, 1, "torn", "ada", "2026-01-01T00:00:00Z", "0.3", ""))
    with closing(sqlite3.connect(first / "run.db")) as database:
        assert version_of(database) == 2
    with RunReader(first) as reader:
        assert len(reader.exclusions()) == 1 and reader.chain().problems == ()


def test_a_migration_that_fails_leaves_the_version_before(first: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failing = ("ALTER TABLE event ADD COLUMN room TEXT; SELECT nothing FROM nowhere;",)
    monkeypatch.setattr(record_schema, "MIGRATIONS", failing)
    monkeypatch.setattr(record_schema, "VERSION", 2)
    with closing(sqlite3.connect(first / "run.db")) as database, pytest.raises(sqlite3.OperationalError):
        migrate(database)
    with closing(sqlite3.connect(first / "run.db")) as database:
        assert database.execute("PRAGMA user_version").fetchone() == (1,)
        assert "room" not in columns(database, "event")
