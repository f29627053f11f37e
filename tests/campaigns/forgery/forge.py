"""Possible changes of a run's folder, and a new chain, tables and manifest to hide them."""

from __future__ import annotations

import shutil
import sqlite3
import zlib
from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.run_files import MANIFEST, manifest_text, write_all
from tester.results.verify import verify
from tester.store.chain import add_entries, hashes_of, tables_in
from tester.store.record_schema import VERSION
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import unpack_array


@dataclass(frozen=True, slots=True)
class Forgery:
    """One forgery: ``change`` alters the folder (second argument: another run's folder)."""

    name: str
    change: Callable[[Path, Path], None]


def _sql(*statements: str) -> Callable[[Path, Path], None]:
    def change(folder: Path, _other: Path) -> None:
        with closing(sqlite3.connect(folder / "run.db")) as database, database:
            for trigger in ("exclusion_is_not_changed", "exclusion_is_not_deleted"):
                database.execute(f"DROP TRIGGER {trigger}")
            for sql in statements:
                assert database.execute(sql).rowcount != 0, sql

    return change


def _samples(folder: Path, _other: Path) -> None:
    """Raise Fx of every sample by 3 %."""
    fx = QUANTITIES.index("force_x_n")
    with closing(sqlite3.connect(folder / "run.db")) as database, database:
        blocks = database.execute("SELECT id, rows, data FROM sample_block WHERE repeat_id > 0").fetchall()
        for key, rows, data in blocks:
            table = unpack_array(data, rows, len(QUANTITIES.names)).copy()
            table[fx] *= 1.03
            packed = zlib.compress(np.ascontiguousarray(table, dtype="<f8").tobytes(), 1)
            database.execute("UPDATE sample_block SET data = ? WHERE id = ?", (packed, key))


def _no_manifest(folder: Path, _other: Path) -> None:
    (folder / MANIFEST).unlink()


def _manifest_remade(folder: Path, _other: Path) -> None:
    """Change a reason and rebuild the manifest, with the record's own head."""
    _sql("UPDATE exclusion SET reason = 'debris'")(folder, folder)
    remake_manifest(folder)


def _table(folder: Path, _other: Path) -> None:
    """Replace a coefficient in conditions.csv and rebuild the manifest."""
    path = folder / "conditions.csv"
    text = path.read_text("utf-8")
    path.write_text(text.replace(",0.", ",1.", 1), encoding="utf-8", newline="")
    assert path.read_text("utf-8") != text
    remake_manifest(folder)


def _other_record(folder: Path, other: Path) -> None:
    shutil.copyfile(other / "run.db", folder / "run.db")


def _other_folder(folder: Path, other: Path) -> None:
    """Put the whole folder of another run under this run's name."""
    shutil.rmtree(folder)
    shutil.copytree(other, folder)


def _chain_dropped(version: int) -> Callable[[Path, Path], None]:
    """Raise every coefficient, drop the chain, and claim a schema; tables and manifest remain as a reader makes
    them."""

    def change(folder: Path, _other: Path) -> None:
        with closing(sqlite3.connect(folder / "run.db")) as database, database:
            database.executescript(
                "UPDATE repeat SET mu_resultant = 1.1 * mu_resultant;"
                f"DROP TABLE chain; PRAGMA user_version = {version};"
            )
        (folder / MANIFEST).write_text(manifest_text(folder, ""), encoding="utf-8")

    return change


_TABLE_OF_ANOTHER_VERSION = "UPDATE session SET software_version = '0.0.9'"


def _table_of_another_version(folder: Path, other: Path) -> None:
    """Replace a coefficient in a table, and mark an earlier version as its writer."""
    _sql(_TABLE_OF_ANOTHER_VERSION)(folder, other)
    _table(folder, other)


_SWAP = """UPDATE repeat SET mu_resultant = (SELECT r.mu_resultant FROM repeat r WHERE r.id = 3 - repeat.id)
 WHERE id IN (1, 2)"""
_CUT = "DELETE FROM chain WHERE seq >= (SELECT min(seq) FROM chain WHERE name = 'exclusion')"

FORGERIES = (
    Forgery("samples changed", _samples),
    Forgery("a repeat's mean", _sql("UPDATE repeat SET mu_resultant = mu_resultant * 1.02 WHERE id = 1")),
    Forgery("a trip's row deleted", _sql("DELETE FROM trip")),
    Forgery("operator's name", _sql("UPDATE run SET operator = 'somebody'")),
    Forgery("an exclusion's reason", _sql("UPDATE exclusion SET reason = 'debris'")),
    Forgery("last exclusion deleted", _sql("DELETE FROM exclusion WHERE id = (SELECT max(id) FROM exclusion)")),
    Forgery("an event deleted", _sql("DELETE FROM event WHERE sequence = 3")),
    Forgery("manifest removed", _no_manifest),
    Forgery("manifest remade over a changed reason", _manifest_remade),
    Forgery("tail of the chain cut with its rows", _sql(_CUT, "DELETE FROM exclusion")),
    Forgery("means of two repeats swapped", _sql(_SWAP)),
    Forgery("recipe's text", _sql("UPDATE run SET recipe_text = recipe_text || '# same'")),
    Forgery("a wear check", _sql("UPDATE wear_check SET diameter_mm = diameter_mm + 0.1 WHERE id = 1")),
    Forgery("a table exchanged, manifest remade", _table),
    Forgery("run.db of another run", _other_record),
    Forgery("another run's folder under this name", _other_folder),
    Forgery("chain dropped, this schema claimed", _chain_dropped(VERSION)),
    Forgery("chain dropped, an earlier schema claimed", _chain_dropped(-1)),
    Forgery("every sample deleted", _sql("DELETE FROM sample_block")),
    Forgery("a table exchanged under an earlier version", _table_of_another_version),
)


def remake_manifest(folder: Path) -> None:
    """Rebuild the manifest, over the present files."""
    with RunReader(folder) as reader:
        head = reader.record_head()
    (folder / MANIFEST).write_text(manifest_text(folder, head), encoding="utf-8")


def remake_all(folder: Path) -> None:
    """Rebuild the chain over the present rows, then tables and manifest: only a kept head reveals this."""
    with closing(sqlite3.connect(folder / "run.db")) as database, database:
        database.execute(f"PRAGMA user_version = {VERSION}")
        database.execute("CREATE TABLE IF NOT EXISTS chain (seq INTEGER PRIMARY KEY, name, key, row_sha256, head)")
        database.execute("DELETE FROM chain")
        rows = ((table, key, row) for table in tables_in(database) for key, row in hashes_of(database, table))
        add_entries(database, rows)
    write_all(folder)


def detected(run: Path, other: Path, forgery: Forgery, scratch: Path) -> tuple[bool, bool, bool, bool]:
    """Forge a copy of a run; return whether it is detected: with the head kept, without; and both again after
    rebuilding everything."""
    head = verify(run).head
    found: list[bool] = []
    for number, anew in enumerate((False, True)):
        folder = scratch / str(number) / run.name
        shutil.copytree(run, folder)
        forgery.change(folder, other)
        if anew:
            remake_all(folder)
        found += [bool(verify(folder, head).problems), bool(verify(folder).problems)]
        shutil.rmtree(folder)
    return found[0], found[1], found[2], found[3]
