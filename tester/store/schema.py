"""The database of a run: its tables, its version, its migrations.

One file ``run.db``, WAL while it is written. The schema reads like the domain: a run has specimens and
wheels, its conditions have repeats, a repeat has bursts, samples lie in compressed blocks. Units are in the
column names; rig time (``..._s``) is the run's own clock, ``..._utc`` is ISO 8601 text of the wall clock. A
value that does not exist is NULL (SQLite stores NaN as such, hence no NOT NULL on what is measured). Text
holds what a person wrote, unescaped.

The schema's number is SQLite's ``user_version``; migration n (from 0) leads from version n to n + 1 and is
never edited once released. Kept to what SQLite 3.34 knows: no STRICT tables, no RETURNING.
"""

from __future__ import annotations

import sqlite3
from typing import Final

from tester.store.chain import adopt

APPLICATION_ID = 0x46525431
"""``FRT1``: SQLite's application_id of a run's database, so that ``file`` and we know it from others."""

PIECE: Final = "wheel"
"""Table of what was mounted to be measured, and the column, there and elsewhere, of its number (``PieceInfo.piece``):
records keep the name that the first machine gave it."""

_VERSION_1 = """
CREATE TABLE run (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    name TEXT NOT NULL,
    recipe_name TEXT NOT NULL,
    recipe_text TEXT NOT NULL,
    recipe_sha256 TEXT NOT NULL,
    rig_text TEXT NOT NULL,
    rig_sha256 TEXT NOT NULL,
    simulated INTEGER NOT NULL,
    seed INTEGER,
    operator TEXT NOT NULL,
    software_version TEXT NOT NULL,
    git_revision TEXT NOT NULL,
    started_utc TEXT NOT NULL,
    ended_utc TEXT,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    rig_seconds REAL,
    overruns INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE metadata (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE version (component TEXT PRIMARY KEY, version TEXT NOT NULL);
CREATE TABLE specimen (
    specimen INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    note TEXT NOT NULL
);
CREATE TABLE wheel (
    wheel INTEGER PRIMARY KEY,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    compound TEXT NOT NULL,
    installed_s REAL,
    installed_diameter_mm REAL,
    diameter_mm REAL,
    sliding_m REAL,
    updated_s REAL
);
CREATE TABLE condition (
    condition INTEGER PRIMARY KEY,
    row INTEGER NOT NULL,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    grid TEXT NOT NULL,
    compound TEXT NOT NULL,
    note TEXT NOT NULL,
    slip_velocity_m_s REAL NOT NULL,
    load_n REAL NOT NULL,
    sideslip_deg REAL NOT NULL,
    camber_deg REAL NOT NULL,
    temperature_c REAL NOT NULL,
    wheel_speed_m_s REAL NOT NULL,
    temperature_band_k REAL NOT NULL,
    repeats INTEGER NOT NULL,
    min_valid INTEGER NOT NULL,
    window_revolutions REAL,
    window_s REAL,
    started_s REAL,
    ended_s REAL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    warming_k_s REAL,
    holdable_band_k REAL
);
CREATE TABLE repeat (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL REFERENCES condition (condition),
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    wheel INTEGER NOT NULL,
    begun_s REAL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    flags TEXT NOT NULL DEFAULT '',
    mu_resultant REAL,
    mu_longitudinal REAL,
    mu_lateral REAL,
    uncertainty REAL,
    fluctuation_percent REAL,
    batches INTEGER,
    drift_percent REAL,
    bound_percent REAL,
    revolutions INTEGER,
    truncated INTEGER,
    window_s REAL,
    bursts INTEGER,
    force_x_n REAL,
    force_y_n REAL,
    force_z_n REAL,
    moment_z_nm REAL,
    drive_torque_nm REAL,
    wheel_speed_m_s REAL,
    belt_speed_m_s REAL,
    slip_m_s REAL,
    sideslip_deg REAL,
    camber_deg REAL,
    surface_c REAL,
    hub_c REAL,
    started_s REAL,
    ended_s REAL,
    UNIQUE (condition, repeat, attempt)
);
CREATE TABLE burst (
    repeat_id INTEGER NOT NULL REFERENCES repeat (id),
    number INTEGER NOT NULL,
    revolutions INTEGER NOT NULL,
    started_s REAL,
    ended_s REAL,
    surface_first_c REAL,
    surface_last_c REAL,
    PRIMARY KEY (repeat_id, number)
);
CREATE TABLE sample_column (position INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE);
CREATE TABLE sample_block (
    id INTEGER PRIMARY KEY,
    repeat_id INTEGER NOT NULL,
    rows INTEGER NOT NULL,
    first_s REAL,
    last_s REAL,
    data BLOB NOT NULL
);
CREATE INDEX sample_block_repeat ON sample_block (repeat_id);
CREATE TABLE event (
    sequence INTEGER PRIMARY KEY,
    t_s REAL,
    utc TEXT NOT NULL,
    kind TEXT NOT NULL,
    severity TEXT NOT NULL,
    text TEXT NOT NULL,
    data TEXT NOT NULL
);
CREATE TABLE prompt (
    id INTEGER PRIMARY KEY,
    asked_s REAL,
    asked_utc TEXT NOT NULL,
    text TEXT NOT NULL,
    answered_s REAL,
    answered_utc TEXT,
    answer TEXT,
    answered_by TEXT
);
CREATE TABLE tare (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    kind TEXT NOT NULL,
    repeat_id INTEGER NOT NULL,
    force_x_n REAL,
    force_y_n REAL,
    force_z_n REAL,
    moment_z_nm REAL
);
CREATE TABLE trip (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    utc TEXT NOT NULL,
    interlock TEXT NOT NULL,
    text TEXT NOT NULL,
    value REAL,
    limit_value REAL,
    acknowledged_s REAL,
    acknowledged_by TEXT
);
CREATE TABLE bus_statistic (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    bus TEXT NOT NULL,
    device TEXT NOT NULL,
    counter TEXT NOT NULL,
    value REAL
);
CREATE TABLE device_parameter (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    device TEXT NOT NULL,
    parameter TEXT NOT NULL,
    name TEXT NOT NULL,
    value TEXT NOT NULL
);
"""

