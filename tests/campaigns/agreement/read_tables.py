"""CSV tables, exported and kept in a run's folder, and the tables of a sweep."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from io import StringIO
from pathlib import Path

from tests.campaigns.agreement.facts import Facts, Subject
from tests.campaigns.agreement.names import MARK, quantity_of
from tests.campaigns.agreement.record import Record, plain_heading
from tests.campaigns.agreement.table import TableReader

SEVEN = 7
"""Significant digits of a number in a table, trailing zeros left out."""
_PREFIX = {"reference": "reference "}
"""Tables whose columns do not describe the condition as a whole."""
_OF_CONDITIONS = ("conditions", "reference")
_PIECES = ("wheel", "pieces")
_APPENDIX = "appendix"


def rows_of(text: str) -> tuple[list[str], list[list[str]]]:
    """Return the headings and the rows of a CSV text."""
    lines = list(csv.reader(StringIO(text.removeprefix("\ufeff"))))
    return lines[0], lines[1:]


def sheets_of(path: Path) -> dict[str, str]:
    """Return the sheets of a workbook as CSV texts, by name."""
    from openpyxl import load_workbook

    found: dict[str, str] = {}
    for sheet in load_workbook(path, read_only=True).worksheets:
        written = StringIO()
        csv.writer(written, lineterminator="\n").writerows(sheet.iter_rows(values_only=True))
        found[sheet.title] = written.getvalue()
    return found


def read_table(record: Record, worn: str, name: str, text: str, output: str) -> Facts:
    """Return the facts of a table of a format's name."""
    facts = Facts(output)
    headings, rows = rows_of(text)
    if name == "budget":
        _terms(facts, record, worn, headings, rows)
    elif name in _PIECES:
        _pieces(facts, record, worn, headings, rows)
    elif name == "directions":
        _directions(facts, record, worn, headings, rows)
    elif name == "repeats":
        TableReader(facts, record, worn, SEVEN, "repeat ").read(headings, rows)
    elif name in _OF_CONDITIONS:
        _conditions(TableReader(facts, record, worn, SEVEN, _PREFIX.get(name, "")), headings, rows)
    elif name == _APPENDIX:
        TableReader(facts, record, worn).read(headings, rows)
        # The paper's table has bare numbers: a missing mark means nothing.
        facts.collected[:] = [fact for fact in facts.collected if fact.quantity != MARK]
    return facts


def _conditions(reader: TableReader, headings: list[str], rows: Iterable[list[str]]) -> None:
    combined = TableReader(reader.facts, reader.record, reader.worn, SEVEN)
    for cells in rows:
        by_heading = dict(zip(map(plain_heading, headings), cells, strict=True))
        if by_heading.get("level") == "combined":
            combined.used |= {row for row, found in reader.record.rows.items() if len(found) == 1}
            combined.read(headings, [cells])
        else:
            reader.read(headings, [cells])


def _terms(facts: Facts, record: Record, worn: str, headings: list[str], rows: Iterable[list[str]]) -> None:
    reader = TableReader(Facts(facts.output), record, "", SEVEN)
    reader.used |= {row for row, found in record.rows.items() if len(found) == 1}
    at: tuple[Subject, str] | None = None
    for cells in rows:
        by_heading = dict(zip(map(plain_heading, headings), cells, strict=True))
        if by_heading["level"] == "condition":
            subject: Subject | None = record.of_condition(int(by_heading["condition"]))
        else:
            key = ",".join(cells[: headings.index("term")])
            if at is None or at[1] != key:
                subject = reader.by_setpoint(by_heading, headings)
                at = (subject, key) if subject is not None else None
            else:
                subject = at[0]
        if subject is None:
            facts.strange.append(f"no condition is like this row: {' | '.join(cells)}")
            continue
        term = f"{by_heading['term']}: "
        begin = headings.index("term") + 1
        for heading, cell in zip(headings[begin:], cells[begin:], strict=True):
            if plain_heading(heading) not in ("source", "distribution", "unit", "accepted risk"):
                facts.number(subject, term + quantity_of(heading, worn), cell, SEVEN)


def _pieces(facts: Facts, record: Record, worn: str, headings: list[str], rows: Iterable[list[str]]) -> None:
    for cells in rows:
        subject: Subject = ("piece", record.name, int(cells[0]))
        for heading, cell in zip(headings[1:], cells[1:], strict=True):
            if plain_heading(heading) not in ("specimen", "replicate", "compound", "accepted risk"):
                facts.number(subject, quantity_of(heading, worn), cell, SEVEN)


def _directions(facts: Facts, record: Record, worn: str, headings: list[str], rows: Iterable[list[str]]) -> None:
    reader = TableReader(facts, record, worn, SEVEN, "")
    for cells in rows:
        by_heading = dict(zip(map(plain_heading, headings), cells, strict=True))
        if by_heading["level"] == "run":
            for heading in ("pairs", "misalignment deg", "misalignment u expanded deg"):
                facts.number(record.run, heading, by_heading[heading], SEVEN)
        else:
            reader.read(headings, [cells])


def sweep_facts(record: Record, worn: str, text: str, output: str, seed: int) -> Facts:
    """Return the facts of one seed's rows in the conditions of a sweep, about a run of that recipe and seed."""
    facts = Facts(output)
    headings, rows = rows_of(text)
    at = headings.index("seed")
    own = [cells for cells in rows if cells[at] == str(seed)]
    TableReader(facts, record, worn, SEVEN).read(headings, own)
    return facts
