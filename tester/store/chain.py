"""A chain of hashes over every row of a run's record, in the order of commits, which reveals later changes.

The table ``chain`` has an entry for each row at each commit that added, changed or deleted it:

  row_sha256 = SHA-256 of the JSON text [table, key, {column: value, ...}]      (null in place of a deleted row)
  head       = SHA-256 of (previous entry's head | row_sha256), 32 bytes each; 32 zero bytes before the first

``key`` is the row's rowid. Columns are in the table's order, without those that are NULL (a column that a later version
adds therefore changes no hash). Numbers are written as Python's ``repr`` writes them, text is escaped to ASCII, and a
blob is replaced by its own SHA-256. A person who can write the file can also rebuild the whole chain. The last head, if
a person keeps it elsewhere, reveals that.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256

Cell = str | int | float | bytes | None

TABLE = "chain"
START = bytes(32)
NAMED_AT_MOST = 5
"""Greatest number of rows of a table named in the list of problems; further rows are counted."""

_INSERT = "INSERT INTO chain (seq, name, key, row_sha256, head) VALUES (?, ?, ?, ?, ?)"


def tables_in(connection: sqlite3.Connection) -> list[str]:
    """Return the tables that the chain covers: all in the database but the chain itself and SQLite's own."""
    tables = connection.execute("SELECT name FROM main.sqlite_master WHERE type = 'table' ORDER BY name")
    return [name for (name,) in tables if name != TABLE and not name.startswith("sqlite_")]


def row_sha256(table: str, key: int, columns: Sequence[str], values: Sequence[Cell] | None) -> bytes:
    """Return the hash of a row; ``values`` None: the row was deleted."""
    row = None
    if values is not None:
        row = {name: _plain(v) for name, v in zip(columns, values, strict=True) if v is not None}
    return sha256(json.dumps([table, key, row], separators=(",", ":")).encode()).digest()


def _plain(value: Cell) -> object:
    return {"sha256": sha256(value).hexdigest()} if isinstance(value, bytes) else value


def next_head(head: bytes, row: bytes) -> bytes:
    """Return the new head of the chain after a row's hash is added."""
    return sha256(head + row).digest()


class Chain:
    """Chains the writes of one connection. Call ``seal`` before every COMMIT of a transaction that changes rows.

    Temporary triggers record which rows a transaction touches, so that no statement can be forgotten.
    """

    def __init__(self, connection: sqlite3.Connection) -> None:
        """Watch the tables of a database of the present schema, outside a transaction."""
        self._connection = connection
        connection.execute("PRAGMA temp_store = MEMORY")
        connection.execute(
            "CREATE TEMP TABLE touched"
            " (n INTEGER PRIMARY KEY, name TEXT, key INTEGER, UNIQUE (name, key) ON CONFLICT IGNORE)"
        )
        self._columns: dict[str, tuple[str, ...]] = {}
        for table in tables_in(connection):
            for verb, row in (("INSERT", "new"), ("UPDATE", "new"), ("DELETE", "old")):
                connection.execute(
                    f"CREATE TEMP TRIGGER touched_{table}_{verb} AFTER {verb} ON main.{table}"
                    f" BEGIN INSERT INTO touched (name, key) VALUES ('{table}', {row}.rowid); END"
                )

    def seal(self) -> None:
        """Add an entry for the present state of each row that this transaction has touched."""
        connection = self._connection
        touched = connection.execute("SELECT name, key FROM touched ORDER BY n").fetchall()
        if touched:
            add_entries(connection, ((name, key, self._hash(name, key)) for name, key in touched))
            connection.execute("DELETE FROM touched")

    def _hash(self, table: str, key: int) -> bytes:
        if table not in self._columns:  # read on first use: a new record receives its columns when the run begins
            self._columns[table] = columns_of(self._connection, table)
        columns = self._columns[table]
        row = self._connection.execute(f"SELECT {', '.join(columns)} FROM main.{table} WHERE rowid = ?", (key,))
        return row_sha256(table, key, columns, row.fetchone())


