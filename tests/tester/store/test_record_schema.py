"""The schema and its version."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from tester import __version__
from tester.store import record_schema
from tester.store.amend import add_exclusion
from tester.store.journal_records import StoredExclusion
from tester.store.record_schema import APPLICATION_ID, VERSION, StoreError, migrate, version_of
from tester.store.run_reader import RunReader
from tests.tester.store.build import small_run


@pytest.fixture
def database() -> sqlite3.Connection:
    connection = sqlite3.connect(":memory:", isolation_level=None)
    migrate(connection)
    return connection


def columns(database: sqlite3.Connection, table: str) -> set[str]:
    return {row[1] for row in database.execute(f"PRAGMA table_info({table})")}


def test_the_tables_are_those_of_the_released_text() -> None:
    # Derived from the record classes: a new field changes this text, and needs a migration.
    assert Path(__file__).with_name("schema.sql").read_text(encoding="utf-8") == record_schema.SCHEMA


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


def test_a_foreign_database_is_refused() -> None:
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
def test_an_empty_database_gets_the_newest_tables_at_once() -> None:
    with closing(sqlite3.connect(":memory:", isolation_level=None)) as connection:
        migrate(connection)
        assert version_of(connection) == 2


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
