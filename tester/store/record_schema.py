"""The database of a run: its tables, made from the record classes; its version; the migrations between versions.

There is one file ``run.db``, in WAL mode while it is written. The schema follows the domain: a run has specimens and
mounted pieces of them, its conditions have repeats, a repeat has bursts, and samples are in compressed blocks. Units
are in the column names. Rig time (``..._s``) is the run's own clock; ``..._utc`` is ISO 8601 text of the wall clock. A
value that does not exist is NULL (SQLite stores NaN as NULL, hence measured columns are not NOT NULL). Text holds what
a person wrote, unescaped.

Some tables receive further columns when a run begins (tester.store.kind_rows): ``condition`` one for each axis,
``repeat`` and ``tare`` one for each averaged channel.

The schema's number is SQLite's ``user_version``. It uses only what SQLite 3.34 supports: no STRICT tables, no
RETURNING.
"""

from __future__ import annotations

import sqlite3
from typing import Final

from tester import __version__
from tester.analysis.kelvin import KnownSlope
from tester.analysis.results import Burst, Judgement, RepeatResult, SoakCheck
from tester.analysis.terms import Term
from tester.analysis.wear_rate import WearCheck
from tester.base.trouble import TroubleError
from tester.store.journal_records import StoredEvent, StoredExclusion, StoredParameter, StoredPrompt, StoredTrip
from tester.store.records import (
    Calibration,
    Change,
    ConditionInfo,
    PieceInfo,
    RunInfo,
    SessionInfo,
    SpecimenInfo,
    StoredCondition,
    StoredMaterial,
    StoredRun,
    Travel,
)
from tester.store.sql import create

APPLICATION_ID = 0x46525431
"""``FRT1``: SQLite's application_id of a run's database; ``file`` and this program recognise it by this id."""

_ID = "id INTEGER PRIMARY KEY"
_POSITION = "position INTEGER PRIMARY KEY"
_STATUS = "status TEXT NOT NULL"
_REASON = "reason TEXT NOT NULL DEFAULT ''"
_SESSION = "session INTEGER NOT NULL"
_OF_CONDITION = "condition INTEGER NOT NULL REFERENCES condition (condition)"
_REPEAT_ID = "repeat_id INTEGER NOT NULL"

_RUN = (
    create(
        "run", "id INTEGER PRIMARY KEY CHECK (id = 1)", "ended_utc TEXT", _STATUS, _REASON,
        "overruns INTEGER NOT NULL DEFAULT 0", RunInfo, StoredRun,
    )
    + create("metadata", "key TEXT PRIMARY KEY", "value TEXT NOT NULL")
    + create("version", "component TEXT PRIMARY KEY", "version TEXT NOT NULL")
    + create("session", "session INTEGER PRIMARY KEY", "origin_s REAL NOT NULL", SessionInfo)
    + create("change", _ID, Change)
    + create("calibration", _ID, _SESSION, Calibration)
    + create("material", _ID, "file TEXT NOT NULL UNIQUE", StoredMaterial)
)  # fmt: skip
"""The run (``worn``: the kind's word for the part of the machine that wears), its sessions (one for each process that
worked on it), the changes between sessions with their reasons, and the history of the calibration. ``material``: files
of the compounds and surfaces that the recipe names. ``role`` is compound, surface, or data for a file to which one of
these refers; ``file`` is the path of the copy in the run's folder; ``text`` holds a short text, and is NULL for any
other file, where only the hash is recorded; ``doubts`` has a line for each doubt.
"""

