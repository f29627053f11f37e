"""Reads a run's database: the run, its conditions and repeats, samples, events. Never writes.

If a run is still being written, or was interrupted, everything committed so far can be read.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from tester.analysis.kelvin import KnownSlope
from tester.analysis.results import Burst, ConditionStatus, Judgement, RepeatResult, RepeatStatus, SoakCheck
from tester.analysis.terms import Term
from tester.analysis.wear_rate import WearCheck
from tester.base.axes import Axes
from tester.base.quantities import Means
from tester.store.journal_records import (
    StoredEvent,
    StoredExclusion,
    StoredParameter,
    StoredPrompt,
    StoredTare,
    StoredTrip,
)
from tester.store.kind_rows import axes_of, setpoint_of, term_of
from tester.store.record_file import RecordFile
from tester.store.record_schema import NotBegunError, StoreError
from tester.store.records import (
    SURFACE_EVENT,
    Calibration,
    Change,
    ConditionInfo,
    PieceInfo,
    RunInfo,
    SessionInfo,
    SpecimenInfo,
    StoredCondition,
    StoredMaterial,
    StoredRepeat,
    StoredRun,
    Travel,
)
from tester.store.sample_blocks import unpack, unpack_array
from tester.store.sql import Row, blob, number, record, text, whole

if TYPE_CHECKING:
    from array import array

    import numpy as np
    from numpy.typing import NDArray

_OF_A_TARE = ("id", "t_s", "kind", "repeat_id")
"""Columns of the table ``tare`` other than the zeros of channels."""


@dataclass(frozen=True, slots=True)
class SampleBlock:
    """A series of samples of one repeat (key 0: of no repeat): columns by name, in order of time."""

    repeat_key: int
    rows: int
    columns: dict[str, array[float]]


class RunReader(RecordFile):
    """Reads a run's record."""

    def run(self) -> StoredRun:
        """Return the run; raises StoreError if none is recorded."""
        for row in self.rows("SELECT * FROM run"):
            rig_seconds = self._rig_seconds(row)
            info = record(
                RunInfo,
                row,
                calibration=tuple(self.calibration()),
                axes=self.axes(),
                terms=self.terms(),
                known=tuple(self.records(KnownSlope, "known_slope")),
                metadata=self._texts("metadata", "key", "value"),
                versions=self._texts("version", "component", "version"),
                materials=tuple(self.materials()),
            )
            return record(StoredRun, row, info=info, rig_seconds=rig_seconds)
        raise NotBegunError(f"{self.path}: the run was not begun")

    def _rig_seconds(self, run: Row) -> float:
        if run["rig_seconds"] is not None:
            return number(run, "rig_seconds")
        last = "SELECT max(t) AS t FROM (SELECT max(last_s) t FROM sample_block UNION SELECT max(t_s) FROM event)"
        return next((number(row, "t") for row in self.rows(last) if row["t"] is not None), 0.0)

    def _texts(self, table: str, key: str, value: str) -> dict[str, str]:
        return {text(row, key): text(row, value) for row in self.rows(f"SELECT * FROM {table} ORDER BY rowid")}

    def axes(self) -> Axes:
        """Return the axes of the run's conditions."""
        return axes_of(self.rows("SELECT * FROM axis ORDER BY position"))

    def terms(self) -> tuple[Term, ...]:
        """Return the possible errors of the machine's measuring chain."""
        try:
            return tuple(map(term_of, self.rows("SELECT * FROM budget_term ORDER BY position")))
        except (TypeError, ValueError) as error:
            raise StoreError(f"{self.path}: the terms of its budget cannot be read: {error}") from error

    def warming(self) -> dict[int, float]:
        """Return how fast the surface warmed during the contacts of each repeat, K/s, by the repeat's key."""
        sql = (
            "SELECT repeat_id, sum(surface_last_c - surface_first_c) / sum(ended_s - started_s) AS rate FROM burst"
            " WHERE revolutions > 1 GROUP BY repeat_id"
        )
        return {whole(row, "repeat_id"): number(row, "rate") for row in self.rows(sql)}

    def travels(self) -> dict[int, Travel]:
        """Return the travel of counterface and piece at the beginning of each repeat, by the repeat's key."""
        rows = self.rows("SELECT * FROM travel WHERE repeat_id > 0")
        return {whole(row, "repeat_id"): record(Travel, row) for row in rows}

    def slid(self) -> dict[int, list[float]]:
        """Return each piece's sliding at the beginning of its repeats and at its last stored state, m, in order."""
        slid: dict[int, list[float]] = {}
        for row in self.rows("SELECT piece, piece_m FROM travel WHERE piece_m IS NOT NULL ORDER BY piece_m"):
            slid.setdefault(whole(row, "piece"), []).append(number(row, "piece_m"))
        return slid

    def counterfaces_m(self) -> dict[str, float]:
        """Return the travel of each counterface under load since the run began, m, by its name; "" is a run's only one.

        Raises StoreError for a change of the surface that cannot be read.
        """
        changes = self.event_data(SURFACE_EVENT)
        if not changes:
            rows = self.rows("SELECT coalesce(max(counterface_m), 0.0) AS travel_m FROM travel")
            return {"": next(number(row, "travel_m") for row in rows)}
        try:
            last = json.loads(changes[-1])
            on, travels_m = str(last["on"]), {str(name): float(m) for name, m in last["travels_m"].items()}
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise StoreError(f"{self.path}: a change of the surface cannot be read: {error}") from error
        # The state of the piece used last is newer than the change: it was recorded with it, and after every repeat.
        rows = self.rows(
            "SELECT travel.counterface_m AS travel_m FROM travel JOIN piece ON piece.piece = travel.piece"
            " WHERE travel.repeat_id = 0 ORDER BY piece.updated_s DESC, piece.piece DESC LIMIT 1"
        )
        for row in rows:
            travels_m[on] = max(travels_m.get(on, 0.0), number(row, "travel_m"))
        return travels_m

    def materials(self) -> list[StoredMaterial]:
        """Return the files of compounds and surfaces, each before the files to which it refers."""
        return list(self.records(StoredMaterial, "material ORDER BY id"))

    def specimens(self) -> list[SpecimenInfo]:
        """Return the recipe's specimens."""
        return list(self.records(SpecimenInfo, "specimen ORDER BY specimen"))

    def pieces(self) -> list[PieceInfo]:
        """Return the mounted pieces, with their last known wear."""
        return list(self.records(PieceInfo, "piece ORDER BY piece"))

    def wear_checks(self) -> list[WearCheck]:
        """Return the checks of diameters in order of time."""
        return list(self.records(WearCheck, "wear_check ORDER BY id"))

    def soaks(self) -> dict[int, SoakCheck]:
        """Return the readings of the thermometer and the heater's sensor at the end of the last soak of each
        condition.
        """
        return {check.condition: check for check in self.records(SoakCheck, "soak ORDER BY id")}

    def conditions(self) -> list[StoredCondition]:
        """Return the plan's conditions in the recipe's order; replicates follow one another."""
        conditions: list[StoredCondition] = []
        axes = self.axes()
        for row in self.rows("SELECT * FROM condition ORDER BY row, replicate, condition"):
            status = ConditionStatus(text(row, "status"))
            left = status if row["ended_s"] is not None or status is not ConditionStatus.PENDING else None
            judged = record(Judgement, row)
            conditions.append(
                record(StoredCondition, row, status=left, judged=judged,
                       info=record(ConditionInfo, row, setpoint=setpoint_of(row, axes)))
            )  # fmt: skip
        return conditions

    def repeats(self, condition: int | None = None, *, attempts: bool = False) -> list[StoredRepeat]:
        """Return the committed repeats, in order of condition and repeat: the last attempt at each.

        ``attempts``: return every attempt instead, including void attempts and the one in progress.
        """
        where, values = ("WHERE condition = ?", (condition,)) if condition is not None else ("", ())
        repeats: dict[tuple[int, ...], StoredRepeat] = {}
        channels = self.quantities()
        for row in self.rows(f"SELECT * FROM repeat {where} ORDER BY condition, repeat, attempt, id", values):
            status = RepeatStatus(text(row, "status"))
            if not attempts and status in (RepeatStatus.OPEN, RepeatStatus.VOID):
                continue
            values_of_channels = [number(row, quantity.name) for quantity in channels.averaged]
            result = record(RepeatResult, row, status=status, means=Means(channels, values_of_channels))
            stored = record(StoredRepeat, row, key=whole(row, "id"), result=result)
            key = (stored.condition, stored.repeat, stored.attempt if attempts else 0)
            repeats[key] = stored
        return list(repeats.values())

    def bursts(self, repeat_key: int) -> list[Burst]:
        """Return the bursts of a committed repeat."""
        return list(self.records(Burst, "burst WHERE repeat_id = ? ORDER BY number", (repeat_key,)))

    def events(self) -> Iterator[StoredEvent]:
        """Yield the journal in order."""
        return self.records(StoredEvent, "event ORDER BY sequence")

    def event_data(self, kind: str) -> list[str]:
        """Return the data of a kind's events, in order, without events that have none."""
        sql = "SELECT data FROM event WHERE kind = ? AND data <> '' ORDER BY sequence"
        return [text(row, "data") for row in self.rows(sql, (kind,))]

    def commands(self) -> Iterator[StoredEvent]:
        """Yield the commands of clients, with their senders, in order; manual steps are left out."""
        return self.records(StoredEvent, "event WHERE kind = 'command' AND severity <> 'debug' ORDER BY sequence")

    def holds(self) -> Iterator[StoredEvent]:
        """Yield the events at the ends of holds, in order; each event's text is the duration."""
        return self.records(StoredEvent, "event WHERE kind = 'held' ORDER BY sequence")

    def sessions(self) -> list[SessionInfo]:
        """Return the sessions of the run, one for each process."""
        return list(self.records(SessionInfo, "session ORDER BY session"))

    def changes(self) -> list[Change]:
        """Return the changes between the sessions, with their reasons."""
        return list(self.records(Change, "change ORDER BY id"))

    def calibration(self, session: int | None = None) -> list[Calibration]:
        """Return the calibration at the end of the run, or that of a session; only a session that changes it records
        one.
        """
        which = "(SELECT max(session) FROM calibration)" if session is None else "?"
        values = () if session is None else (session,)
        return list(self.records(Calibration, f"calibration WHERE session = {which} ORDER BY id", values))

    def exclusions(self) -> list[StoredExclusion]:
        """Return people's decisions on single repeats, in order: excluded, or included again."""
        return list(self.records(StoredExclusion, "exclusion ORDER BY id"))

    def tares(self) -> Iterator[StoredTare]:
        """Yield the zeros of the load cell in order."""
        for row in self.rows("SELECT * FROM tare ORDER BY id"):
            zeros = {name: number(row, name) for name in row.keys() if name not in _OF_A_TARE}  # noqa: SIM118 - a Row
            yield record(StoredTare, row, zeros=zeros)

    def prompts(self) -> Iterator[StoredPrompt]:
        """Yield the questions to people with their answers, in order."""
        return self.records(StoredPrompt, "prompt ORDER BY id")

    def trips(self) -> Iterator[StoredTrip]:
        """Yield the trips in order."""
        return self.records(StoredTrip, "trip ORDER BY id")

    def parameters(self) -> Iterator[StoredParameter]:
        """Yield the values read back from the devices, in order."""
        return self.records(StoredParameter, "device_parameter ORDER BY id")

    def bus_statistics(self, bus: str) -> Iterator[tuple[str, float]]:
        """Yield counters of a bus and their values, in the order of storage."""
        for row in self.rows("SELECT counter, value FROM bus_statistic WHERE bus = ? ORDER BY id", (bus,)):
            yield text(row, "counter"), number(row, "value")

    def sample_blocks(self) -> Iterator[SampleBlock]:
        """Yield all samples in order of time, block by block, in bounded memory; raises StoreError."""
        names = self.quantities().names
        for row in self.rows("SELECT * FROM sample_block ORDER BY id"):
            count = whole(row, "rows")
            try:
                columns = unpack(blob(row, "data"), count, len(names))
            except ValueError as error:
                raise StoreError(f"{self.path}, block {row['id']}: {error}") from error
            yield SampleBlock(whole(row, "repeat_id"), count, dict(zip(names, columns, strict=True)))

    def samples(
        self, condition: int | None = None, repeat: int | None = None, attempt: int | None = None
    ) -> dict[str, NDArray[np.float64]]:
        """Return samples as NumPy arrays by column name, in order of time.

        They are those of a condition, of one repeat of it, or of one attempt at that repeat (default: the last).
        Without a condition they are all samples. Raises StoreError.
        """
        import numpy as np

        names = self.quantities().names
        blocks: list[NDArray[np.float64]] = [np.empty((len(names), 0))]
        for row in self._sample_rows(condition, repeat, attempt):
            try:
                blocks.append(unpack_array(blob(row, "data"), whole(row, "rows"), len(names)))
            except ValueError as error:
                raise StoreError(f"{self.path}, block {row['id']}: {error}") from error
        table = np.concatenate(blocks, axis=1)
        return {name: table[i] for i, name in enumerate(names)}

    def _sample_rows(self, condition: int | None, repeat: int | None, attempt: int | None) -> Iterator[Row]:
        if condition is None:
            yield from self.rows("SELECT * FROM sample_block ORDER BY id")
            return
        stored = self.repeats(condition, attempts=True)
        if repeat is not None:
            stored = [s for s in stored if s.repeat == repeat]
            wanted = attempt if attempt is not None else max((s.attempt for s in stored), default=0)
            stored = [s for s in stored if s.attempt == wanted]
        for key in sorted(s.key for s in stored):
            yield from self.rows("SELECT * FROM sample_block WHERE repeat_id = ? ORDER BY id", (key,))
