"""Items of papers: a figure, table, equation or statement, each compared with this program when it is asked for.

A kind supplies the papers behind its machine or its laws (``Kind.papers``). The page of all papers is a table of the
items with their verdicts, computed at the time of writing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Final, NamedTuple

ROUNDING: Final = 1e-9


class PaperVerdict(StrEnum):
    """Result of comparing an item of a paper with data, formulas or laws."""

    REPRODUCED = "reproduced"
    REFUTED = "refuted"
    NOT_ATTEMPTED = "not attempted"


@dataclass(frozen=True, slots=True)
class PaperFinding:
    """A verdict, and the error or the reason in words; ``u``: U of the error's numbers in words, "" for none."""

    verdict: PaperVerdict
    error: str
    u: str = ""

    @property
    def words(self) -> str:
        """Return the error with its U."""
        return f"{self.error}{self._u}"

    @property
    def short(self) -> str:
        """Return the first sentence of the error with its U."""
        return f"{self.error.partition('. ')[0]}{self._u}"

    @property
    def _u(self) -> str:
        return f" (U {self.u})" if self.u else ""


@dataclass(frozen=True, slots=True)
class PaperItem:
    """An item of a paper.

    ``where``: its place in the paper. ``states``: its content. ``command``: a command that shows the same in full, ""
    where only the list does. ``work_out`` returns the verdict from numbers computed by the call.
    """

    where: str
    states: str
    command: str
    work_out: Callable[[], PaperFinding]


@dataclass(frozen=True, slots=True)
class PaperRow:
    """A result of a paper, of one item or several: a row of the first table.

    Each entry of ``places`` selects items: "place" all of a place in the paper, "place: beginning" those of it whose
    statement begins so.
    """

    result: str
    places: tuple[str, ...]

    def has(self, item: PaperItem) -> bool:
        """Return whether an item belongs to this row."""
        return any(
            item.where == where and item.states.startswith(begins)
            for where, _, begins in (place.partition(": ") for place in self.places)
        )


@dataclass(frozen=True, slots=True)
class Paper:
    """A paper: its short name, its citation, its items in the order of its pages, and the rows of the first table."""

    name: str
    citation: str
    items: tuple[PaperItem, ...]
    rows: tuple[PaperRow, ...] = ()


def slight(off: float) -> str:
    """Return a small difference in words: below 1e-9 it is due to rounding, which differs from computer to computer."""
    return f"{off:.0e}" if abs(off) >= ROUNDING else f"less than {ROUNDING:.0e}"


def judged(holds: bool, error: str, u: str = "") -> PaperFinding:
    """Return the finding "reproduced", or "refuted" where the item does not hold and the U of its numbers is known.

    A refutation without U is none: the difference may be the numbers' own.
    """
    if holds:
        return PaperFinding(PaperVerdict.REPRODUCED, error, u)
    if not u:
        return unjudged(f"{error}; without U that refutes nothing")
    return PaperFinding(PaperVerdict.REFUTED, error, u)


def unjudged(reason: str) -> PaperFinding:
    """Return the finding of an item that cannot be judged, with the numbers or the reason."""
    return PaperFinding(PaperVerdict.NOT_ATTEMPTED, reason)


def not_attempted(where: str, states: str, reason: str) -> PaperItem:
    """Return an item that is not attempted, with the reason."""
    return PaperItem(where, states, "", lambda: unjudged(reason))


HEAD = """# Results of three papers

`tester paper --all` prints this page and then every item of the papers, and computes each number while it runs. [The
paper, item by item](paper.md) explains the first paper, [errata](explanation/errata-of-the-two-papers.md) the others.

"Reproduced": the same comes out here, within the given error. "Refuted": the paper's own data or formulas give
something else. "Not attempted": at least one item is a drawing without numbers, or needs what is not printed or built.
U (k = 2) is that of the last printed digit: the first paper prints no repeats, so the true U is larger. Rows of its
tables that cannot be read, contradict others or were inferred are no evidence. A law that agrees with figures which it
was made from shows that the formulas are right, not that rubber follows them. The second and third paper print no
measurement as a number; compounds and surfaces are this program's own.
"""


