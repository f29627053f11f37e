"""A run as the page shows it: its conditions as a grid over the axes, its repeats, marks and regions on rig time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import zip_longest
from math import isfinite
from typing import Any, Final

from tester.analysis.results import ConditionStatus
from tester.base.axes import Axis, condition_words
from tester.base.words import finite
from tester.page.stored.drawn_columns import drawn_columns
from tester.page.stored.run_cache import QuestionError
from tester.results.columns import Table, unit_of
from tester.results.conditions_table import ConditionRow, conditions_table
from tester.results.measured_tables import CommittedRepeat, repeats_table
from tester.results.run_results import RunResults
from tester.service.protocol import Event
from tester.service.recorded_steps import recorded_steps
from tester.store.journal_records import StoredEvent
from tester.store.notes import notes_of, tags_of
from tester.store.run_folders import RunStatus
from tester.store.run_reader import RunReader

MOST_MARKS = 5000
"""Marks that a page receives, the last ones; a run makes some hundred an hour."""
SEVERE: Final = ("warning", "alarm", "trip")


def run_page(reader: RunReader, results: RunResults) -> dict[str, Any]:
    """Return everything about a run but its samples."""
    run, info = results.run, results.run.info
    events = list(reader.events())
    table = conditions_table(results)
    length_s = _length_s(reader, results)
    shown = [Event(e.sequence, e.t_s, e.utc, e.kind, e.severity, e.text, info.name) for e in events]
    steps = recorded_steps(shown, length_s)
    return {
        "run": info.name, "recipe": info.recipe_name, "status": results.status.value, "reason": run.reason,
        "operator": info.operator, "started_utc": info.started_utc, "simulated": info.simulated, "risk": info.risk,
        "rig_s": run.rig_seconds, "t0_s": 0.0, "t1_s": length_s,
        "plan": [
            {"n": n, "text": step.title, "kind": step.kind, "from_s": step.began_s, "to_s": step.ended_s}
            for n, step in enumerate(steps, 1)
        ],
        "axes": [
            {"key": "compound", "title": "compound", "unit": ""},
            *({"key": a.name, "title": a.name.replace("_", " "), "unit": unit_of(a)} for a in results.axes),
        ],
        "conditions": [_condition(row, table, results) for row in table.rows if row.measured is not None],
        "combined": [_combined(row, table) for row in table.rows if row.measured is None],
        "marks": [_mark(event) for event in events if event.severity != "debug"][-MOST_MARKS:],
        "regions": list(_regions(reader, results, events, length_s)),
        "columns": [column.as_json() for column in drawn_columns(results.quantities)],
        "notes": [{"utc": note.utc, "by": note.by, "text": note.text} for note in notes_of(reader) if note.text],
        "tags": list[Any](tags_of(reader)),
    }  # fmt: skip


def condition_page(results: RunResults, number: int) -> dict[str, Any]:
    """Return a condition and its repeats. Raises QuestionError for a number that the run does not have."""
    table = conditions_table(results)
    row = next((r for r in table.rows if r.measured is not None and r.info.condition == number), None)
    if row is None:
        raise QuestionError(f"n: the run has no condition {number}")
    repeats = repeats_table(results)
    return {
        **_condition(row, table, results),
        "repeats": [_repeat(one, repeats) for one in repeats.rows if one.measured is row.measured],
    }


def _length_s(reader: RunReader, results: RunResults) -> float:
    rows = reader.rows("SELECT coalesce(max(last_s), 0.0) AS t FROM sample_block")
    last = next(row["t"] for row in rows)
    return max(results.run.rig_seconds, float(last) if isinstance(last, int | float) else 0.0)


def axis_values(row: ConditionRow, axes: Iterable[Axis]) -> dict[str, Any]:
    """Return a condition's place: compound, and the value of each axis in its unit for people."""
    setpoint = row.info.setpoint
    return {"compound": setpoint.compound, **{axis.name: axis.of(setpoint) for axis in axes}}


def _value(row: ConditionRow, table: Table[ConditionRow]) -> dict[str, Any]:
    """Return coefficient and U, in full and in the words of `tester show`."""
    mu, u = table["mu"], table["u_expanded"]
    compound = table["u_expanded_compound"]
    return {
        "mu": mu.as_json(row), "u": u.as_json(row), "u_compound": compound.as_json(row), "mark": row.mark,
        "mu_text": mu.text(row), "u_text": u.text(row), "u_compound_text": compound.text(row),
    }  # fmt: skip