_VERSION_2 = """
ALTER TABLE wheel ADD COLUMN ground_s REAL;
ALTER TABLE run ADD COLUMN recipe_source TEXT NOT NULL DEFAULT '';
ALTER TABLE run ADD COLUMN rig_source TEXT NOT NULL DEFAULT '';
ALTER TABLE run ADD COLUMN calibration_sha256 TEXT NOT NULL DEFAULT '';
CREATE TABLE session (
    session INTEGER PRIMARY KEY,
    origin_s REAL NOT NULL,
    started_utc TEXT NOT NULL,
    host TEXT NOT NULL,
    pid INTEGER NOT NULL,
    operator TEXT NOT NULL,
    software_version TEXT NOT NULL,
    git_revision TEXT NOT NULL,
    versions TEXT NOT NULL
);
CREATE TABLE change (
    id INTEGER PRIMARY KEY,
    session INTEGER NOT NULL,
    utc TEXT NOT NULL,
    subject TEXT NOT NULL,
    before_sha256 TEXT NOT NULL,
    after_sha256 TEXT NOT NULL,
    before TEXT NOT NULL,
    reason TEXT NOT NULL
);
CREATE TABLE calibration (
    id INTEGER PRIMARY KEY,
    session INTEGER NOT NULL,
    device TEXT NOT NULL,
    quantity TEXT NOT NULL,
    value TEXT NOT NULL,
    unit TEXT NOT NULL
);
"""
"""What a resumed run needs: its stretches (``session``, one for each process that worked on it), what was changed
between them and why, when a wheel was ground in, and the calibration as a history."""

_EXCLUSION = """
CREATE {temporary}TABLE exclusion (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL REFERENCES condition (condition),
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    excluded INTEGER NOT NULL CHECK (excluded IN (0, 1)),
    reason TEXT NOT NULL CHECK (reason <> ''),
    operator TEXT NOT NULL,
    utc TEXT NOT NULL,
    software_version TEXT NOT NULL,
    manifest_before TEXT NOT NULL
);
"""

_VERSION_3 = f"""{_EXCLUSION.format(temporary="")}
CREATE TRIGGER exclusion_is_not_changed BEFORE UPDATE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TRIGGER exclusion_is_not_deleted BEFORE DELETE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
"""
"""Repeats that a person has left out of a mean, or taken in again (``excluded`` 0): who, when, why. Rows are only ever
added. ``manifest_before``: the folder's manifest as it was before, with the hashes of the record without this row."""