_CHANNELS = (
    create(
        "axis", _POSITION, "name TEXT NOT NULL UNIQUE", "recipe_unit TEXT NOT NULL", "field TEXT NOT NULL UNIQUE",
        "unit TEXT NOT NULL", "scale REAL NOT NULL", "column_name TEXT NOT NULL", "header TEXT NOT NULL",
        "title TEXT NOT NULL", "word TEXT NOT NULL", "default_value", "paper INTEGER NOT NULL",
        "plotted INTEGER NOT NULL", "choices TEXT NOT NULL", "blocks INTEGER NOT NULL",
    )
    + create(
        "channel", _POSITION, "name TEXT NOT NULL UNIQUE", "unit TEXT NOT NULL", "label TEXT NOT NULL",
        "source TEXT NOT NULL", "mean INTEGER NOT NULL", "decimals INTEGER NOT NULL",
        "whole INTEGER NOT NULL CHECK (whole IN (0, 1))", "shown_name TEXT NOT NULL", "shown_unit TEXT NOT NULL",
        "scale REAL NOT NULL", "role TEXT NOT NULL", "block REAL", "screen TEXT NOT NULL",
    )
    + create(
        "budget_term", _POSITION, "acts TEXT NOT NULL", "bound REAL NOT NULL", "factor REAL NOT NULL", "df REAL", Term
    )
    + create(
        "known_slope", _POSITION, "temperature_c REAL NOT NULL", "per_kelvin_percent REAL NOT NULL",
        "u_per_kelvin_percent REAL NOT NULL", KnownSlope,
    )
)  # fmt: skip
"""Tables with which a record can be read without its kind of rig (tester.store.kind_rows): the axes of its conditions
(``field`` is the column of ``condition`` with the value), its channels (those with a source are the columns of its
samples, in order), the terms of its budgets (tester.analysis.terms; ``df`` NULL: regarded as known), and the compounds'
known sensitivity to temperature.
"""

_PIECES = (
    create("specimen", "specimen INTEGER PRIMARY KEY", SpecimenInfo)
    + create("piece", "piece INTEGER PRIMARY KEY", PieceInfo)
    + create("wear_check", _ID, "used INTEGER NOT NULL CHECK (used IN (0, 1))", WearCheck)
    + create("travel", _ID, "piece INTEGER NOT NULL", _REPEAT_ID, Travel, constraint="UNIQUE (piece, repeat_id)")
)
"""The mounted pieces: a specimen may have several, one after another. ``wear_check``: checks of a piece's diameter
between its conditions (``before`` and ``after``: their numbers, 0 for none), compared with the first of their series at
``reference_s``; ``expected_mm`` is the diameter assumed until the check. ``travel``: the counterface's travel under
load since the run began, and the piece's sliding, at the beginning of each repeat; with ``repeat_id`` 0, at the last
stored state of the piece.
"""

_CONDITIONS = (
    create(
        "condition", "condition INTEGER PRIMARY KEY", "compound TEXT NOT NULL", "temperature_band_k REAL NOT NULL",
        _STATUS, _REASON, ConditionInfo, StoredCondition, Judgement,
    )
    + create("soak", _ID, SoakCheck)
    + create(
        "repeat", _ID, _OF_CONDITION, "repeat INTEGER NOT NULL", "attempt INTEGER NOT NULL", "piece INTEGER NOT NULL",
        "begun_s REAL", _STATUS, RepeatResult,
        constraint="UNIQUE (condition, repeat, attempt)",
    )
    + create("burst", "repeat_id INTEGER NOT NULL REFERENCES repeat (id)", Burst,
             constraint="PRIMARY KEY (repeat_id, number)")
    + create("sample_block", _ID, _REPEAT_ID, "rows INTEGER NOT NULL", "first_s REAL", "last_s REAL",
             "data BLOB NOT NULL")
    + "CREATE INDEX sample_block_repeat ON sample_block (repeat_id);\n"
    + create("tare", _ID, "t_s REAL", "kind TEXT NOT NULL", _REPEAT_ID)
    + create("truth", _ID, "condition INTEGER NOT NULL", "repeat INTEGER NOT NULL", "attempt INTEGER NOT NULL",
             "name TEXT NOT NULL", "value REAL")
)  # fmt: skip
"""Conditions with the judgement of their repeats, and the measurements. ``soak``: the surface's thermometer compared
with the heater's sensor at the end of each soak (tester.analysis.results); a condition that soaked again after a hold
has a row for each soak. ``truth``: a simulated rig's true values of each repeat, on request (tester.run.simulated). It
is for tests that judge results; no reader returns it.
"""

