"""The page of all papers: a table of items with their verdicts, computed at the time of writing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from tester.analysis.papers.item import Paper, PaperFinding, PaperItem, PaperVerdict

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