_JUDGEMENT = ("drift_percent", "drift_error_percent", "drift_bound_percent", "per_kelvin_percent", "repeat_windows",
              "trend_percent")  # fmt: skip

_VERSION_4 = """
ALTER TABLE condition ADD COLUMN at_most INTEGER NOT NULL DEFAULT 0;
ALTER TABLE condition ADD COLUMN until_percent REAL;
ALTER TABLE condition ADD COLUMN flags TEXT NOT NULL DEFAULT '';
UPDATE condition SET at_most = 2 * repeats;
""" + "".join(f"ALTER TABLE condition ADD COLUMN {name} REAL;\n" for name in _JUDGEMENT)
"""A condition's repeats are judged together: how many are made at most, until what precision, and what they say of its
drift. Before, a repeat was judged by itself, and ``at_most`` is what the same recipe means now."""

_AS_VERSION_4 = (
    "CREATE TEMP VIEW condition AS SELECT *, 2 * repeats AS at_most, NULL AS until_percent, '' AS flags, "
    + ", ".join(f"NULL AS {name}" for name in _JUDGEMENT)
    + " FROM main.condition"
)

_WEAR_CHECK = """
CREATE {temporary}TABLE wear_check (
    id INTEGER PRIMARY KEY,
    wheel INTEGER NOT NULL,
    method TEXT NOT NULL,
    t_s REAL,
    reference_s REAL,
    before INTEGER NOT NULL,
    after INTEGER NOT NULL,
    diameter_mm REAL,
    u_mm REAL,
    rubber_c REAL,
    u_growth_mm_k REAL,
    press_mm REAL,
    load_n REAL,
    sliding_m REAL,
    exposure_n_m REAL,
    width_mm REAL,
    u_rate_percent REAL,
    used INTEGER NOT NULL CHECK (used IN (0, 1))
);
"""
"""Checks of a wheel's diameter between its conditions (``before`` and ``after``: their numbers, 0 for none), held
against the first of their series at ``reference_s``; what their uncertainty comes from is in the row."""

_CHAIN = """
CREATE {temporary}TABLE chain (
    seq INTEGER PRIMARY KEY,
    name TEXT NOT NULL,
    key INTEGER NOT NULL,
    row_sha256 BLOB NOT NULL,
    head BLOB NOT NULL
);
"""
"""The chain of hashes over all rows (tester.store.chain)."""

_TRIP = """
ALTER TABLE trip ADD COLUMN unit TEXT;
ALTER TABLE trip ADD COLUMN acknowledged_utc TEXT;
"""
"""The unit of value and limit; when a trip was acknowledged, by the wall clock: the run may be over by then. Columns
without a value change no hash of a row that was there before."""

_AS_VERSION_6 = "CREATE TEMP VIEW trip AS SELECT *, NULL AS unit, NULL AS acknowledged_utc FROM main.trip;"

_CHANNEL = """
CREATE {temporary}TABLE channel (
    position INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    unit TEXT NOT NULL,
    label TEXT NOT NULL,
    source TEXT NOT NULL,
    mean INTEGER NOT NULL,
    decimals INTEGER NOT NULL,
    whole INTEGER NOT NULL CHECK (whole IN (0, 1)),
    shown_name TEXT NOT NULL,
    shown_unit TEXT NOT NULL,
    scale REAL NOT NULL,
    role TEXT NOT NULL,
    block REAL,
    screen TEXT NOT NULL
);
"""
"""The channels of the record, a row each (tester.store.channels); those with a source are the columns of its samples,
in order. ``repeat`` has a column for the mean of each that is averaged. Records begun before have none here: theirs are
those in ``sample_column``."""

_AXIS = """
CREATE {temporary}TABLE axis (
    position INTEGER PRIMARY KEY,
    name TEXT NOT NULL UNIQUE,
    recipe_unit TEXT NOT NULL,
    field TEXT NOT NULL UNIQUE,
    unit TEXT NOT NULL,
    scale REAL NOT NULL,
    column_name TEXT NOT NULL,
    header TEXT NOT NULL,
    title TEXT NOT NULL,
    word TEXT NOT NULL,
    default_value,
    paper INTEGER NOT NULL,
    plotted INTEGER NOT NULL,
    choices TEXT NOT NULL,
    blocks INTEGER NOT NULL
);
"""
"""The axes of the run's conditions (tester.base.axes): ``field`` is the column of ``condition`` that holds a value."""

