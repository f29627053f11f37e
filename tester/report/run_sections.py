"""Sections on the rest of the record: recipe and rig, zeros, calibration, trips, assumptions, provenance."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import cast

from tester.base.source import InvalidSource, load_tree
from tester.base.words import NONE, counted, decimal, duration
from tester.report.charts import control_chart
from tester.report.layout import (
    FactSheet,
    Listing,
    Paragraph,
    Part,
    Picture,
    ReportRow,
    ReportSection,
    ReportTable,
    Tone,
    day,
    file_name,
    heads,
    listed,
    rendered,
)
from tester.report.page import inline_svg
from tester.report.record_section import ALARMING, RunRecord
from tester.results.columns import Output
from tester.results.measured_tables import pieces_table
from tester.results.repeated_tables import ReferenceRow, references_table
from tester.results.run_results import RunResults

EVENTS_AT_MOST = 200
"""Most alarms of a run in the list; of more, the first."""


def ran_section(record: RunRecord, key: str) -> ReportSection:
    """Return recipe, rig, material, operator and version of a run."""
    results = record.results
    run, info = results.run, results.run.info
    ended = f", ended {day(run.ended_utc)}" if run.ended_utc else ""
    simulated = f"simulated (seed {info.seed})" if info.simulated else "a machine"
    revision = f", revision {info.git_revision}" if info.git_revision else ""
    facts = [
        ("run", record.name),
        ("status", f"{results.status.value}{f': {run.reason}' if run.reason else ''}"),
        ("recipe", f"{info.recipe_name}{_from(info.recipe_source)}"),
        ("rig", f"{record.machine.title or info.kind}{_from(info.rig_source)}, {simulated}"),
        ("operator", info.operator or "not named"),
        ("time", f"started {day(info.started_utc)}{ended}, rig time {duration(run.rig_seconds)}"),
        ("software", f"friction-tester {info.software_version}{revision}"),
        *((name.replace("_", " "), value) for name, value in info.metadata.items()),
    ]
    parts: list[Part] = [FactSheet(facts)]
    if info.risk:
        parts.insert(0, Paragraph(f"Risk accepted: {info.risk}", "bad"))
    if results.pieces:
        parts.append(rendered(pieces_table(results).view(Output.REPORT), f"What was mounted ({results.worn})"))
    answers = (
        f"{duration(prompt.asked_s)}: {prompt.text}: {prompt.answer} ({prompt.answered_by or 'unnamed'})"
        for prompt in record.prompts
        if prompt.answer
    )
    parts += listed("Questions to people, and their answers:", answers)
    return ReportSection(key, "What ran on what", parts)


def _from(source: str) -> str:
    return f" (from {file_name(source)})" if source else ""


def tare_section(record: RunRecord, key: str) -> ReportSection:
    """Return the history of the load cell's zeros."""
    if not record.tares:
        return ReportSection(key, "Zeros of the load cell", [Paragraph("No zero of a cell is on record.")])
    names = list(dict.fromkeys(name for tare in record.tares for name in tare.zeros))
    rows: list[ReportRow] = []
    for kind in dict.fromkeys(tare.kind for tare in record.tares):
        of_kind = [tare for tare in record.tares if tare.kind == kind]
        for name in names:
            values = [value for tare in of_kind if (value := tare.zeros.get(name)) is not None and value == value]
            if values:
                steps = [abs(b - a) for a, b in pairwise(values)]
                cells = (len(values), values[0], values[-1], min(values), max(values), max(steps, default=0.0))
                rows.append(ReportRow((kind, name, str(cells[0]), *(decimal(value, 3) for value in cells[1:]))))
    titles = heads("kind", "channel", "zeros", "first", "last", "least", "most", "largest step", text=(0, 1))
    first, last = record.tares[0], record.tares[-1]
    when = f"{counted(len(record.tares), 'zero')} from {duration(first.t_s)} to {duration(last.t_s)} of rig time"
    note = f"{when}, in the unit that the channel's name ends with"
    table = ReportTable("Zeros (tares) by channel", titles, rows, note)
    return ReportSection(key, "Zeros of the load cell", [table])


