"""The database of a run: its tables, its version, the way from one version to the next.

One file ``run.db``, WAL while it is written. The schema reads like the domain: a run has specimens and pieces of them
that are mounted, its conditions have repeats, a repeat has bursts, samples lie in compressed blocks. Units are in the
column names; rig time (``..._s``) is the run's own clock, ``..._utc`` is ISO 8601 text of the wall clock. A value that
does not exist is NULL (SQLite stores NaN as such, hence no NOT NULL on what is measured). Text holds what a person
wrote, unescaped.

Some tables get further columns as a run begins: ``condition`` one for each axis (tester.store.kind_rows), ``repeat``
and ``tare`` one for each averaged channel (tester.store.channels).

The schema's number is SQLite's ``user_version``. Kept to what SQLite 3.34 knows: no STRICT tables, no RETURNING.
"""

from __future__ import annotations

import sqlite3
from typing import Final

from tester import __version__
from tester.base.trouble import TroubleError

APPLICATION_ID = 0x46525431
"""``FRT1``: SQLite's application_id of a run's database, by which ``file`` and this program recognise it."""

_RUN = """
CREATE TABLE run (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    name TEXT NOT NULL,
    kind TEXT NOT NULL,
    worn TEXT NOT NULL,
    recipe_name TEXT NOT NULL,
    recipe_text TEXT NOT NULL,
    recipe_sha256 TEXT NOT NULL,
    recipe_source TEXT NOT NULL,
    rig_text TEXT NOT NULL,
    rig_sha256 TEXT NOT NULL,
    rig_source TEXT NOT NULL,
    calibration_sha256 TEXT NOT NULL,
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
CREATE TABLE material (
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
"""The run (``worn``: the kind's word for the part of the machine that wears), its sessions (one for each process that
worked on it), the changes between them with reasons, and the calibration as a history. ``material``: files of the
compounds and surfaces that the recipe names. Its ``role`` is compound, surface, or data for a file that one of them
refers to; ``file`` is the path of the copy in the run's folder; ``text`` is NULL for anything but a short text, which
only its hash represents; ``doubts`` has a line for each."""

_CHANNELS = """
CREATE TABLE axis (
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
CREATE TABLE channel (
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
CREATE TABLE budget_term (
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
CREATE TABLE known_slope (
    position INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    temperature_c REAL NOT NULL,
    per_kelvin_percent REAL NOT NULL,
    u_per_kelvin_percent REAL NOT NULL,
    source TEXT NOT NULL
);
"""
"""Tables that make a record readable without its kind of rig: the axes of its conditions (tester.base.axes; ``field``
is the column of ``condition`` with the value), its channels (tester.store.channels; those with a source are the columns
of its samples, in order), the terms of its budgets (tester.analysis.terms; ``df`` NULL: taken as known), and the
compounds' known sensitivity to temperature."""

_PIECES = """
CREATE TABLE specimen (
    specimen INTEGER PRIMARY KEY,
    compound TEXT NOT NULL,
    note TEXT NOT NULL
);
CREATE TABLE piece (
    piece INTEGER PRIMARY KEY,
    specimen INTEGER NOT NULL,
    replicate INTEGER NOT NULL,
    compound TEXT NOT NULL,
    installed_s REAL,
    installed_diameter_mm REAL,
    diameter_mm REAL,
    sliding_m REAL,
    updated_s REAL,
    ground_s REAL
);
CREATE TABLE wear_check (
    id INTEGER PRIMARY KEY,
    piece INTEGER NOT NULL,
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
    expected_mm REAL,
    used INTEGER NOT NULL CHECK (used IN (0, 1))
);
CREATE TABLE travel (
    id INTEGER PRIMARY KEY,
    piece INTEGER NOT NULL,
    repeat_id INTEGER NOT NULL,
    counterface_m REAL,
    piece_m REAL,
    UNIQUE (piece, repeat_id)
);
"""
"""The mounted pieces: of a specimen, several in turn. ``wear_check``: checks of a piece's diameter between its
conditions (``before`` and ``after``: their numbers, 0 for none), compared with the first of their series at
``reference_s``; ``expected_mm`` is the diameter assumed until the check. ``travel``: the counterface's travel under
load since the run began, and the piece's sliding, at the beginning of each repeat; with ``repeat_id`` 0, at the last
stored state of the piece."""

_CONDITIONS = """
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
    both_directions INTEGER NOT NULL CHECK (both_directions IN (0, 1)),
    window_revolutions REAL,
    window_s REAL,
    started_s REAL,
    ended_s REAL,
    status TEXT NOT NULL,
    reason TEXT NOT NULL DEFAULT '',
    flags TEXT NOT NULL DEFAULT '',
    warming_k_s REAL,
    holdable_band_k REAL,
    drift_percent REAL,
    drift_error_percent REAL,
    drift_bound_percent REAL,
    per_kelvin_percent REAL,
    repeat_windows REAL,
    trend_percent REAL
);
CREATE TABLE soak (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    t_s REAL,
    surface_c REAL,
    model_c REAL,
    hub_c REAL,
    allowed_k REAL
);
CREATE TABLE repeat (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL REFERENCES condition (condition),
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    piece INTEGER NOT NULL,
    begun_s REAL,
    started_s REAL,
    ended_s REAL,
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
    change_percent REAL,
    swing_percent REAL,
    swing_hz REAL,
    swing_skewness REAL,
    revolutions INTEGER,
    truncated INTEGER,
    window_s REAL,
    bursts INTEGER,
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
CREATE TABLE sample_block (
    id INTEGER PRIMARY KEY,
    repeat_id INTEGER NOT NULL,
    rows INTEGER NOT NULL,
    first_s REAL,
    last_s REAL,
    data BLOB NOT NULL
);
CREATE INDEX sample_block_repeat ON sample_block (repeat_id);
CREATE TABLE tare (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    kind TEXT NOT NULL,
    repeat_id INTEGER NOT NULL
);
CREATE TABLE truth (
    id INTEGER PRIMARY KEY,
    condition INTEGER NOT NULL,
    repeat INTEGER NOT NULL,
    attempt INTEGER NOT NULL,
    name TEXT NOT NULL,
    value REAL
);
"""
"""Conditions with the judgement of their repeats, and the measurements. ``soak``: the surface's thermometer against the
heater's sensor at the end of each soak (tester.analysis.results); a condition that soaked again after a hold has a row
for each. ``truth``: a simulated rig's true values of each repeat, on request (tester.run.simulated); for tests that
judge results, no reader returns it."""

_JOURNAL = """
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
CREATE TABLE trip (
    id INTEGER PRIMARY KEY,
    t_s REAL,
    utc TEXT NOT NULL,
    interlock TEXT NOT NULL,
    text TEXT NOT NULL,
    value REAL,
    limit_value REAL,
    unit TEXT NOT NULL,
    acknowledged_s REAL,
    acknowledged_utc TEXT,
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
CREATE TABLE exclusion (
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
CREATE TRIGGER exclusion_is_not_changed BEFORE UPDATE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TRIGGER exclusion_is_not_deleted BEFORE DELETE ON exclusion
    BEGIN SELECT RAISE(ABORT, 'exclusions are only added'); END;
CREATE TABLE chain (
    seq INTEGER PRIMARY KEY,
    name TEXT NOT NULL,
    key INTEGER NOT NULL,
    row_sha256 BLOB NOT NULL,
    head BLOB NOT NULL
);
"""
"""The journal. A trip that is acknowledged after the run has ``acknowledged_utc`` alone. ``exclusion``: repeats that a
person has left out of a mean, or included again (``excluded`` 0): who, when, why. Rows are only ever added;
``manifest_before`` is the folder's earlier manifest, with the hashes of the record without this row. ``chain``: the
hashes over all rows (tester.store.chain)."""

SCHEMA: Final = _RUN + _CHANNELS + _PIECES + _CONDITIONS + _JOURNAL
"""Version 1."""

MIGRATIONS: tuple[str, ...] = ()
"""SQL that migrates from version n to n + 1, from 1 on, never edited once released. A new column without values changes
no hash of the chain; a migration that changes values must chain those rows again."""

VERSION = 1 + len(MIGRATIONS)


class StoreError(TroubleError):
    """A run's database cannot be used; the message gives the reason, for people."""


class NotBegunError(StoreError):
    """A database without a run: its program was cut off before the first entry."""


def version_of(connection: sqlite3.Connection) -> int:
    """Return the schema's number, 0 for an empty database; raises StoreError for another version's file."""
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    application: int = connection.execute("PRAGMA application_id").fetchone()[0]
    if application != APPLICATION_ID and not (application == 0 and version == 0 and _empty(connection)):
        raise StoreError("this database was not made by friction-tester")
    if version > VERSION:
        reads = f"schema {VERSION}" if VERSION == 1 else f"schemas 1 to {VERSION}"
        raise StoreError(
            f"recorded by another version of friction-tester, with schema {version}; "
            f"version {__version__} reads {reads}"
        )
    return version


def _empty(connection: sqlite3.Connection) -> bool:
    return connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0


def migrate(connection: sqlite3.Connection) -> None:
    """Migrate a database, or create an empty one, to the present schema, each step in a transaction; raises
    StoreError."""
    steps = (SCHEMA, *MIGRATIONS)
    for version in range(version_of(connection), VERSION):
        connection.executescript(
            f"BEGIN;{steps[version]}PRAGMA application_id = {APPLICATION_ID};"
            f"PRAGMA user_version = {version + 1};COMMIT;"
        )
