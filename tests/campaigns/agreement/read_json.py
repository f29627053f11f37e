"""What commands print for programs: `show --json`, `compare --json`, `runs --json`."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from tests.campaigns.agreement.facts import Facts, Subject
from tests.campaigns.agreement.names import (
    CONDITIONS,
    COUNTS,
    MADE,
    MARK,
    MISSING,
    MU,
    RIG_SECONDS,
    STATUS,
    VALUES,
    WITH_CARE,
    WORDS,
    quantity_of,
)
from tests.campaigns.agreement.read_text import pair_of
from tests.campaigns.agreement.record import Record, plain_heading
from tests.campaigns.agreement.table import IDENTITY, TableReader

Json = Mapping[str, Any]


def read_show_json(record: Record, worn: str, text: str, output: str) -> Facts:
    """Return the facts of `tester show --json`."""
    facts = Facts(output)
    shown: Json = json.loads(text)
    facts.add(record.run, STATUS, str(shown["status"]))
    facts.add(record.run, RIG_SECONDS, shown["rig_seconds"])
    for key, quantity in (("conditions", CONDITIONS), ("values", VALUES), ("doubts", WITH_CARE), ("notes", "noted")):
        facts.count(record.run, quantity, shown["tally"][key])
    facts.count(record.run, MISSING, len(shown["missing"]))
    combined = TableReader(facts, record, worn, used={row for row, found in record.rows.items() if len(found) == 1})
    for condition in shown["conditions"]:
        subject = _subject(record, combined, condition)
        if subject is None:
            facts.strange.append(f"no condition is like {condition['compound']} {condition['condition']}")
            continue
        _scalars(facts, record, subject, condition, worn)
        for term in condition["budget"]:
            _term(facts, subject, term, worn)
        for repeat in condition["repeats"] if condition["condition"] is not None else ():
            at = record.of_repeat(condition["condition"], repeat["repeat"])
            _repeat(facts, record, at, repeat, worn)
    for piece in shown.get("wheels", shown.get("pieces", [])):
        at = ("piece", record.name, next(iter(piece.values())))
        for key, value in list(piece.items())[1:]:
            if key not in ("specimen", "replicate", "compound"):
                facts.add(at, quantity_of(key, worn), value)
    return facts


def _subject(record: Record, combined: TableReader, condition: Json) -> Subject | None:
    """Return the subject of a record: a condition by its number, a row of replicates by its setpoint."""
    if condition["condition"] is not None:
        return record.of_condition(condition["condition"])
    cells = {plain_heading(key): str(value) for key, value in condition.items()}
    return combined.by_setpoint(cells, [key for key in cells if record.axis_of(key) is not None])


def _scalars(facts: Facts, record: Record, subject: Subject, values: Json, worn: str) -> None:
    for key, value in values.items():
        quantity = quantity_of(key, worn)
        if quantity in WORDS:
            facts.words(subject, quantity, value)
        elif record.axis_of(key) is None and quantity not in IDENTITY and not isinstance(value, list | dict):
            facts.add(subject, quantity, float(value) if quantity in COUNTS else value)


def _repeat(facts: Facts, record: Record, subject: Subject, values: Json, worn: str) -> None:
    for key, value in values.items():
        quantity = quantity_of(key, worn)
        if quantity in WORDS:
            facts.words(subject, f"repeat {quantity}", value)
        elif record.axis_of(key) is None and quantity not in IDENTITY:
            facts.add(subject, f"repeat {quantity}", float(value) if isinstance(value, bool) else value)


def _term(facts: Facts, subject: Subject, term: Json, worn: str) -> None:
    for key, value in term.items():
        if key not in ("term", "source", "distribution", "unit"):
            facts.add(subject, f"{term['term']}: {quantity_of(key, worn)}", value)


def read_events(record: Record, text: str, output: str) -> Facts:
    """Return the facts of what `tester run --json` writes while it runs: number of finished conditions at every step.

    Only for a run in one part, whose times agree with its record.
    """
    facts = Facts(output)
    for line in text.splitlines():
        event = json.loads(line)
        if event.get("event") == "step" and "over" in event and "part" not in event:
            facts.count(record.run, "conditions of the plan", event["conditions"])
            if record.is_one_part:
                at = ("moment", record.name, f"step {event['step']} at {event['t_s']:.0f} s")
                facts.count(at, "conditions done", event["over"])
    return facts


def times_of(record: Record, text: str) -> Facts:
    """Return the record's facts at the same moments."""
    facts = Facts("record")
    for line in text.splitlines() if record.is_one_part else ():
        event = json.loads(line)
        if event.get("event") == "step" and "over" in event:
            at = ("moment", record.name, f"step {event['step']} at {event['t_s']:.0f} s")
            over = sum(one.ended_s is not None and one.ended_s <= event["t_s"] + 1e-3 for one in record.conditions)
            facts.count(at, "conditions done", over)
    return facts


def read_runs_json(records: Sequence[Record], text: str, output: str) -> Facts:
    """Return the facts of `tester runs --json`."""
    facts = Facts(output)
    known = {record.name: record for record in records}
    for run in json.loads(text):
        if run["run"] not in known:
            facts.strange.append(f"no run is like {run['run']}")
            continue
        subject = known[run["run"]].run
        facts.add(subject, STATUS, run["status"])
        facts.add(subject, RIG_SECONDS, run["rig_seconds"])
        for key, quantity in (("conditions", "conditions"), ("values", VALUES), ("repeats", MADE),
                              ("repeats_planned", "repeats planned")):  # fmt: skip
            facts.count(subject, quantity, run[key])
    return facts


def read_compare_json(records: Sequence[Record], text: str, output: str) -> Facts:
    """Return the facts of `tester compare --json`."""
    facts = Facts(output)
    readers = [TableReader(facts, record, "") for record in records]
    for row in json.loads(text):
        cells = {key: str(value) for key, value in row.items()}
        found = [
            reader.next_of(
                record.matching(row["compound"],
                                {axis.name: cells[heading] for axis in record.axes for heading in cells
                                 if record.axis_of(heading) is axis})
            )
            for reader, record in zip(readers, records, strict=True)
        ]  # fmt: skip
        for side, subject in enumerate(found, start=1):
            if subject is not None:
                facts.add(subject, MU, row[f"mu_{side}"])
                if row[f"mu_{side}"] is not None:
                    facts.add(subject, MARK, row[f"mark_{side}"])
        pair = pair_of(found)
        facts.add(pair, "differs", float(row["differs"]))
        for key in ("difference", "u_difference", "z", "k"):
            facts.add(pair, f"pair {key.removesuffix('_difference')}", row[key])
    return facts