def calibration_section(record: RunRecord, key: str) -> ReportSection:
    """Return the calibration in use."""
    info = record.results.run.info
    if not info.calibration:
        missing = "No calibration is on record" + (": a simulated rig has none." if info.simulated else ".")
        return ReportSection(key, "Calibration", [Paragraph(missing, "" if info.simulated else "care")])
    rows = [
        ReportRow((figure.device, figure.quantity, figure.value, figure.unit or NONE)) for figure in info.calibration
    ]
    titles = heads("device", "quantity", "value", "unit", text=(0, 1, 3))
    return ReportSection(key, "Calibration", [ReportTable("Calibration in use at the end", titles, rows)])


def trips_section(record: RunRecord, key: str) -> ReportSection:
    """Return trips, alarms and the number of warnings by kind."""
    parts: list[Part] = []
    if record.trips:
        rows = [
            ReportRow((duration(trip.t_s), day(trip.utc), trip.interlock, trip.text, trip.compared or NONE,
                       trip.acknowledged), "bad")
            for trip in record.trips
        ]  # fmt: skip
        titles = heads("rig time", "time", "interlock", "text", "value and limit", "acknowledged", text=range(6))
        parts.append(Paragraph(f"{counted(len(record.trips), 'trip')} during the run.", "bad"))
        parts.append(ReportTable("Trips", titles, rows))
    else:
        parts.append(Paragraph("No interlock tripped.", "good"))
    alarms = [event for event in record.events if event.severity in ALARMING]
    if alarms:
        rows = [
            ReportRow((duration(alarm.t_s), day(alarm.utc), alarm.kind, alarm.severity, alarm.text))
            for alarm in alarms[:EVENTS_AT_MOST]
        ]
        titles = heads("rig time", "time", "kind", "severity", "text", text=range(5))
        note = f"and {len(alarms) - len(rows)} more" if len(alarms) > len(rows) else ""
        parts.append(ReportTable("Alarms", titles, rows, note))
    else:
        parts.append(Paragraph("No alarm was raised.", "good"))
    warned = Counter(event.kind for event in record.events if event.severity not in ALARMING)
    if warned:
        by_kind = ", ".join(f"{kind} {n}" for kind, n in sorted(warned.items()))
        parts.append(Paragraph(f"Warnings by kind: {by_kind}."))
    if record.results.run.overruns:
        parts.append(Paragraph(f"{record.results.run.overruns} samples were dropped while recording.", "care"))
    return ReportSection(key, "Alarms and trips", parts)


def control_section(record: RunRecord, key: str) -> ReportSection:
    """Return the result of the reference conditions, with their control chart, where there were any."""
    title, watch = "Control chart", record.results.watch
    if watch is None or not watch.charts:
        return ReportSection(key, title, [Paragraph("No reference condition was measured.")])
    table = references_table(record.results)
    valued = [row for row in table.rows if row.within is not None]
    outside = sum(not row.within for row in valued)
    return ReportSection(
        key,
        title,
        [
            Paragraph(f"{counted(outside, 'value')} of {len(valued)} not in control.", "bad")
            if outside
            else Paragraph(f"All {len(valued)} values are in control.", "good"),
            *(Paragraph(f"{line}.") for line in watch.lines(record.results.worn)),
            Picture(inline_svg(control_chart(watch.charts), key), wide=True),
            rendered(table.view(Output.REPORT), "Reference condition", tone=_tone),
        ],
    )


def _tone(reference_row: ReferenceRow) -> Tone:
    return "bad" if reference_row.within is False else ""


def assumption_section(record: RunRecord, key: str) -> ReportSection:
    """Return the assumptions that entered these results."""
    results = record.results
    terms = [ReportRow(cells) for cells in assumed_terms(results)]
    keys = assumed_keys(record.machine.commented, record.machine.packaged, results.run.info.rig_text)
    parts: list[Part] = [
        Paragraph(
            "[A] marks an engineering assumption: plausible, and not measured on this machine. Those of the program "
            "itself are listed by `python docs/assumptions.py` in its source."
        )
    ]
    if terms:
        parts.append(ReportTable("In the uncertainty", heads("term", "limit", "source", text=(0, 1, 2)), terms))
    if keys:
        rows = [ReportRow((key_.key, key_.value, key_.remark)) for key_ in keys]
        titles = heads("key", "value", "remark in the file", text=(0, 1, 2))
        note = "keys that are as the packaged rig file has them; a value of the laboratory's own is not listed"
        parts.append(ReportTable("In the rig file", titles, rows, note))
    if not terms and not keys:
        parts.append(Paragraph("None is known to have entered."))
    return ReportSection(key, "Assumptions", parts)


