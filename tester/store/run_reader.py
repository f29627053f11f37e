"""Reads a run's database: the run, its conditions and repeats, samples, events. Never writes.

A run that is still being written, or was cut off, reads as far as it is committed.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, fields
from pathlib import Path
from tempfile import TemporaryDirectory
from types import TracebackType
from typing import TYPE_CHECKING, Literal, TypeVar

from tester.analysis.kelvin import KnownSlope
from tester.analysis.results import Burst, ConditionStatus, Judgement, RepeatResult, RepeatStatus, SoakCheck
from tester.analysis.terms import Term
from tester.analysis.wear_rate import WearCheck
from tester.base.axes import Axes
from tester.base.quantities import Means, Quantities
from tester.store import record_schema
from tester.store.chain import ChainFound, inspect
from tester.store.channels import recorded_channels
from tester.store.kind_rows import axes_of, setpoint_of, term_of
from tester.store.record_schema import NotBegunError, StoreError
from tester.store.records import (
    NAN,
    Calibration,
    Change,
    ConditionInfo,
    PieceInfo,
    RunInfo,
    SessionInfo,
    SpecimenInfo,
    StoredCondition,
    StoredEvent,
    StoredExclusion,
    StoredMaterial,
    StoredParameter,
    StoredPrompt,
    StoredRepeat,
    StoredRun,
    StoredTare,
    StoredTrip,
    Travel,
)
from tester.store.sample_blocks import unpack, unpack_array

if TYPE_CHECKING:
    from array import array

    import numpy as np
    from _typeshed import DataclassInstance
    from numpy.typing import NDArray

DATABASE = "run.db"

T = TypeVar("T", bound="DataclassInstance")

Cell = str | int | float | bytes | None
Row = Mapping[str, Cell]


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """A series of samples of one repeat (key 0: of none): columns by name, in order of time."""

    repeat_key: int
    rows: int
    columns: dict[str, array[float]]


def _text(row: Row, name: str) -> str:
    value = row[name]
    return "" if value is None else str(value)


def _text_or_none(row: Row, name: str) -> str | None:
    return None if row[name] is None else _text(row, name)


def _number(row: Row, name: str) -> float:
    value = row[name]
    return float(value) if isinstance(value, int | float) else NAN


def _whole(row: Row, name: str) -> int:
    value = row[name]
    return int(value) if isinstance(value, int | float) else 0


def _flag(row: Row, name: str) -> bool:
    return bool(row[name])


def _whole_or_none(row: Row, name: str) -> int | None:
    value = row[name]
    return value if isinstance(value, int) else None


def _optional(row: Row, name: str) -> float | None:
    value = row[name]
    return float(value) if isinstance(value, int | float) else None


_OF_A_TARE = ("id", "t_s", "kind", "repeat_id")
"""Columns of the table ``tare`` other than the zeros of channels."""
_READERS = {
    "str": _text, "float": _number, "int": _whole, "bool": _flag,
    "str | None": _text_or_none, "float | None": _optional, "int | None": _whole_or_none,
}  # fmt: skip


def _record(record: type[T], row: Row, **known: object) -> T:
    """Return a record whose fields are the row's columns of the same names, except those given."""
    values = {
        field.name: _READERS[str(field.type)](row, field.name) for field in fields(record) if field.name not in known
    }
    build: Callable[..., T] = record
    return build(**values, **known)


def _read_only(path: Path) -> sqlite3.Connection:
    """Return a read-only connection; raises sqlite3.Error."""
    uri = f"{path.absolute().as_uri()}?mode=ro"
    connection = sqlite3.connect(uri, uri=True)
    try:
        connection.execute("SELECT count(*) FROM sqlite_master")
    except sqlite3.OperationalError:
        # A power cut at the very beginning or end of a run leaves a rollback journal, which a reader must not play
        # back.
        connection.close()
        with closing(sqlite3.connect(path)) as repairing:
            repairing.execute("SELECT count(*) FROM sqlite_master")
        connection = sqlite3.connect(uri, uri=True)
    connection.row_factory = sqlite3.Row
    return connection


