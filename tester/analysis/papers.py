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
    """A verdict, and the error or the reason in words."""

    verdict: PaperVerdict
    error: str


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
class Paper:
    """A paper: its short name, its citation, and its items in the order of its pages."""

    name: str
    citation: str
    items: tuple[PaperItem, ...]


def slight(off: float) -> str:
    """Return a small difference in words: below 1e-9 it is due to rounding, which differs from computer to computer."""
    return f"{off:.0e}" if abs(off) >= ROUNDING else f"less than {ROUNDING:.0e}"


def judged(holds: bool, error: str) -> PaperFinding:
    """Return the finding "reproduced", or "refuted" where the item does not hold."""
    return PaperFinding(PaperVerdict.REPRODUCED if holds else PaperVerdict.REFUTED, error)


def unjudged(reason: str) -> PaperFinding:
    """Return the finding of an item that cannot be judged, with the numbers or the reason."""
    return PaperFinding(PaperVerdict.NOT_ATTEMPTED, reason)


def not_attempted(where: str, states: str, reason: str) -> PaperItem:
    """Return an item that is not attempted, with the reason."""
    return PaperItem(where, states, "", lambda: unjudged(reason))


HEAD = """# The papers, item by item

Every figure, table, equation and statement of three papers, compared with this program and with the papers' own data.
`tester paper --all` prints this page and computes every number while it runs. The last column names a command that
shows more; RUN is a run of your own. `docs/paper.md` explains what the items of the first paper mean for a user,
`docs/explanation/errata-of-the-two-papers.md` lists the misprints of the other two.

| verdict | means |
|---|---|
| reproduced | the same comes out here, within the error that is given |
| refuted | the paper's own data, or its formulas, give something else; the error is given |
| not attempted | it is a drawing without numbers, or needs what is not printed or not built here; the reason is given |

Rows of the first paper's tables that cannot be read, contradict others or were inferred are evidence for nothing
here. A law that agrees with figures which it was made from shows that the formulas are right, not that rubber follows
them. Of the second and third paper no measurement is printed as a number; compounds and surfaces are this program's own
unless the item states otherwise.
"""


class JudgedItem(NamedTuple):
    """An item with its verdict."""

    item: PaperItem
    finding: PaperFinding


def judged_items(paper: Paper) -> list[JudgedItem]:
    """Return the items of a paper with their verdicts, computed by this call. Raises MissingExtraError."""
    return [JudgedItem(entry, entry.work_out()) for entry in paper.items]


def page_text(papers: Sequence[Paper]) -> str:
    """Return the page in Markdown. Raises MissingExtraError."""
    result = [(paper, judged_items(paper)) for paper in papers]
    lines = [HEAD, *_summary(result)]
    for paper, items in result:
        lines += ["", f"## {paper.name}", "", paper.citation, ""]
        lines += ["| where | the paper | verdict | error or reason | more |", "|---|---|---|---|---|"]
        lines += [_row(entry) for entry in items]
    return "\n".join(lines) + "\n"


def _summary(result: Sequence[tuple[Paper, list[JudgedItem]]]) -> Iterator[str]:
    yield f"| paper | {' | '.join(PaperVerdict)} |"
    yield "|---|" + "---|" * len(PaperVerdict)
    for paper, items in result:
        counted = Counter(entry.finding.verdict for entry in items)
        yield f"| {paper.name} | {' | '.join(str(counted[verdict]) for verdict in PaperVerdict)} |"


def _row(entry: JudgedItem) -> str:
    command = f"`{entry.item.command}`" if entry.item.command else ""
    cells = (entry.item.where, entry.item.states, entry.finding.verdict.value, entry.finding.error, command)
    return f"| {' | '.join(text.replace('|', chr(92) + '|') for text in cells)} |"