def provenance_section(record: RunRecord, key: str) -> ReportSection:
    """Return versions, hashes, the record's head, and whether the run is unchanged."""
    run, verification = record.results.run, record.verification
    info = run.info
    samples = f"{verification.samples} samples in {verification.blocks} blocks read"
    read = f"{samples}, {verification.coefficients} coefficients recomputed"
    parts: list[Part] = [
        Paragraph(f"Verified as it was left: {read}; every hash, table and coefficient agrees.", "good")
        if not verification.problems
        else Paragraph(f"Not as it was left: {counted(len(verification.problems), 'finding')}.", "bad"),
        *([Listing(verification.problems, "bad")] if verification.problems else []),
        FactSheet([(name, value or NONE) for name, value in _hashes(record)]),
    ]
    rows = [ReportRow((name, sha)) for name, sha in sorted(record.files.items())]
    if rows:
        parts.append(
            ReportTable("Files of the run's folder, by its manifest", heads("file", "SHA-256", text=(0, 1)), rows)
        )
    versions = ", ".join(f"{name} {version}" for name, version in info.versions.items())
    parts.append(Paragraph(f"Versions: {versions or NONE}.", "small"))
    parts += listed("The run was resumed, or changed:", _resumed(record))
    return ReportSection(key, "Where it is from", parts)


def _hashes(record: RunRecord) -> Iterator[tuple[str, str]]:
    run = record.results.run
    yield "head of the record", record.verification.head
    yield "SHA-256 of the recipe", run.recipe_sha256
    yield "SHA-256 of the rig file", run.rig_sha256
    yield "SHA-256 of the calibration", run.calibration_sha256
    yield "software", f"friction-tester {run.info.software_version}"
    yield "revision", run.info.git_revision


def _resumed(record: RunRecord) -> Iterator[str]:
    for session in record.sessions[1:]:
        version = session.software_version or NONE
        yield f"{duration(session.origin_s)} of rig time, {day(session.started_utc)}, version {version}"
    for change in record.changes:
        yield f"{change.subject} changed before stretch {change.session}: {change.reason}"


MARK = "[A]"


@dataclass(frozen=True, slots=True)
class AssumedKey:
    """A key of a rig file whose packaged value is an assumption, and its remark in the file."""

    key: str
    value: str
    remark: str


def assumed_terms(results: RunResults) -> Iterator[tuple[str, str, str]]:
    """Yield name, bound and source of the terms of the budget that rest on an assumption."""
    for term in results.run.info.terms:
        if MARK in term.source:
            unit = "" if term.unit in ("", "1") else f"\u00a0{term.unit}"
            yield term.name, f"{term.bound:g}{unit}, {term.distribution}", term.source


def assumed_keys(commented: str, packaged: str, stored: str) -> list[AssumedKey]:
    """Return the keys that a packaged rig file marks and that keep their packaged value in a run's rig.

    ``commented`` is the packaged file with its remarks, ``packaged`` the same as a run stores it, ``stored`` the run's
    own text. A key with another value is the laboratory's own number, and is left out. Empty where one of the texts is
    unreadable.
    """
    try:
        before, now = (_flat(load_tree(text, "rig.yaml").data) for text in (packaged, stored))
    except InvalidSource:
        return []
    return [
        AssumedKey(key, now[key], remark)
        for key, remark in _marked(commented)
        if key in before and now.get(key) == before[key]
    ]


def _flat(tree: object, place: str = "") -> dict[str, str]:
    """Return the values of a tree by their keys, as ``limits.load``."""
    if isinstance(tree, Mapping):
        leaves: dict[str, str] = {}
        for key, value in cast("Mapping[object, object]", tree).items():
            leaves |= _flat(value, f"{place}.{key}" if place else str(key))
        return leaves
    return {place: str(tree)}


def _marked(text: str) -> Iterator[tuple[str, str]]:
    """Yield key and remark of every line of a rig file whose comment has the mark."""
    path: list[tuple[int, str]] = []
    for line in text.splitlines():
        key, colon, rest = line.partition(":")
        name = key.strip()
        if not colon or not name or name.startswith(("#", "-")):
            continue
        depth = len(key) - len(key.lstrip())
        path = [entry for entry in path if entry[0] < depth] + [(depth, name)]
        _, hash_mark, remark = rest.partition("#")
        if hash_mark and MARK in remark:
            yield ".".join(entry for _, entry in path), remark.strip()