_JOURNAL = (
    create("event", "sequence INTEGER PRIMARY KEY", StoredEvent)
    + create("prompt", _ID, "answered_utc TEXT", "answer TEXT", "answered_by TEXT", StoredPrompt)
    + create("trip", _ID, "acknowledged_utc TEXT", "acknowledged_by TEXT", StoredTrip)
    + create("bus_statistic", _ID, "t_s REAL", "bus TEXT NOT NULL", "device TEXT NOT NULL", "counter TEXT NOT NULL",
             "value REAL")
    + create("device_parameter", _ID, StoredParameter)
    + create("exclusion", _ID, _OF_CONDITION, "excluded INTEGER NOT NULL CHECK (excluded IN (0, 1))",
             "reason TEXT NOT NULL CHECK (reason <> '')", StoredExclusion)
    + """CREATE TRIGGER exclusion_is_not_changed BEFORE UPDATE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TRIGGER exclusion_is_not_deleted BEFORE DELETE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
"""
    + create("chain", "seq INTEGER PRIMARY KEY", "name TEXT NOT NULL", "key INTEGER NOT NULL",
             "row_sha256 BLOB NOT NULL", "head BLOB NOT NULL")
)  # fmt: skip
"""The journal. A trip that is acknowledged after the run has only ``acknowledged_utc``. ``exclusion``: repeats that a
person has excluded from a mean, or included again (``excluded`` 0): who, when, why. Rows are only ever added;
``manifest_before`` is the folder's earlier manifest, with the hashes of the record without this row. ``chain``: the
hashes over all rows (tester.store.chain).
"""

SCHEMA: Final = _RUN + _CHANNELS + _PIECES + _CONDITIONS + _JOURNAL
"""The tables of the newest version. A test compares them with ``tests/tester/store/schema.sql``: a new field of a
record class needs a migration.
"""

TIMES: Final = {
    "run": ("rig_seconds",),
    "condition": ("started_s", "ended_s"),
    "piece": ("installed_s", "updated_s", "ground_s"),
    "repeat": ("begun_s", "started_s", "ended_s"),
    "burst": ("started_s", "ended_s"),
    "sample_block": ("first_s", "last_s"),
    "event": ("t_s",),
    "prompt": ("asked_s", "answered_s"),
    "tare": ("t_s",),
    "wear_check": ("t_s", "reference_s"),
    "soak": ("t_s",),
    "trip": ("t_s", "acknowledged_s"),
    "bus_statistic": ("t_s",),
    "device_parameter": ("t_s",),
}
"""Columns of rig times, by table: these times continue after an interruption, and from one part of a run to the
next.
"""

MIGRATIONS: tuple[str, ...] = ()
"""SQL that migrates a record from version n to n + 1, beginning with version 1; never edited once released. A new
column without values changes no hash of the chain; a migration that changes values must chain those rows again.
"""

VERSION = 1 + len(MIGRATIONS)


class StoreError(TroubleError):
    """A run's database cannot be used; the message gives the reason, for people."""


class NotBegunError(StoreError):
    """A database without a run: the program ended before the first entry."""


def version_of(connection: sqlite3.Connection) -> int:
    """Return the schema's number, 0 for an empty database; raises StoreError for a file of an unknown version."""
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    application: int = connection.execute("PRAGMA application_id").fetchone()[0]
    if application != APPLICATION_ID and not (application == 0 and version == 0 and _empty(connection)):
        raise StoreError("this database was not made by friction-tester")
    if not 0 <= version <= VERSION:
        reads = f"schema {VERSION}" if VERSION == 1 else f"schemas 1 to {VERSION}"
        raise StoreError(
            f"recorded by another version of friction-tester, with schema {version}; "
            f"version {__version__} reads {reads}"
        )
    return version


def _empty(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0


def migrate(connection: sqlite3.Connection) -> None:
    """Create the tables in an empty database, or migrate that of an earlier version, each step in a transaction; raises
    StoreError.
    """
    version = version_of(connection)
    steps = {n + 1: MIGRATIONS[n - 1] for n in range(version, VERSION)} if version else {VERSION: SCHEMA}
    for number, sql in steps.items():
        connection.executescript(
            f"BEGIN;{sql}PRAGMA application_id = {APPLICATION_ID};PRAGMA user_version = {number};COMMIT;"
        )
