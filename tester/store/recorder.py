"""The record's interface for a run: one verb for each kind of event. Recorders: the writer, and the null recorder.

A verb makes rows and queues them; it accesses no file. The statements of one verb are committed together. Only the
scan's thread calls the verbs.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping

from tester.analysis.results import Burst, ConditionStatus, RepeatResult, RepeatStatus, SoakCheck
from tester.analysis.wear_rate import WearCheck
from tester.store.chain import Cell
from tester.store.journal_records import StoredEvent, StoredExclusion, StoredParameter
from tester.store.kind_rows import axis_rows, budget_rows, setpoint_columns
from tester.store.records import (
    NAN,
    SURFACE_EVENT,
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
from tester.store.row_queue import RowQueue
from tester.store.sql import (
    Batch,
    Judged,
    Statement,
    Ticket,
    calibration_rows,
    calibration_sha256,
    columns_in,
    insert,
    judged_rows,
    text_sha256,
    update,
)

URGENT_SEVERITIES = frozenset({"alarm", "trip"})
"""Events of these severities are committed at once."""


class Recorder(RowQueue):
    """The verbs of a record. Subclasses decide what happens to the rows."""

    # The run

    def begin_run(
        self, info: RunInfo, specimens: Iterable[SpecimenInfo], conditions: Iterable[ConditionInfo]
    ) -> Ticket:
        """Store the plan: the run, its specimens and every condition."""
        hashes: dict[str, Cell] = {
            "recipe_sha256": text_sha256(info.recipe_text),
            "rig_sha256": text_sha256(info.rig_text),
            "calibration_sha256": calibration_sha256(info.calibration),
        }
        return self._write(
            self._row("run", info, id=1, status="running", **hashes),
            *(self._row("metadata", key=key, value=value) for key, value in info.metadata.items()),
            *(self._row("version", component=name, version=version) for name, version in info.versions.items()),
            *(self._row("specimen", specimen) for specimen in specimens),
            *axis_rows(info.axes),
            *map(self._to_come, conditions),
            *calibration_rows(info.calibration, 1),
            *budget_rows(info.terms, info.known),
            *(self._row("material", material) for material in info.materials),
            urgent=True,
        )

    def _to_come(self, condition: ConditionInfo) -> Statement:
        """Return the INSERT of a condition without measurements."""
        status = ConditionStatus.PENDING.value
        return self._row("condition", condition, status=status, **setpoint_columns(condition.setpoint))

    def add_materials(self, materials: Iterable[StoredMaterial]) -> None:
        """Store further files of materials that a changed recipe names."""
        self._write(*(self._row("material", material) for material in materials), urgent=True)

    def begin_session(self, session: SessionInfo) -> None:
        """Store the process that now works on the run; rig times count from its ``origin_s``."""
        self.origin_s = session.origin_s
        self._write(self._row("session", session), urgent=True)

    def resume_run(self, changes: Iterable[Change] = ()) -> Ticket:
        """Store that an interrupted run resumes: attempts that were interrupted become void."""
        void: dict[str, Cell] = {"status": RepeatStatus.VOID.value, "reason": "cut off"}
        running: dict[str, Cell] = {"status": "running", "reason": "", "ended_utc": None, "rig_seconds": None}
        return self._write(
            self._change("repeat", void, status=RepeatStatus.OPEN.value),
            self._change("run", running),
            *(self._row("change", change) for change in changes),
            urgent=True,
        )

    def replace_recipe(self, text: str, to_come: Iterable[ConditionInfo], source: str) -> None:
        """Store the recipe of a resumed run; ``to_come``: its conditions that have not begun."""
        recipe = {"recipe_text": text, "recipe_sha256": text_sha256(text), "recipe_source": source}
        left_out: Statement = ("DELETE FROM condition WHERE started_s IS NULL", ())
        self._write(self._change("run", recipe), left_out, *map(self._to_come, to_come), urgent=True)

    def replace_rig(self, text: str, calibration: Iterable[Calibration], session: int, source: str) -> None:
        """Store the changed rig file and calibration of a resumed run."""
        figures = tuple(calibration)
        rig = {"rig_text": text, "rig_sha256": text_sha256(text), "rig_source": source}
        replaced = self._change("run", rig | {"calibration_sha256": calibration_sha256(figures)})
        self._write(replaced, *calibration_rows(figures, session), urgent=True)

    def add_metadata(self, values: Mapping[str, str]) -> None:
        """Store metadata of the run from now on; an existing key receives the new value."""
        rows = (insert("metadata", {"key": k, "value": v}, "INSERT OR REPLACE") for k, v in values.items())
        self._write(*rows, urgent=True)

    def finish(self, status: str, reason: str = "", rig_seconds: float = NAN, ended_utc: str = "") -> Ticket:
        """Store the end: ``status`` such as finished, incomplete, tripped, stopped, failed; rig time in s."""
        end: dict[str, Cell] = {"status": status, "reason": reason, "rig_seconds": rig_seconds}
        return self._write(self._change("run", end | {"ended_utc": ended_utc or self._utc()}), urgent=True)

    def truth(self, condition: int, repeat: int, attempt: int, figures: Mapping[str, float]) -> None:
        """Store the true values of an attempt at a repeat on a simulated rig, by name; no code of the program reads
        them.
        """
        of: dict[str, Cell] = {"condition": condition, "repeat": repeat, "attempt": attempt}
        self._write(*(self._row("truth", **of, name=name, value=value) for name, value in figures.items()))

    def device_parameter(self, t_s: float, device: str, parameter: str, value: str, name: str = "") -> None:
        """Store a value read back from a device, e.g. wheel, 0x6083:00, '2000', profile acceleration."""
        self._write(self._row("device_parameter", StoredParameter(t_s, device, parameter, name, value)))

    def bus_statistic(self, t_s: float, bus: str, device: str, counter: str, value: float) -> None:
        """Store a counter of a bus, or of one device on it (``device`` "" for the bus itself)."""
        self._write(self._row("bus_statistic", t_s=t_s, bus=bus, device=device, counter=counter, value=value))

    # What is mounted to be measured

    def piece_mounted(self, piece: PieceInfo) -> None:
        """Store that a piece was mounted."""
        columns = self._from_origin("piece", columns_in(piece))
        self._write(insert("piece", columns, "INSERT OR REPLACE"), urgent=True)

    def hardness(self, piece: int, shore_a: float, by: str) -> None:
        """Store the hardness of a mounted piece, Shore A, and the person who typed it."""
        read = {"hardness_shore_a": shore_a, "hardness_by": by, "hardness_utc": self._utc()}
        self._write(self._change("piece", read, piece=piece), urgent=True)

    def piece_state(self, piece: int, diameter_mm: float, sliding_m: float, t_s: float) -> None:
        """Store a piece's present diameter and the distance it has slid since it was new, for a resumed run."""
        state = {"diameter_mm": diameter_mm, "sliding_m": sliding_m, "updated_s": t_s}
        self._write(self._change("piece", state, piece=piece))

    def piece_ground(self, piece: int, diameter_mm: float, sliding_m: float, t_s: float) -> None:
        """Store that a piece has been ground in, so that a resumed run does not grind it in again."""
        state = {"diameter_mm": diameter_mm, "sliding_m": sliding_m, "updated_s": t_s, "ground_s": t_s}
        self._write(self._change("piece", state, piece=piece), urgent=True)

    def travelled(self, piece: int, travel: Travel, repeat_key: int = 0) -> None:
        """Store the travel of counterface and piece: at a repeat's beginning, or (key 0) as a resumed run's state."""
        of: dict[str, Cell] = {"piece": piece, "repeat_id": repeat_key}
        self._write(insert("travel", of, "INSERT OR IGNORE"), update("travel", columns_in(travel), of))

    def wear_check(self, check: WearCheck) -> None:
        """Store a check of a diameter."""
        self._write(self._row("wear_check", check), urgent=True)

    # Conditions and repeats

    def soaked(self, check: SoakCheck) -> None:
        """Store the readings of the thermometer and the heater's sensor at the end of a condition's soak."""
        self._write(self._row("soak", check))

    def begin_condition(self, condition: int, t_s: float) -> None:
        """Store the start of a condition (its number in the plan)."""
        sql = "UPDATE condition SET started_s = ? WHERE condition = ? AND started_s IS NULL"
        self._write((sql, (t_s + self.origin_s, condition)))

    def condition_rate(self, condition: int, warming_k_s: float, holdable_band_k: float) -> None:
        """Store, with the repeat that shows them, how fast the temperature left its band and which band could be
        held.
        """
        rate = {"warming_k_s": warming_k_s, "holdable_band_k": holdable_band_k}
        self._write(self._change("condition", rate, condition=condition))

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
        """Store the end and the judgement of a condition. For CANNOT_HOLD that includes the rate in K/s and a
        sufficient band in K.
        """
        end: dict[str, Cell] = {"status": status.value, "reason": reason, "ended_s": t_s}
        rate = {"warming_k_s": warming_k_s, "holdable_band_k": holdable_band_k}
        self._write(self._change("condition", end | rate, condition=condition), *judged_rows(judged), urgent=True)

    def begin_repeat(self, condition: int, repeat: int, attempt: int, t_s: float = NAN, piece: int = 0) -> int:
        """Store the start of an attempt at a repeat; return its key, which its samples have as ``repeat_key``."""
        self._repeats += 1
        of: dict[str, Cell] = {"condition": condition, "repeat": repeat, "attempt": attempt, "piece": piece}
        self._write(self._row("repeat", id=self._repeats, begun_s=t_s, status=RepeatStatus.OPEN.value, **of))
        return self._repeats

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Commit a complete repeat: its result, its bursts, every sample recorded so far, and the judgement of its
        condition.

        The repeat counts only once the ticket is done.
        """
        columns = columns_in(result) | {"status": result.status.value} | dict(result.means)
        return self._write(
            self._change("repeat", columns, id=key),
            *(self._row("burst", burst, repeat_id=key) for burst in bursts),
            *judged_rows(judged),
            urgent=True,
        )

    def void_repeat(self, key: int, reason: str, t_s: float = NAN) -> Ticket:
        """Store that an attempt was interrupted; a further attempt follows."""
        return self.commit_repeat(key, RepeatResult(RepeatStatus.VOID, reason, ended_s=t_s))

    # The journal

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Record an event, in order. Severities: debug, info, warning, alarm, trip; the last two commit at once."""
        if self.on_event is not None:
            self.on_event(t_s, kind, text, severity)
        self._events += 1
        event = StoredEvent(self._events, t_s, self._utc(), kind, severity, text, data)
        self._write(self._row("event", event), urgent=severity in URGENT_SEVERITIES)

    def surface_changed(self, t_s: float, surface: str, travels_m: Mapping[str, float]) -> None:
        """Record that a surface was put under the rubber, with the travel of each surface under load so far, m."""
        data = json.dumps({"on": surface, "travels_m": dict(travels_m)})
        before = travels_m.get(surface, 0.0)
        self.event(t_s, SURFACE_EVENT, f"{surface} is on, after {before:.0f} m under load", data=data)

    def decision(self, exclusion: StoredExclusion) -> Ticket:
        """Store a person's decision on a committed repeat."""
        return self._write(self._row("exclusion", exclusion, id=None), urgent=True)

    def prompt(self, t_s: float, text: str) -> int:
        """Store a prompt and return its number."""
        self._prompts += 1
        self._write(self._row("prompt", id=self._prompts, asked_s=t_s, asked_utc=self._utc(), text=text))
        return self._prompts

    def prompt_answered(self, prompt: int, t_s: float, answer: str, by: str = "") -> None:
        """Store the answer to a prompt, and the person who gave it."""
        answered = {"answered_s": t_s, "answered_utc": self._utc(), "answer": answer, "answered_by": by}
        self._write(self._change("prompt", answered, id=prompt))

    def tare(self, t_s: float, kind: str, zeros: Mapping[str, float], repeat_key: int = 0) -> None:
        """Store a tare: the offset of each channel, by its name. ``kind``: reference, repeat or check."""
        self._write(self._row("tare", t_s=t_s, kind=kind, repeat_id=repeat_key, **zeros))

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = NAN, limit: float = NAN, unit: str = ""
    ) -> int:
        """Store a trip with the value that caused it and its limit, in ``unit``; return its number."""
        self._trips += 1
        when: dict[str, Cell] = {"id": self._trips, "t_s": t_s, "utc": self._utc()}
        what: dict[str, Cell] = {"interlock": interlock, "text": text}
        self._write(self._row("trip", **when, **what, value=value, limit_value=limit, unit=unit), urgent=True)
        return self._trips

    def trip_acknowledged(self, trip: int, t_s: float, by: str = "") -> None:
        """Store that a trip was acknowledged during the run, and by whom."""
        acknowledged = {"acknowledged_s": t_s, "acknowledged_utc": self._utc(), "acknowledged_by": by}
        self._write(self._change("trip", acknowledged, id=trip), urgent=True)

    # The file

    def flush(self) -> Ticket:
        """Commit everything recorded so far at once, without waiting for the next regular commit."""
        return self._write(urgent=True)

    def close(self) -> None:
        """Commit the rest and close the file."""


class NullRecorder(Recorder):
    """A recorder that records nothing. Unlike a writer, it can be copied with its engine."""

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