_VERSION_8 = f"""{_AXIS.format(temporary="")}
{_CHANNEL.format(temporary="")}
ALTER TABLE run ADD COLUMN kind TEXT;
ALTER TABLE run ADD COLUMN worn TEXT;
"""
"""A record says of which kind of rig it is, what people call the part of it that wears, and which axes its conditions
have. Without a kind, and with no rows in
``axis``, it was begun by an older schema (tester.store.older)."""

_AS_VERSION_7 = f"{_AXIS}{_CHANNEL}CREATE TEMP VIEW run AS SELECT *, NULL AS kind, NULL AS worn FROM main.run;"

_BUDGET_TERM = """
CREATE {temporary}TABLE budget_term (
    position INTEGER PRIMARY KEY,
    name TEXT NOT NULL,
    acts TEXT NOT NULL,
    bound REAL NOT NULL,
    unit TEXT NOT NULL,
    distribution TEXT NOT NULL,
    source TEXT NOT NULL,
    channel TEXT NOT NULL,
    factor REAL NOT NULL,
    df REAL,
    common TEXT NOT NULL,
    setting TEXT NOT NULL,
    factor_setting TEXT NOT NULL
);
CREATE {temporary}TABLE known_slope (
    position INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    temperature_c REAL NOT NULL,
    per_kelvin_percent REAL NOT NULL,
    u_per_kelvin_percent REAL NOT NULL,
    source TEXT NOT NULL
);
"""
"""What the budget of a coefficient is made of: what the machine's measuring chain may be off by (tester.analysis.terms;
``df`` NULL: taken as known), and what is known of the compounds' sensitivity to temperature. Records begun before have
neither here (tester.store.older)."""

_TRUTH = """
CREATE {temporary}TABLE truth (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    name TEXT NOT NULL,
    value REAL
);
"""
"""What a simulated rig knows of each repeat beside what was measured, where that was asked for (tester.run.truth). For
tests that judge results: no reader gives it."""

_BOTH_DIRECTIONS = "ALTER TABLE condition ADD COLUMN both_directions INTEGER;"
"""1 where a condition's repeats alternate between the directions of sliding; NULL, as in every record begun before,
where they do not."""

_TRAVEL = """
CREATE {temporary}TABLE travel (
    id INTEGER PRIMARY KEY,
    wheel INTEGER NOT NULL,
    repeat_id INTEGER NOT NULL,
    counterface_m REAL,
    piece_m REAL,
    UNIQUE (wheel, repeat_id)
);
"""
"""How far the counterface had travelled under load since the run began, and how far what was mounted had slid, as each
repeat began. With ``repeat_id`` 0: as the state of what is mounted was recorded last."""

_MATERIAL = """
CREATE {temporary}TABLE material (
    id INTEGER PRIMARY KEY,
    role TEXT NOT NULL,
    name TEXT NOT NULL,
    file TEXT NOT NULL UNIQUE,
    source TEXT NOT NULL,
    sha256 TEXT NOT NULL,
    text TEXT,
    doubts TEXT NOT NULL
);
"""
"""Files of the compounds and surfaces that the recipe names: ``role`` is compound, surface, or data for a file that one
of them refers to; ``file`` is where the copy lies in the run's folder. ``text`` is NULL of what is no short text, which
its hash alone holds; ``doubts`` has a line for each."""

_LOOKED_AT = ("change_percent", "swing_percent", "swing_hz", "swing_skewness")
_CHANGE = "".join(f"ALTER TABLE repeat ADD COLUMN {name} REAL;\n" for name in _LOOKED_AT)
"""By how much friction changed at once within a repeat, and how it swung within a revolution: NULL of repeats recorded
before, which nothing looked at that way."""
_AS_VERSION_13 = (
    "CREATE TEMP VIEW repeat AS SELECT *, " + ", ".join(f"NULL AS {name}" for name in _LOOKED_AT) + " FROM main.repeat;"
)
_EXPECTED = "ALTER TABLE wear_check ADD COLUMN expected_mm REAL;"
"""The diameter that was reckoned with until a check; NULL in every record begun before."""

_SOAK = """
CREATE {temporary}TABLE soak (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    t_s REAL,
    surface_c REAL,
    model_c REAL,
    hub_c REAL,
    allowed_k REAL
);
"""
"""The surface's thermometer against the heater's sensor at the end of each soak (tester.analysis.soak_check); a
condition that soaked again after a hold has a row for each."""