def columns_of(connection: sqlite3.Connection, table: str) -> tuple[str, ...]:
    """Return the names of a table's columns in their order."""
    return tuple(str(row[1]) for row in connection.execute(f"PRAGMA main.table_info({table})"))


def add_entries(connection: sqlite3.Connection, rows: Iterator[tuple[str, int, bytes]]) -> None:
    """Append rows (name of the table, key, hash) to the chain, inside a transaction."""
    last = connection.execute("SELECT seq, head FROM chain ORDER BY seq DESC LIMIT 1").fetchone()
    seq, head = (last[0], last[1]) if last is not None else (0, START)
    for name, key, row in rows:
        seq, head = seq + 1, next_head(head, row)
        connection.execute(_INSERT, (seq, name, key, row, head))


def hashes_of(connection: sqlite3.Connection, table: str) -> Iterator[tuple[int, bytes]]:
    """Yield key and hash of every row of a table."""
    columns = columns_of(connection, table)
    for row in connection.execute(f"SELECT rowid, {', '.join(columns)} FROM main.{table} ORDER BY rowid"):
        yield row[0], row_sha256(table, row[0], columns, tuple(row)[1:])


@dataclass(frozen=True, slots=True)
class ChainFound:
    """Result of inspecting a chain. ``heads``: its heads in order, as far as it is unbroken."""

    problems: tuple[str, ...]
    heads: tuple[bytes, ...]
    names: tuple[str, ...]
    """For each entry, the row in words, such as ``event 12``."""

    @property
    def head(self) -> str:
        """Return the last head, hexadecimal; "" for an empty chain."""
        return self.heads[-1].hex() if self.heads else ""


def inspect(connection: sqlite3.Connection) -> ChainFound:
    """Compare a record of this schema with its chain, in one snapshot, because a run may be in progress. Raises
    sqlite3.Error.
    """
    connection.execute("BEGIN")
    try:
        problems: list[str] = []
        latest: dict[tuple[str, int], bytes] = {}
        heads: list[bytes] = []
        names: list[str] = []
        head = START
        entries = connection.execute("SELECT seq, name, key, row_sha256, head FROM chain ORDER BY seq")
        for n, (seq, name, key, row, stored_head) in enumerate(entries, start=1):
            head = next_head(head, bytes(row))
            if seq != n or head != stored_head:
                problems.append(f"the chain is broken at entry {n}")
                break
            heads.append(head)
            names.append(f"{name} {key}")
            latest[name, key] = row
        for table in tables_in(connection):
            of_table = {key: row for (name, key), row in latest.items() if name == table}
            problems += _differences(table, of_table, connection)
        unknown = {name for name, _ in latest}.difference(tables_in(connection))
        problems += [f"the table {name} is gone" for name in sorted(unknown)]
    finally:
        connection.execute("ROLLBACK")
    return ChainFound(tuple(problems), tuple(heads), tuple(names))


def _differences(table: str, latest: dict[int, bytes], connection: sqlite3.Connection) -> Iterator[str]:
    """Yield the differences between a table's rows and the chain's last entries about them."""
    changed: list[int] = []
    strange: list[int] = []
    for key, row in hashes_of(connection, table):
        expected = latest.pop(key, None)
        if expected is None:
            strange.append(key)
        elif expected != row:
            changed.append(key)
    gone = [key for key, row in latest.items() if row != row_sha256(table, key, (), None)]
    for keys, words in ((changed, "changed"), (strange, "not in the chain"), (gone, "gone")):
        yield from (f"{table} {key}: {words}" for key in keys[:NAMED_AT_MOST])
        if len(keys) > NAMED_AT_MOST:
            yield f"{table}: {len(keys) - NAMED_AT_MOST} more rows {words}"