def _condition(row: ConditionRow, table: Table[ConditionRow], results: RunResults) -> dict[str, Any]:
    return {
        "n": row.info.condition, "text": condition_words(row.info.setpoint), "axes": axis_values(row, results.axes),
        **_value(row, table), "repeats": row.counts.valid, "asked": row.counts.asked, "made": row.counts.made,
        "state": condition_state(row, results.status), "doubt": ", ".join(row.result.doubts),
        "reason": row.result.reason or ("" if row.result.ok else row.result.status.value),
        "reference": row.reference, "replicate": row.info.replicate,
    }  # fmt: skip


def _combined(row: ConditionRow, table: Table[ConditionRow]) -> dict[str, Any]:
    return {"conditions": [m.info.condition for m in row.row.replicates], **_value(row, table)}


def condition_state(row: ConditionRow, status: RunStatus) -> str:
    """Return the state of a condition's cell: planned, running, done, doubtful, refused, excluded or missing.

    refused: it was tried and has no trustworthy value; missing: the run ended before it.
    """
    assert row.measured is not None
    result, measured = row.result, row.measured
    if result.ok:
        return "doubtful" if result.doubts else "done"
    if measured.repeats and len(measured.by_hand) == len(measured.repeats):
        return "excluded"
    if result.status is not ConditionStatus.PENDING:
        return "refused"
    if status is not RunStatus.RUNNING:
        return "missing"
    return "running" if isfinite(measured.condition.started_s) else "planned"


def _repeat(one: CommittedRepeat, table: Table[CommittedRepeat]) -> dict[str, Any]:
    word = one.measured.left_out_by(one.repeat)
    by_hand = {"utc": word.utc, "by": word.operator, "reason": word.reason} if word is not None else None
    return {
        "n": one.repeat.repeat, "attempt": one.repeat.attempt, "mu": table["mu_as_measured"].as_json(one),
        "mu_text": table["mu_as_measured"].text(one), "u": table["u_window"].as_json(one),
        "state": "excluded" if word is not None else "left out" if one.exclusion else "valid",
        "reason": one.exclusion or one.result.reason, "flags": table["flags"].as_json(one),
        "from_s": finite(one.result.started_s), "to_s": finite(one.result.ended_s), "by_hand": by_hand,
    }  # fmt: skip


def _mark(event: StoredEvent) -> dict[str, Any]:
    severity = event.severity if event.severity in SEVERE else "info"
    return {"t_s": event.t_s, "kind": event.kind, "text": event.text, "severity": severity, "utc": event.utc}


def _regions(
    reader: RunReader, results: RunResults, events: Iterable[StoredEvent], length_s: float
) -> Iterator[dict[str, Any]]:
    """Yield the stretches of rig time with a name: repeats, holds, trips, and what was mounted."""
    for repeat in reader.repeats(attempts=True):
        end_s = repeat.result.ended_s
        text = f"condition {repeat.condition}, repeat {repeat.repeat}: {repeat.result.status.value}"
        yield _region(repeat.begun_s, end_s if isfinite(end_s) else length_s, "repeat", text)
    yield from _holds(events, length_s)
    for trip in reader.trips():
        end_s = trip.acknowledged_s if isfinite(trip.acknowledged_s) else length_s
        yield _region(trip.t_s, end_s, "alarm", trip.text or trip.interlock)
    mounted = sorted(results.pieces, key=lambda piece: piece.installed_s)
    for piece, following in zip_longest(mounted, mounted[1:]):
        end_s = following.installed_s if following is not None else length_s
        yield _region(piece.installed_s, end_s, "wheel", f"{results.worn} {piece.piece} ({piece.compound})")


def _region(from_s: float, to_s: float, kind: str, text: str) -> dict[str, Any]:
    first = from_s if isfinite(from_s) else 0.0
    return {"from_s": first, "to_s": max(first, to_s), "kind": kind, "text": text}


def _holds(events: Iterable[StoredEvent], length_s: float) -> Iterator[dict[str, Any]]:
    """Yield the holds, by the changes of mode in the journal."""
    began: StoredEvent | None = None
    for event in events:
        if event.kind != "mode":
            continue
        if began is not None and event.text.startswith("hold ->"):
            yield _region(began.t_s, event.t_s, "hold", began.text)
            began = None
        elif "-> hold" in event.text:
            began = event
    if began is not None:
        yield _region(began.t_s, length_s, "hold", began.text)