_CONDITION = """
DROP TABLE condition;
CREATE TABLE condition (
    condition INTEGER PRIMARY KEY,
    row INTEGER NOT NULL,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    grid TEXT NOT NULL,
    compound TEXT NOT NULL,
    note TEXT NOT NULL,
    temperature_band_k REAL NOT NULL,
    repeats INTEGER NOT NULL,
    min_valid INTEGER NOT NULL,
    at_most INTEGER NOT NULL,
    until_percent REAL,
    window_revolutions REAL,
    window_s REAL,
    started_s REAL,
    ended_s REAL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    flags TEXT NOT NULL DEFAULT '',
    warming_k_s REAL,
    holdable_band_k REAL,
""" + ",\n".join(f"    {name} REAL" for name in _JUDGEMENT) + ");"
"""The conditions of a new record: a column for each axis is added as the run begins (tester.store.axes)."""

MIGRATIONS: tuple[str, ...] = (
    _VERSION_1,
    _VERSION_2,
    _VERSION_3,
    _VERSION_4,
    _WEAR_CHECK.format(temporary=""),
    _CHAIN.format(temporary=""),
    _TRIP,
    _VERSION_8,
    _BUDGET_TERM.format(temporary=""),
    _TRUTH.format(temporary=""),
    _BOTH_DIRECTIONS,
    _TRAVEL.format(temporary=""),
    _MATERIAL.format(temporary=""),
    _CHANGE,
    _SOAK.format(temporary=""),
    _EXPECTED,
)
"""Migration n leads from schema n to n + 1."""

CHAINED = 6
"""The first schema with a chain. A later migration that changes what rows hold has to add them to it again."""

KIND_SAID = 8
"""The first schema that says a record's kind and axes."""

ACKNOWLEDGED = 7
"""The first schema under which acknowledgements of trips are recorded."""

_ADDED: dict[int, str] = {
    3: _EXCLUSION,
    4: _AS_VERSION_4,
    5: _WEAR_CHECK,
    6: _CHAIN,
    7: _AS_VERSION_6,
    8: _AS_VERSION_7,
    9: _BUDGET_TERM,
    10: _TRUTH,
    11: "",  # its readers take a column that is not there for NULL
    12: _TRAVEL,
    13: _MATERIAL,
    14: _AS_VERSION_13,
    15: _SOAK,
    16: "",
}
"""What versions have added, by version: what a connection to an older record can have for itself."""

VERSION = len(MIGRATIONS)


class StoreError(Exception):
    """A run's database cannot be used; the message says why, for people."""


class NotBegunError(StoreError):
    """A database in which no run is recorded: its program was cut off before the first entry."""


def version_of(connection: sqlite3.Connection) -> int:
    """Return the schema's number, 0 of an empty database; raises StoreError if it is somebody else's."""
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    application: int = connection.execute("PRAGMA application_id").fetchone()[0]
    if application != APPLICATION_ID and not (application == 0 and version == 0 and _empty(connection)):
        raise StoreError("this database was not made by friction-tester")
    if version > VERSION:
        raise StoreError(f"made by a newer version (schema {version}; this one reads up to {VERSION})")
    return version


def _empty(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0


def reads_as_present(connection: sqlite3.Connection, version: int) -> bool:
    """Let an older database be read as one of the present schema without writing it; False where that cannot be.

    What a version has added, an empty table or columns without values, a connection can have for itself: as a temporary
    table, or as a temporary view in front of the table.
    """
    since = range(version + 1, VERSION + 1)
    if any(number not in _ADDED for number in since):
        return False
    for number in since:
        connection.executescript(_ADDED[number].format(temporary="TEMP "))
    return True


def migrate(connection: sqlite3.Connection) -> None:
    """Bring a database to the present schema, each step in a transaction of its own; raises StoreError."""
    found = version_of(connection)
    for version in range(found, VERSION):
        connection.executescript(
            f"BEGIN;{MIGRATIONS[version]}PRAGMA application_id = {APPLICATION_ID};PRAGMA user_version = {version + 1};"
        )
        if version + 1 == CHAINED:
            adopt(connection, found)
        if version + 1 == KIND_SAID and connection.execute("SELECT 1 FROM run").fetchone() is None:
            for statement in _CONDITION.split(";"):
                connection.execute(statement)
        connection.execute("COMMIT")
