"""A table of any output as facts: rows found by their numbers or setpoints, columns by their headings."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from tests.campaigns.agreement.facts import Facts, Subject, is_dash, marks_of
from tests.campaigns.agreement.names import ASKED, COUNTS, MARK, MU, STATUS, TEXTS, WORDS, quantity_of
from tests.campaigns.agreement.record import Record, plain_heading

_PAIR = re.compile(r"(\d+)(?: of |/)(\d+)")
IDENTITY = frozenset(
    {"condition", "no.", "repeat", "attempt", "compound", "formula", "specimen", "replicate", "grid", "note", "level",
     "row", "wheel", "piece", "record head", "run", "seed", "accepted risk"}
)  # fmt: skip
"""Headings that identify the row: no statement about a result."""
STATUSES = (
    "ok", "not measured", "insufficient", "temperature cannot be held", "not reached", "skipped",
)  # fmt: skip


@dataclass
class TableReader:
    """Reads rows into ``facts``. ``significant``: digits of numbers (``facts.printed``)."""

    facts: Facts
    record: Record
    worn: str
    significant: int = 0
    prefix: str = ""
    """Prefix of quantities that do not describe a condition as a whole."""
    used: set[int] = field(default_factory=set[int])

    def read(self, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Read a table whose rows are conditions, rows of the recipe, or repeats."""
        for cells in rows:
            if len(cells) != len(headings):
                self.facts.strange.append(f"{len(cells)} cells below {len(headings)} headings: {' | '.join(cells)}")
                continue
            by_heading = dict(zip((plain_heading(heading) for heading in headings), cells, strict=True))
            subject = self._subject(by_heading, headings)
            if subject is None:
                self.facts.strange.append(f"no condition is like this row: {' | '.join(cells)}")
                continue
            for heading, cell in zip(headings, cells, strict=True):
                self.cell(subject, heading, cell)

    def cell(self, subject: Subject, heading: str, cell: str) -> None:
        """Read a cell into facts."""
        if plain_heading(heading) in IDENTITY or self.record.axis_of(heading) is not None:
            return
        quantity = self.prefix + quantity_of(heading, self.worn)
        pair = _PAIR.fullmatch(cell.strip())
        if quantity.removeprefix("repeat ") in WORDS:
            self._flags(subject, quantity, cell)
        elif quantity.removeprefix("repeat ") in TEXTS:
            self.facts.add(subject, quantity, cell)
        elif pair is not None:
            self.pair(subject, quantity, pair.group(1), pair.group(2))
        elif quantity in COUNTS and cell.strip().isdigit():
            self.facts.count(subject, quantity, cell)
        else:
            self.facts.number(subject, quantity, cell, self.significant)
            if quantity == MU and not is_dash(cell) and self.significant == 0:
                self.facts.add(subject, MARK, marks_of(cell))

    def pair(self, subject: Subject, quantity: str, first: str, second: str) -> None:
        """Read "3 of 5": valid repeats of those asked for or made, values of conditions."""
        names = {"values": ("values", "conditions")}.get(quantity, ("valid", ASKED))
        for name, count in zip(names, (first, second), strict=True):
            self.facts.count(subject, name, count)

    def _flags(self, subject: Subject, quantity: str, cell: str) -> None:
        """Read flags, optionally after a status."""
        words = [] if is_dash(cell) else [word.strip() for word in re.split("[,;]", cell)]
        for word in words:
            if word in STATUSES and word != "ok":
                self.facts.add(subject, STATUS, word)
        self.facts.words(subject, quantity, (word for word in words if word not in STATUSES))

    def _subject(self, cells: Mapping[str, str], headings: Sequence[str]) -> Subject | None:
        number = cells.get("no.", cells.get("condition", ""))
        repeat = cells.get("repeat", "")
        if "/" in repeat:
            number, repeat = repeat.split("/")
        if repeat.isdigit() and number.isdigit():
            return self.record.of_repeat(int(number), int(repeat))
        if number.isdigit():
            return self.record.of_condition(int(number))
        if cells.get("row", "").isdigit():
            return self.record.of_row(int(cells["row"]))
        if words := cells.get("condition"):
            return self.next_of(self.record.in_words(words))
        return self.by_setpoint(cells, headings)

    def by_setpoint(self, cells: Mapping[str, str], headings: Sequence[str]) -> Subject | None:
        """Return the next row of the recipe that has the setpoint of a row's cells."""
        compound = cells.get("compound", cells.get("formula", ""))
        setpoint = {
            axis.name: cells[plain_heading(heading)]
            for heading in headings
            if (axis := self.record.axis_of(heading)) is not None
        }
        return self.next_of(self.record.matching(compound, setpoint))

    def next_of(self, rows: Sequence[int]) -> Subject | None:
        """Return the first of some rows that no line has used so far."""
        for row in rows:
            if row not in self.used:
                self.used.add(row)
                return self.record.of_row(row)
        return None


def columns_of(line: str) -> Iterator[tuple[int, int, str]]:
    """Yield the texts of a line that two or more spaces separate, each with its begin and end."""
    for match in re.finditer(r"\S+(?: \S+)*", line):
        yield match.start(), match.end(), match.group()


def headings_of(first: str, second: str) -> list[str]:
    """Return the headings of a table of right-aligned columns whose names take two lines."""
    upper, lower = [*columns_of(first)], [*columns_of(second)]
    edges = sorted({end for _, end, _ in upper} | {end for _, end, _ in lower})
    merged: list[int] = []
    for edge in edges:
        if merged and edge - merged[-1] <= 1:  # room for a mark beside a coefficient
            merged[-1] = edge
        else:
            merged.append(edge)
    found: list[str] = []
    for edge in merged:
        parts = [text for line in (upper, lower) for _, end, text in line if edge - 1 <= end <= edge]
        found.append(" ".join(parts))
    return found


