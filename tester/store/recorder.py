"""The record's interface for a run: one verb for each kind of event. Two recorders: the writer, and the null recorder.

A verb makes rows and queues them; it touches no file. Statements of one verb are committed together. Verbs belong to
one thread, the scan's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, replace

from tester.analysis.results import Burst, ConditionStatus, RepeatResult, RepeatStatus, SoakCheck
from tester.analysis.wear_rate import WearCheck
from tester.store.kind_rows import axis_rows, budget_rows, setpoint_columns
from tester.store.records import (
    NAN,
    Calibration,
    Change,
    ConditionInfo,
    PieceInfo,
    RunInfo,
    SessionInfo,
    SpecimenInfo,
    StoredMaterial,
    Travel,
)
from tester.store.sql import (
    Batch,
    Judged,
    Statement,
    Ticket,
    Value,
    calibration_rows,
    calibration_sha256,
    columns_in,
    insert,
    judged_rows,
    text_sha256,
)

URGENT_SEVERITIES = frozenset({"alarm", "trip"})
"""Events of these severities are committed at once."""

_RESULT_FIELDS = tuple(field.name for field in fields(RepeatResult) if field.name != "means")
_BURST_FIELDS = tuple(field.name for field in fields(Burst))
_CONDITION_FIELDS = tuple(field.name for field in fields(ConditionInfo) if field.name != "setpoint")
_PIECE_FIELDS = tuple(field.name for field in fields(PieceInfo))
_SOAK_FIELDS = tuple(field.name for field in fields(SoakCheck))
_CHECK_FIELDS = tuple(field.name for field in fields(WearCheck))
_SESSION_FIELDS = tuple(field.name for field in fields(SessionInfo))
_MATERIAL_FIELDS = tuple(field.name for field in fields(StoredMaterial))
_CHANGE_FIELDS = tuple(field.name for field in fields(Change))


def no_utc() -> str:
    """Return the wall-clock text of a recorder without a clock: ""."""
    return ""


class Recorder:
    """The verbs of a record. Subclasses decide where the rows go."""

    def __init__(self, utc: Callable[[], str] = no_utc) -> None:
        """Count repeats, events, prompts and trips from 1; ``utc`` gives the wall clock as ISO 8601 text."""
        self._utc = utc
        self._repeats = 0
        self._events = 0
        self._prompts = 0
        self._trips = 0

    origin_s: float = 0.0
    """Offset of every recorded rig time: a resumed run counts from its interruption. Changed only while the queue is
    empty."""
    failed: str | None = None
    """Why nothing more can be written; the run must end in a controlled stop."""
    overruns: int = 0
    """Samples dropped because the queue was full."""
    heard: Callable[[float, str, str, str], None] | None = None
    """Called with every recorded event: rig time in s, kind, text, severity."""

    def sample(self, row: tuple[float, ...]) -> None:
        """Record one sample: a value for each recorded channel, as an exact tuple. For every scan: < 1 us."""
        raise TypeError("a recorder has to say what becomes of samples")

    def _put(self, batch: Batch) -> None:
        raise TypeError("a recorder has to say what becomes of statements")

    def _write(self, *statements: Statement, urgent: bool = False) -> Ticket:
        ticket = Ticket()
        self._put(Batch(statements, ticket, urgent))
        return ticket

    # The run

    def begin_run(
        self, info: RunInfo, specimens: Iterable[SpecimenInfo], conditions: Iterable[ConditionInfo]
    ) -> Ticket:
        """Store the plan: the run, its specimens and every condition."""
        run: dict[str, Value] = {
            "id": 1,
            "name": info.name,
            "kind": info.kind,
            "worn": info.worn,
            "recipe_name": info.recipe_name,
            "recipe_text": info.recipe_text,
            "recipe_sha256": text_sha256(info.recipe_text),
            "recipe_source": info.recipe_source,
            "rig_text": info.rig_text,
            "rig_sha256": text_sha256(info.rig_text),
            "rig_source": info.rig_source,
            "calibration_sha256": calibration_sha256(info.calibration),
            "simulated": int(info.simulated),
            "seed": info.seed,
            "operator": info.operator,
            "software_version": info.software_version,
            "git_revision": info.git_revision,
            "started_utc": info.started_utc,
            "status": "running",
        }
        statements = [insert("run", run)]
        statements += [insert("metadata", {"key": k, "value": v}) for k, v in info.metadata.items()]
        statements += [insert("version", {"component": k, "version": v}) for k, v in info.versions.items()]
        for specimen in specimens:
            columns = columns_in(specimen, ("specimen", "compound", "note"))
            statements.append(insert("specimen", columns))
        statements += axis_rows(info.axes)
        statements += [_to_come(condition) for condition in conditions]
        statements += calibration_rows(info.calibration, 1)
        statements += budget_rows(info.terms, info.known)
        statements += [insert("material", columns_in(material, _MATERIAL_FIELDS)) for material in info.materials]
        return self._write(*statements, urgent=True)

    def add_materials(self, materials: Iterable[StoredMaterial]) -> None:
        """Store further files of materials that a changed recipe names."""
        self._write(
            *(insert("material", columns_in(material, _MATERIAL_FIELDS)) for material in materials), urgent=True
        )

    def begin_session(self, session: SessionInfo) -> None:
        """Store the process that works on the run from now on; rig times count from its ``origin_s``."""
        self.origin_s = session.origin_s
        self._write(insert("session", columns_in(session, _SESSION_FIELDS)), urgent=True)

    def resume_run(self, changes: Iterable[Change] = ()) -> Ticket:
        """Store that an interrupted run is resumed: attempts that were cut off become void."""
        cut_off = (RepeatStatus.VOID.value, "cut off", RepeatStatus.OPEN.value)
        return self._write(
            ("UPDATE repeat SET status = ?, reason = ? WHERE status = ?", cut_off),
            ("UPDATE run SET status = 'running', reason = '', ended_utc = NULL, rig_seconds = NULL", ()),
            *(insert("change", columns_in(change, _CHANGE_FIELDS)) for change in changes),
            urgent=True,
        )

    def replace_recipe(self, text: str, to_come: Iterable[ConditionInfo], source: str) -> None:
        """Store the recipe of a resumed run; ``to_come``: its conditions that have not begun."""
        replaced: tuple[Value, ...] = (text, text_sha256(text), source)
        statements: list[Statement] = [
            ("UPDATE run SET recipe_text = ?, recipe_sha256 = ?, recipe_source = ?", replaced),
            ("DELETE FROM condition WHERE started_s IS NULL", ()),
        ]
        statements += [_to_come(condition) for condition in to_come]
        self._write(*statements, urgent=True)

    def replace_rig(self, text: str, calibration: Iterable[Calibration], session: int, source: str) -> None:
        """Store the rig file and the calibration of a resumed run."""
        figures = tuple(calibration)
        sql = "UPDATE run SET rig_text = ?, rig_sha256 = ?, calibration_sha256 = ?, rig_source = ?"
        replaced: Statement = (sql, (text, text_sha256(text), calibration_sha256(figures), source))
        self._write(replaced, *calibration_rows(figures, session), urgent=True)

    def add_metadata(self, values: Mapping[str, str]) -> None:
        """Store metadata of the run from now on; an existing key gets its new value."""
        sql = "INSERT OR REPLACE INTO metadata (key, value) VALUES (?, ?)"
        self._write(*((sql, (key, value)) for key, value in values.items()), urgent=True)

    def finish(self, status: str, reason: str = "", rig_seconds: float = NAN, ended_utc: str = "") -> Ticket:
        """Store the end: ``status`` such as finished, incomplete, tripped, stopped, failed; rig time in s."""
        sql = "UPDATE run SET status = ?, reason = ?, rig_seconds = ?, ended_utc = ?"
        at_s = rig_seconds + self.origin_s
        return self._write((sql, (status, reason, at_s, ended_utc or self._utc())), urgent=True)

    def truth(self, condition: int, repeat: int, attempt: int, figures: Mapping[str, float]) -> None:
        """Store the true values of an attempt at a repeat on a simulated rig, by name; no code of the program reads
        them."""
        of: dict[str, Value] = {"condition": condition, "repeat": repeat, "attempt": attempt}
        self._write(*(insert("truth", of | {"name": name, "value": value}) for name, value in figures.items()))

    def device_parameter(self, t_s: float, device: str, parameter: str, value: str, name: str = "") -> None:
        """Store a value read back from a device, e.g. wheel, 0x6083:00, '2000', profile acceleration."""
        columns: dict[str, Value] = {"t_s": t_s + self.origin_s, "device": device, "parameter": parameter}
        self._write(insert("device_parameter", columns | {"value": value, "name": name}))

    def bus_statistic(self, t_s: float, bus: str, device: str, counter: str, value: float) -> None:
        """Store a counter of a bus, or of one device on it (else an empty text)."""
        columns: dict[str, Value] = {"t_s": t_s + self.origin_s, "bus": bus, "device": device}
        self._write(insert("bus_statistic", columns | {"counter": counter, "value": value}))

    # What is mounted to be measured

    def piece_mounted(self, piece: PieceInfo) -> None:
        """Store that a piece was mounted."""
        times = {name: getattr(piece, name) + self.origin_s for name in ("installed_s", "updated_s", "ground_s")}
        columns = columns_in(piece, _PIECE_FIELDS) | times
        self._write(insert("piece", columns, "INSERT OR REPLACE"), urgent=True)

    def piece_state(self, piece: int, diameter_mm: float, sliding_m: float, t_s: float) -> None:
        """Store a piece's present diameter and the distance it has slid since it was new, for a resumed run."""
        sql = "UPDATE piece SET diameter_mm = ?, sliding_m = ?, updated_s = ? WHERE piece = ?"
        self._write((sql, (diameter_mm, sliding_m, t_s + self.origin_s, piece)))

    def piece_ground(self, piece: int, diameter_mm: float, sliding_m: float, t_s: float) -> None:
        """Store that a piece has been ground in: a resumed run does not repeat it."""
        at_s = t_s + self.origin_s
        sql = "UPDATE piece SET diameter_mm = ?, sliding_m = ?, updated_s = ?, ground_s = ? WHERE piece = ?"
        self._write((sql, (diameter_mm, sliding_m, at_s, at_s, piece)), urgent=True)

    def travelled(self, piece: int, travel: Travel, repeat_key: int = 0) -> None:
        """Store the travel of counterface and piece: at the beginning of a repeat, or (0) for a resumed run."""
        first: dict[str, Value] = {"piece": piece, "repeat_id": repeat_key}
        values = (travel.counterface_m, travel.piece_m, piece, repeat_key)
        sql = "UPDATE travel SET counterface_m = ?, piece_m = ? WHERE piece = ? AND repeat_id = ?"
        self._write(insert("travel", first, "INSERT OR IGNORE"), (sql, values))

    def wear_check(self, check: WearCheck) -> None:
        """Store a check of a diameter."""
        times = {name: getattr(check, name) + self.origin_s for name in ("t_s", "reference_s")}
        self._write(insert("wear_check", columns_in(check, _CHECK_FIELDS) | times), urgent=True)

    # Conditions and repeats

    def soaked(self, check: SoakCheck) -> None:
        """Store the readings of thermometer and heater's sensor at the end of a condition's soak."""
        self._write(insert("soak", columns_in(check, _SOAK_FIELDS) | {"t_s": check.t_s + self.origin_s}))

    def begin_condition(self, condition: int, t_s: float) -> None:
        """Store the start of a condition (its number in the plan)."""
        sql = "UPDATE condition SET started_s = ? WHERE condition = ? AND started_s IS NULL"
        self._write((sql, (t_s + self.origin_s, condition)))

    def condition_rate(self, condition: int, warming_k_s: float, holdable_band_k: float) -> None:
        """Store how fast a temperature ran away and which band would have held it, with the repeat that shows it."""
        sql = "UPDATE condition SET warming_k_s = ?, holdable_band_k = ? WHERE condition = ?"
        self._write((sql, (warming_k_s, holdable_band_k, condition)))

    def end_condition(
        self,
        condition: int,
        status: ConditionStatus,
        reason: str = "",
        t_s: float = NAN,
        *,
        warming_k_s: float = NAN,
        holdable_band_k: float = NAN,
        judged: Judged | None = None,
    ) -> None:
        """Store the end and the judgement of a condition. CANNOT_HOLD includes the rate in K/s and a sufficient band in
        K."""
        sql = (
            "UPDATE condition SET status = ?, reason = ?, ended_s = ?, warming_k_s = ?, holdable_band_k = ?"
            " WHERE condition = ?"
        )
        at_s = t_s + self.origin_s
        left: Statement = (sql, (status.value, reason, at_s, warming_k_s, holdable_band_k, condition))
        self._write(left, *judged_rows(judged), urgent=True)

    def begin_repeat(self, condition: int, repeat: int, attempt: int, t_s: float = NAN, piece: int = 0) -> int:
        """Store the start of an attempt at a repeat and return its key, the ``repeat_key`` of its samples."""
        self._repeats += 1
        columns: dict[str, Value] = {
            "id": self._repeats,
            "condition": condition,
            "repeat": repeat,
            "attempt": attempt,
            "piece": piece,
            "begun_s": t_s + self.origin_s,
            "status": RepeatStatus.OPEN.value,
        }
        self._write(insert("repeat", columns))
        return self._repeats

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Commit a repeat whole: its result, its bursts, every sample recorded so far, and the judgement of its
        condition.

        The repeat counts only once the ticket is done.
        """
        origin = self.origin_s
        times = {"started_s": result.started_s + origin, "ended_s": result.ended_s + origin}
        columns = columns_in(result, _RESULT_FIELDS) | {"status": result.status.value} | times | dict(result.means)
        assignments = ", ".join(f"{name} = ?" for name in columns)
        statements: list[Statement] = [(f"UPDATE repeat SET {assignments} WHERE id = ?", (*columns.values(), key))]
        for burst in bursts:
            at = replace(burst, started_s=burst.started_s + origin, ended_s=burst.ended_s + origin)
            statements.append(insert("burst", {"repeat_id": key} | columns_in(at, _BURST_FIELDS)))
        return self._write(*statements, *judged_rows(judged), urgent=True)

    def void_repeat(self, key: int, reason: str, t_s: float = NAN) -> Ticket:
        """Store that an attempt was interrupted; a further attempt follows."""
        result = RepeatResult(RepeatStatus.VOID, reason, ended_s=t_s)
        return self.commit_repeat(key, result)

    # The journal

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Record an event, in order. Severities: debug, info, warning, alarm, trip; the last two at once."""
        if self.heard is not None:
            self.heard(t_s, kind, text, severity)
        self._events += 1
        columns: dict[str, Value] = {
            "sequence": self._events,
            "t_s": t_s + self.origin_s,
            "utc": self._utc(),
            "kind": kind,
            "severity": severity,
            "text": text,
            "data": data,
        }
        self._write(insert("event", columns), urgent=severity in URGENT_SEVERITIES)

    def prompt(self, t_s: float, text: str) -> int:
        """Store a prompt and return its number."""
        self._prompts += 1
        columns: dict[str, Value] = {"id": self._prompts, "asked_s": t_s + self.origin_s, "asked_utc": self._utc()}
        self._write(insert("prompt", columns | {"text": text}))
        return self._prompts

    def prompt_answered(self, prompt: int, t_s: float, answer: str, by: str = "") -> None:
        """Store the answer to a prompt and its author."""
        sql = "UPDATE prompt SET answered_s = ?, answered_utc = ?, answer = ?, answered_by = ? WHERE id = ?"
        self._write((sql, (t_s + self.origin_s, self._utc(), answer, by, prompt)))

    def tare(self, t_s: float, kind: str, zeros: Mapping[str, float], repeat_key: int = 0) -> None:
        """Store a tare: the offset of each channel, by its name; kind: reference, repeat or check."""
        columns: dict[str, Value] = {"t_s": t_s + self.origin_s, "kind": kind, "repeat_id": repeat_key}
        self._write(insert("tare", {**columns, **zeros}))

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = NAN, limit: float = NAN, unit: str = ""
    ) -> int:
        """Store a trip with the value that caused it and its limit, in ``unit``; return its number."""
        self._trips += 1
        columns: dict[str, Value] = {
            "id": self._trips,
            "t_s": t_s + self.origin_s,
            "utc": self._utc(),
            "interlock": interlock,
            "text": text,
            "value": value,
            "limit_value": limit,
            "unit": unit,
        }
        self._write(insert("trip", columns), urgent=True)
        return self._trips

    def trip_acknowledged(self, trip: int, t_s: float, by: str = "") -> None:
        """Store that a trip was acknowledged during the run, and by whom."""
        sql = "UPDATE trip SET acknowledged_s = ?, acknowledged_utc = ?, acknowledged_by = ? WHERE id = ?"
        self._write((sql, (t_s + self.origin_s, self._utc(), by, trip)), urgent=True)

    # The file

    def flush(self) -> Ticket:
        """Commit everything recorded so far without waiting for the second to end."""
        return self._write(urgent=True)

    def close(self) -> None:
        """Commit the rest and close the file."""


def _to_come(condition: ConditionInfo) -> Statement:
    """Return the INSERT of a condition without measurements."""
    columns = columns_in(condition, _CONDITION_FIELDS) | setpoint_columns(condition.setpoint)
    return insert("condition", columns | {"status": ConditionStatus.PENDING.value})


class NullRecorder(Recorder):
    """Records nothing. It can be copied with its engine, unlike a writer."""

    def continue_from(self, other: Recorder) -> None:
        """Continue the numbering of another recorder."""
        self._repeats = other._repeats
        self._events = other._events
        self._prompts = other._prompts
        self._trips = other._trips

    def sample(self, row: tuple[float, ...]) -> None:
        """Drop the sample."""

    def _put(self, batch: Batch) -> None:
        batch.ticket.done = True
