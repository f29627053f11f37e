"""A report as data, before rendering: sections of paragraphs, facts, lists, tables and pictures.

Texts are unescaped, as people and devices wrote them; ``tester.report.page`` escapes them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from tester.analysis.pressure import LOAD
from tester.base.axes import Axis
from tester.base.words import NONE
from tester.report.chart import SecondScale
from tester.results.columns import R, Table, unit_of

Tone = Literal["", "good", "care", "bad", "small"]
"""Tone of a paragraph or a row: plain, good, with care, bad, or a remark in small print."""


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Text, and its tone."""

    text: str
    tone: Tone = ""
    kind: Literal["paragraph"] = "paragraph"


@dataclass(frozen=True, slots=True)
class Listing:
    """Lines of text."""

    lines: Sequence[str]
    tone: Tone = ""
    kind: Literal["listing"] = "listing"


@dataclass(frozen=True, slots=True)
class FactSheet:
    """Names with a fact for each."""

    facts: Sequence[tuple[str, str]]
    kind: Literal["facts"] = "facts"


@dataclass(frozen=True, slots=True)
class ReportHead:
    """Head of a column; ``number``: its cells are aligned right."""

    text: str
    number: bool = True


@dataclass(frozen=True, slots=True)
class ReportRow:
    """Cells of a row; the first names it."""

    cells: Sequence[str]
    tone: Tone = ""
    key: str = ""
    """Anchor for other places of the page; "" for none."""


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table."""

    caption: str
    heads: Sequence[ReportHead]
    rows: Sequence[ReportRow]
    note: str = ""
    cards: bool = False
    """Whether its rows become cards, with the heads beside the cells, on a screen as narrow as a phone's: no column is
    then out of sight.
    """
    kind: Literal["table"] = "table"


@dataclass(frozen=True, slots=True)
class Columns:
    """Narrow tables, in two columns where there is room."""

    tables: Sequence[ReportTable]
    kind: Literal["columns"] = "columns"


@dataclass(frozen=True, slots=True)
class Picture:
    """A drawn figure, which includes its title; ``svg`` is markup that this program made.

    ``wide``: it takes the whole width of a page, where two others stand side by side.
    """

    svg: str
    wide: bool = False
    kind: Literal["picture"] = "picture"


Part: TypeAlias = Paragraph | Listing | FactSheet | ReportTable | Columns | Picture


@dataclass(frozen=True, slots=True)
class ReportSection:
    """A section; ``key`` is unique in the report."""

    key: str
    title: str
    parts: Sequence[Part]

    @property
    def drawn(self) -> bool:
        """Return whether it has pictures, which share the width of the page."""
        return any(isinstance(part, Picture) for part in self.parts)

    @property
    def urgent(self) -> bool:
        """Return whether one of its sentences reports something bad: such a section is never folded."""
        return any(isinstance(part, Paragraph | Listing) and part.tone == "bad" for part in self.parts)


@dataclass(frozen=True, slots=True)
class Chapter:
    """A chapter on one run, or on several together."""

    key: str
    title: str
    sections: Sequence[ReportSection]
    appendix: Sequence[ReportSection] = ()
    """Sections that a screen folds; paper shows them in full."""


@dataclass(frozen=True, slots=True)
class Report:
    """A whole report: the cover for a customer, then chapters."""

    title: str
    lead: str
    cover: Sequence[Part]
    chapters: Sequence[Chapter]
    made: str
    """Version of the program, and names of the records."""


def heads(*texts: str, text: Sequence[int] = (0,)) -> tuple[ReportHead, ...]:
    """Return heads of columns; those at the places ``text`` hold words, the others numbers."""
    return tuple(ReportHead(title, number=i not in text) for i, title in enumerate(texts))


def listed(title: str, lines: Iterable[str], tone: Tone = "") -> list[Part]:
    """Return a paragraph and the lines below it; nothing without lines."""
    found = [*lines]
    return [Paragraph(title), Listing(found, tone)] if found else []


def rendered(
    table: Table[R], caption: str, note: str = "", *, tone: Callable[[R], Tone] | None = None, cards: bool = False
) -> ReportTable:
    """Return a table of results in a report's form; ``tone`` gives the tone of a row."""
    titles = tuple(ReportHead(column.head, number=column.numeric) for column in table.columns)
    rows = [
        ReportRow(cells, tone(row) if tone is not None else "")
        for row, cells in zip(table.rows, table.texts(), strict=True)
    ]
    return ReportTable(caption, titles, rows, note, cards)


def day(utc: str) -> str:
    """Return the day and the minute of a wall-clock text, in UTC."""
    return f"{utc[:10]} {utc[11:16]} UTC" if len(utc) > 15 and utc[10:11] == "T" else utc or NONE


def file_name(source: str) -> str:
    """Return the name of a source without its folders, which are private to its maker."""
    return re.split(r"[/\\]", source.rstrip("/\\"))[-1]


def name_of(axis: Axis) -> str:
    """Return the name of an axis."""
    return axis.name.replace("_", " ")


def second_scale(axis: Axis, kpa_per_n: float | None) -> SecondScale | None:
    """Return the scale of the nominal pressure beside an axis of loads; None for any other, and without an area."""
    return SecondScale("pressure (kPa)", kpa_per_n) if kpa_per_n is not None and axis.name == LOAD else None


def labelled(axis: Axis) -> str:
    """Return an axis with its unit in brackets."""
    return f"{name_of(axis)} ({unit_of(axis)})" if axis.unit else name_of(axis)
