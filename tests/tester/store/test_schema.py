"""The schema, its version, and that it has a column for every field."""

from __future__ import annotations

import sqlite3
from dataclasses import fields

import pytest

from tester.analysis.results import Burst, Judgement, RepeatResult
from tester.store.records import ConditionInfo, PieceInfo, SpecimenInfo, StoredEvent
from tester.store.schema import APPLICATION_ID, PIECE, VERSION, StoreError, migrate, version_of


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
        (PIECE, PieceInfo),
        ("specimen", SpecimenInfo),
        ("event", StoredEvent),
    ],
)
def test_every_field_of_a_record_has_a_column(database: sqlite3.Connection, table: str, record: type) -> None:
    # Columns of their own, added as the run begins: for each axis, and for each channel that is averaged.
    later = {"setpoint", "means"}
    named = {PIECE if field.name == "piece" else field.name for field in fields(record)}
    assert named - later <= columns(database, table)


def test_a_new_database_carries_version_and_application(database: sqlite3.Connection) -> None:
    assert version_of(database) == VERSION
    assert database.execute("PRAGMA application_id").fetchone() == (APPLICATION_ID,)


def test_migrating_twice_changes_nothing(database: sqlite3.Connection) -> None:
    before = database.execute("SELECT sql FROM sqlite_master ORDER BY name").fetchall()
    migrate(database)
    assert database.execute("SELECT sql FROM sqlite_master ORDER BY name").fetchall() == before


def test_a_newer_database_is_refused(database: sqlite3.Connection) -> None:
    database.execute(f"PRAGMA user_version = {VERSION + 1}")
    with pytest.raises(StoreError, match="newer version"):
        migrate(database)


def test_somebody_elses_database_is_refused() -> None:
    connection = sqlite3.connect(":memory:")
    connection.execute("CREATE TABLE bookmarks (url TEXT)")
    with pytest.raises(StoreError, match="not made by"):
        migrate(connection)