class JudgedItem(NamedTuple):
    """An item with its verdict."""

    item: PaperItem
    finding: PaperFinding


def judged_items(paper: Paper) -> list[JudgedItem]:
    """Return the items of a paper with their verdicts, computed by this call. Raises MissingExtraError."""
    return [JudgedItem(entry, entry.work_out()) for entry in paper.items]


class JudgedRow(NamedTuple):
    """A row of the first table with the verdicts of its items."""

    row: PaperRow
    items: tuple[JudgedItem, ...]

    def of(self, verdict: PaperVerdict) -> list[JudgedItem]:
        """Return the items of a verdict."""
        return [entry for entry in self.items if entry.finding.verdict is verdict]

    @property
    def verdict(self) -> PaperVerdict:
        """Return "not attempted" where one item is, else "refuted" where one is, else "reproduced"."""
        for verdict in (PaperVerdict.NOT_ATTEMPTED, PaperVerdict.REFUTED):
            if self.of(verdict):
                return verdict
        return PaperVerdict.REPRODUCED

    @property
    def words(self) -> str:
        """Return the numbers or reasons of the items that decide, and how many others there are.

        Of a reproduced row one item is given: the others say the same of other compounds or figures.
        """
        given = self.of(self.verdict)[: 1 if self.verdict is PaperVerdict.REPRODUCED else None]
        phrase = "; ".join(f"{entry.item.where}: {entry.finding.short}" for entry in given)
        rest = Counter(entry.finding.verdict.value for entry in self.items if entry not in given)
        others = ", ".join(f"{count} {verdict}" for verdict, count in rest.items())
        return f"{phrase}. Else {others}" if others else phrase


Judged = Sequence[tuple[Paper, list[JudgedItem]]]


def judged_papers(papers: Sequence[Paper]) -> Judged:
    """Return papers with the verdicts of their items, computed by this call. Raises MissingExtraError."""
    return [(paper, judged_items(paper)) for paper in papers]


def rows_of(paper: Paper, items: Sequence[JudgedItem]) -> list[JudgedRow]:
    """Return a paper's rows of the first table, from its judged items."""
    return [JudgedRow(row, tuple(entry for entry in items if row.has(entry.item))) for row in paper.rows]


def table_text(result: Judged) -> str:
    """Return the page of results in Markdown: the first table."""
    rows = {paper.name: rows_of(paper, items) for paper, items in result}
    counted = Counter(row.verdict for each in rows.values() for row in each)
    lines = [HEAD, ", ".join(f"{counted[verdict]} {verdict.value}" for verdict in PaperVerdict) + "."]
    for name, each in rows.items():
        lines += ["", f"## {name}", "", "| result | verdict | error or reason |", "|---|---|---|"]
        lines += [_line(row.row.result, row.verdict.value, row.words) for row in each]
    return "\n".join(lines) + "\n"


def items_text(result: Judged) -> str:
    """Return every item in Markdown, by paper."""
    lines = ["# Items of the papers", "", *_summary(result)]
    for paper, items in result:
        lines += ["", f"## Items: {paper.name}", "", paper.citation, ""]
        lines += ["| where | the paper | verdict | error or reason | more |", "|---|---|---|---|---|"]
        lines += [_row(entry) for entry in items]
    return "\n".join(lines) + "\n"


def _summary(result: Judged) -> Iterator[str]:
    yield f"| paper | {' | '.join(PaperVerdict)} |"
    yield "|---|" + "---|" * len(PaperVerdict)
    for paper, items in result:
        counted = Counter(entry.finding.verdict for entry in items)
        yield f"| {paper.name} | {' | '.join(str(counted[verdict]) for verdict in PaperVerdict)} |"


def _row(entry: JudgedItem) -> str:
    command = f"`{entry.item.command}`" if entry.item.command else ""
    return _line(entry.item.where, entry.item.states, entry.finding.verdict.value, entry.finding.words, command)


def _line(*cells: str) -> str:
    return f"| {' | '.join(text.replace('|', chr(92) + '|') for text in cells)} |"