class RunReader:
    """A run's record, from its folder or its ``run.db``; use in a ``with`` block or close it.

    Raises StoreError for a missing database, or one that this version cannot read.
    """

    def __init__(self, path: Path) -> None:
        """Open the record for reading."""
        self.path = path / DATABASE if path.is_dir() else path
        self._copy: TemporaryDirectory[str] | None = None
        self._quantities: Quantities | None = None
        if not self.path.is_file():
            raise StoreError(f"no run in {path}")
        try:
            self._connection = self._opened()
        except sqlite3.Error as error:
            raise StoreError(f"{self.path} cannot be read: {error}") from error

    def _opened(self) -> sqlite3.Connection:
        connection = _read_only(self.path)
        try:
            version = record_schema.version_of(connection)
        except StoreError as error:
            connection.close()
            raise StoreError(f"{self.path}: {error}") from error
        if version == record_schema.VERSION:
            return connection
        # Created, but cut off before the schema was committed.
        if version == 0:
            connection.close()
            raise NotBegunError(f"{self.path}: the run was not begun")
        # An older record stays unchanged (its manifest holds); a copy is migrated to the present schema.
        self._copy = TemporaryDirectory(prefix="tester-", ignore_cleanup_errors=True)
        with closing(connection), closing(sqlite3.connect(Path(self._copy.name) / DATABASE)) as present:
            connection.backup(present)
            record_schema.migrate(present)
        return _read_only(Path(self._copy.name) / DATABASE)

    def __enter__(self) -> RunReader:
        """Return the reader."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._connection.close()
        if self._copy is not None:
            self._copy.cleanup()

    def quantities(self) -> Quantities:
        """Return the record's own channels; raises StoreError."""
        if self._quantities is None:
            try:
                self._quantities = recorded_channels(self._connection)
            except (sqlite3.Error, ValueError) as error:
                raise StoreError(f"{self.path} cannot be read: {error}") from error
            if self._quantities is None:
                raise NotBegunError(f"{self.path}: the run was not begun")
        return self._quantities

    def _rows(self, sql: str, values: tuple[Cell, ...] = ()) -> Iterator[Row]:
        try:
            for row in self._connection.execute(sql, values):
                yield dict(row)
        except sqlite3.Error as error:
            raise StoreError(f"{self.path} cannot be read: {error}") from error

    def run(self) -> StoredRun:
        """Return the run; raises StoreError if none is recorded."""
        for row in self._rows("SELECT * FROM run"):
            info = _record(
                RunInfo,
                row,
                calibration=tuple(self.calibration()),
                axes=self.axes(),
                terms=self.terms(),
                known=tuple(_record(KnownSlope, slope) for slope in self._rows("SELECT * FROM known_slope")),
                metadata=self._texts("metadata", "key", "value"),
                versions=self._texts("version", "component", "version"),
                materials=tuple(self.materials()),
            )
            return _record(StoredRun, row, info=info, rig_seconds=self._rig_seconds(row))
        raise NotBegunError(f"{self.path}: the run was not begun")

    def _rig_seconds(self, run: Row) -> float:
        if run["rig_seconds"] is not None:
            return _number(run, "rig_seconds")
        last = "SELECT max(t) AS t FROM (SELECT max(last_s) t FROM sample_block UNION SELECT max(t_s) FROM event)"
        return next((_number(row, "t") for row in self._rows(last) if row["t"] is not None), 0.0)

    def _texts(self, table: str, key: str, value: str) -> dict[str, str]:
        return {_text(row, key): _text(row, value) for row in self._rows(f"SELECT * FROM {table} ORDER BY rowid")}

    def axes(self) -> Axes:
        """Return the axes of the run's conditions."""
        return axes_of(self._rows("SELECT * FROM axis ORDER BY position"))

    def terms(self) -> tuple[Term, ...]:
        """Return the possible errors of the machine's measuring chain."""
        try:
            return tuple(map(term_of, self._rows("SELECT * FROM budget_term ORDER BY position")))
        except (TypeError, ValueError) as error:
            raise StoreError(f"{self.path}: the terms of its budget cannot be read: {error}") from error

    def warming(self) -> dict[int, float]:
        """Return how fast the surface warmed in the contacts of each repeat, K/s, by the repeat's key."""
        sql = (
            "SELECT repeat_id, sum(surface_last_c - surface_first_c) / sum(ended_s - started_s) AS rate FROM burst"
            " WHERE revolutions > 1 GROUP BY repeat_id"
        )
        return {_whole(row, "repeat_id"): _number(row, "rate") for row in self._rows(sql)}

    def travels(self) -> dict[int, Travel]:
        """Return how far counterface and piece had come at the beginning of each repeat, by the repeat's key."""
        rows = self._rows("SELECT * FROM travel WHERE repeat_id > 0")
        return {_whole(row, "repeat_id"): _record(Travel, row) for row in rows}

    def slid(self) -> dict[int, list[float]]:
        """Return the sliding of each piece at the beginning of its repeats and at its last stored state, m, in
        order."""
        slid: dict[int, list[float]] = {}
        for row in self._rows("SELECT piece, piece_m FROM travel WHERE piece_m IS NOT NULL ORDER BY piece_m"):
            slid.setdefault(_whole(row, "piece"), []).append(_number(row, "piece_m"))
        return slid

    def counterface_m(self) -> float:
        """Return the counterface's travel under load since the run began, m; 0 without a record."""
        rows = self._rows("SELECT coalesce(max(counterface_m), 0.0) AS travel_m FROM travel")
        return next(_number(row, "travel_m") for row in rows)

    def materials(self) -> list[StoredMaterial]:
        """Return the files of compounds and surfaces, each before the files that it refers to."""
        return [_record(StoredMaterial, row) for row in self._rows("SELECT * FROM material ORDER BY id")]

    def specimens(self) -> list[SpecimenInfo]:
        """Return the recipe's specimens."""
        return [_record(SpecimenInfo, row) for row in self._rows("SELECT * FROM specimen ORDER BY specimen")]

    def pieces(self) -> list[PieceInfo]:
        """Return the mounted pieces, with their last known wear."""
        return [_record(PieceInfo, row) for row in self._rows("SELECT * FROM piece ORDER BY piece")]

    def wear_checks(self) -> list[WearCheck]:
        """Return the checks of diameters in order of time."""
        return [_record(WearCheck, row) for row in self._rows("SELECT * FROM wear_check ORDER BY id")]

    def soaks(self) -> dict[int, SoakCheck]:
        """Return the readings of thermometer and heater's sensor at the end of the last soak of each condition."""
        checks = (_record(SoakCheck, row) for row in self._rows("SELECT * FROM soak ORDER BY id"))
        return {check.condition: check for check in checks}

    def conditions(self) -> list[StoredCondition]:
        """Return the plan's conditions in the recipe's order, replicates one after the other."""
        conditions: list[StoredCondition] = []
        axes = self.axes()
        for row in self._rows("SELECT * FROM condition ORDER BY row, replicate, condition"):
            status = ConditionStatus(_text(row, "status"))
            left = status if row["ended_s"] is not None or status is not ConditionStatus.PENDING else None
            info = _record(ConditionInfo, row, setpoint=setpoint_of(row, axes))
            judged = _record(Judgement, row)
            conditions.append(_record(StoredCondition, row, info=info, status=left, judged=judged))
        return conditions

    def repeats(self, condition: int | None = None, *, attempts: bool = False) -> list[StoredRepeat]:
        """Return the committed repeats, in order of condition and repeat: the last attempt of each.

        ``attempts``: every attempt instead, including void ones and the one in progress.
        """
        where, values = ("WHERE condition = ?", (condition,)) if condition is not None else ("", ())
        repeats: dict[tuple[int, ...], StoredRepeat] = {}
        channels = self.quantities()
        for row in self._rows(f"SELECT * FROM repeat {where} ORDER BY condition, repeat, attempt, id", values):
            status = RepeatStatus(_text(row, "status"))
            if not attempts and status in (RepeatStatus.OPEN, RepeatStatus.VOID):
                continue
            means = Means(channels, [_number(row, quantity.name) for quantity in channels.averaged])
            result = _record(RepeatResult, row, status=status, means=means)
            stored = _record(StoredRepeat, row, key=_whole(row, "id"), result=result)
            key = (stored.condition, stored.repeat, stored.attempt if attempts else 0)
            repeats[key] = stored
        return list(repeats.values())

    def bursts(self, repeat_key: int) -> list[Burst]:
        """Return the bursts of a committed repeat."""
        sql = "SELECT * FROM burst WHERE repeat_id = ? ORDER BY number"
        return [_record(Burst, row) for row in self._rows(sql, (repeat_key,))]

    def events(self) -> Iterator[StoredEvent]:
        """Yield the journal in order."""
        for row in self._rows("SELECT * FROM event ORDER BY sequence"):
            yield _record(StoredEvent, row)

    def event_data(self, kind: str) -> list[str]:
        """Return the data of a kind's events, in order, where they have any."""
        sql = "SELECT data FROM event WHERE kind = ? AND data <> '' ORDER BY sequence"
        return [_text(row, "data") for row in self._rows(sql, (kind,))]

    def commands(self) -> Iterator[StoredEvent]:
        """Yield the commands of clients, with their senders, in order; manual steps are left out."""
        for row in self._rows("SELECT * FROM event WHERE kind = 'command' AND severity <> 'debug' ORDER BY sequence"):
            yield _record(StoredEvent, row)

    def holds(self) -> Iterator[StoredEvent]:
        """Yield the ends of holds, in order; each text is the duration."""
        for row in self._rows("SELECT * FROM event WHERE kind = 'held' ORDER BY sequence"):
            yield _record(StoredEvent, row)

    def sessions(self) -> list[SessionInfo]:
        """Return the sessions of the run, one for each process."""
        return [_record(SessionInfo, row) for row in self._rows("SELECT * FROM session ORDER BY session")]

    def changes(self) -> list[Change]:
        """Return the changes between the sessions, with their reasons."""
        return [_record(Change, row) for row in self._rows("SELECT * FROM change ORDER BY id")]

    def calibration(self, session: int | None = None) -> list[Calibration]:
        """Return the calibration at the end, or from a session on in which it was changed."""
        which = "(SELECT max(session) FROM calibration)" if session is None else "?"
        values = () if session is None else (session,)
        rows = self._rows(f"SELECT * FROM calibration WHERE session = {which} ORDER BY id", values)
        return [_record(Calibration, row) for row in rows]

    def exclusions(self) -> list[StoredExclusion]:
        """Return people's decisions on single repeats, in order: left out, or included again."""
        return [_record(StoredExclusion, row) for row in self._rows("SELECT * FROM exclusion ORDER BY id")]

    def tares(self) -> Iterator[StoredTare]:
        """Yield the zeros of the load cell in order."""
        for row in self._rows("SELECT * FROM tare ORDER BY id"):
            zeros = {name: _number(row, name) for name in row.keys() if name not in _OF_A_TARE}  # noqa: SIM118 - a Row
            yield _record(StoredTare, row, zeros=zeros)

    def prompts(self) -> Iterator[StoredPrompt]:
        """Yield the questions to people with their answers, in order."""
        for row in self._rows("SELECT * FROM prompt ORDER BY id"):
            yield _record(StoredPrompt, row)

    def trips(self) -> Iterator[StoredTrip]:
        """Yield the trips in order."""
        for row in self._rows("SELECT * FROM trip ORDER BY id"):
            yield _record(StoredTrip, row)

    def parameters(self) -> Iterator[StoredParameter]:
        """Yield the values read back from the devices, in order."""
        for row in self._rows("SELECT * FROM device_parameter ORDER BY id"):
            yield _record(StoredParameter, row)

    def bus_statistics(self, bus: str) -> Iterator[tuple[str, float]]:
        """Yield counters of a bus and their values, in the order of storage."""
        for row in self._rows("SELECT counter, value FROM bus_statistic WHERE bus = ? ORDER BY id", (bus,)):
            yield _text(row, "counter"), _number(row, "value")

    def record_head(self) -> str:
        """Return the last head of the record's chain, hexadecimal."""
        last = self._rows("SELECT lower(hex(head)) AS head FROM chain ORDER BY seq DESC LIMIT 1")
        return next((_text(row, "head") for row in last), "")

    def chain(self) -> ChainFound:
        """Compare every row with the record's chain and return the result."""
        factory, self._connection.row_factory = self._connection.row_factory, None
        try:
            return inspect(self._connection)
        except (sqlite3.Error, TypeError, ValueError) as error:
            raise StoreError(f"{self.path}: the chain cannot be read: {error}") from error
        finally:
            self._connection.row_factory = factory

    def integrity_problems(self) -> list[str]:
        """Return the faults that SQLite's own check reports; empty for a sound file."""
        report = [_text(row, "integrity_check") for row in self._rows("PRAGMA integrity_check")]
        return [] if report == ["ok"] else report

    def count(self, table: Literal["repeat", "condition", "sample_block", "event"], where: str = "1") -> int:
        """Return how many rows a table has."""
        return next(_whole(row, "n") for row in self._rows(f"SELECT count(*) AS n FROM {table} WHERE {where}"))

    def sample_blocks(self) -> Iterator[SampleBlock]:
        """Yield all samples in order of time, block by block, in bounded memory; raises StoreError."""
        names = self.quantities().names
        for row in self._rows("SELECT * FROM sample_block ORDER BY id"):
            count = _whole(row, "rows")
            try:
                columns = unpack(_blob(row), count, len(names))
            except ValueError as error:
                raise StoreError(f"{self.path}, block {row['id']}: {error}") from error
            yield SampleBlock(_whole(row, "repeat_id"), count, dict(zip(names, columns, strict=True)))

    def samples(
        self, condition: int | None = None, repeat: int | None = None, attempt: int | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Return samples as NumPy arrays by column name, in order of time.

        They are those of a condition, of one repeat of it, of one attempt (default: the last) at it; without a
        condition all. Raises StoreError.
        """
        import numpy as np

        names = self.quantities().names
        blocks: list[NDArray[np.float64]] = [np.empty((len(names), 0))]
        for row in self._sample_rows(condition, repeat, attempt):
            try:
                blocks.append(unpack_array(_blob(row), _whole(row, "rows"), len(names)))
            except ValueError as error:
                raise StoreError(f"{self.path}, block {row['id']}: {error}") from error
        table = np.concatenate(blocks, axis=1)
        return {name: table[i] for i, name in enumerate(names)}

    def _sample_rows(self, condition: int | None, repeat: int | None, attempt: int | None) -> Iterator[Row]:
        if condition is None:
            yield from self._rows("SELECT * FROM sample_block ORDER BY id")
            return
        stored = self.repeats(condition, attempts=True)
        if repeat is not None:
            stored = [s for s in stored if s.repeat == repeat]
            wanted = attempt if attempt is not None else max((s.attempt for s in stored), default=0)
            stored = [s for s in stored if s.attempt == wanted]
        for key in sorted(s.key for s in stored):
            yield from self._rows("SELECT * FROM sample_block WHERE repeat_id = ? ORDER BY id", (key,))


def _blob(row: Row) -> bytes:
    data = row["data"]
    return data if isinstance(data, bytes) else b""
