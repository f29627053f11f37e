"""The papers' results and items: the command writes the stored page, and every item has a verdict with numbers."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path

import click
import pytest

from tester.analysis.papers import (
    Judged,
    Paper,
    PaperFinding,
    PaperItem,
    PaperRow,
    PaperVerdict,
    items_text,
    judged,
    judged_papers,
    not_attempted,
    rows_of,
    slight,
    table_text,
    unjudged,
)
from tester.cli.main import invoke, root
from tester.kinds import packaged_papers

pytest.importorskip("scipy", reason="needs the extra `report`")

STORED = Path(__file__).with_name("papers.txt")
PAGE = Path(__file__).parents[3] / "docs" / "papers.md"
"""Latest items and page of `python docs/papers.py`; a changed verdict or number changes these files."""
WANTED = Path(__file__).parents[4] / "shared" / "design" / "papers.md"
"""The list of results to reproduce, where it is at hand."""
MOST_NOT_ATTEMPTED = 12
NUMBER = re.compile(r"(?<![\w.])[+-]?\d+\.?\d*(?:e[+-]\d+)?")
ITEMS = [(paper.name, item) for paper in packaged_papers() for item in paper.items]
COMMANDS = sorted({item.command for _, item in ITEMS if item.command})


@pytest.fixture(scope="module")
def result() -> Judged:
    return judged_papers(packaged_papers())


def same(a: str, b: str) -> bool:
    """Return whether two lines differ in the last digit of numbers at most."""
    if NUMBER.sub("#", a) != NUMBER.sub("#", b):
        return False
    return all(
        abs(float(x) - float(y)) <= 1.01 * unit(x) for x, y in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True)
    )


def unit(number: str) -> float:
    """Return one unit in the last digit of a decimal number; 0 for a whole number, which is a count."""
    mantissa, e, exponent = number.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(exponent) - decimals) if e else (10.0**-decimals if decimals else 0.0)


@pytest.mark.parametrize(("path", "text"), [(STORED, items_text), (PAGE, table_text)], ids=["items", "page"])
def test_the_stored_page_matches_the_command(path: Path, text: Callable[[Judged], str], result: Judged) -> None:
    lines, stored = text(result).splitlines(), path.read_text(encoding="utf-8").splitlines()
    assert len(lines) == len(stored)
    assert [(a, b) for a, b in zip(lines, stored, strict=True) if not same(a, b)] == []


def wanted() -> list[str]:
    """Return the results of the first table of the list."""
    if not WANTED.is_file():
        pytest.skip("the list of results is not at hand")
    table = WANTED.read_text(encoding="utf-8").partition("| paper |")[2].partition("\n\n")[0]
    return [line.split("|")[2].strip() for line in table.splitlines()[2:]]


def test_the_page_has_every_wanted_result_as_a_row_of_its_own() -> None:
    assert [row.result for paper in packaged_papers() for row in paper.rows] == wanted()


def test_few_rows_are_not_attempted_and_each_has_its_reason(result: Judged) -> None:
    rows = [row for paper, items in result for row in rows_of(paper, items)]
    left = [row for row in rows if row.verdict is PaperVerdict.NOT_ATTEMPTED]
    assert len(left) <= MOST_NOT_ATTEMPTED
    assert [row.row.result for row in left if len(row.words) < 20] == []


@pytest.mark.parametrize("paper", packaged_papers(), ids=lambda paper: paper.name)
def test_every_place_of_a_row_selects_an_item(paper: Paper) -> None:
    places = [place for row in paper.rows for place in row.places]
    assert [place for place in places if not any(PaperRow("", (place,)).has(item) for item in paper.items)] == []


@pytest.mark.parametrize(
    ("verdicts", "of_row"),
    [("RR", "reproduced"), ("RF", "refuted"), ("RN", "not attempted"), ("FN", "not attempted")],
)
def test_a_row_is_as_good_as_its_least_item(verdicts: str, of_row: str) -> None:
    findings = {"R": judged(True, "1 %"), "F": judged(False, "9 %", "1 %"), "N": unjudged("no numbers")}
    items = tuple(PaperItem("Eq 1", str(i), "", lambda one=one: findings[one]) for i, one in enumerate(verdicts))
    ((paper, found),) = judged_papers([Paper("P", "", items, (PaperRow("Eq", ("Eq 1",)),))])
    assert [row.verdict.value for row in rows_of(paper, found)] == [of_row]


def test_every_refutation_has_numbers_and_their_u(result: Judged) -> None:
    refuted = [entry for _, items in result for entry in items if entry.finding.verdict is PaperVerdict.REFUTED]
    assert refuted
    assert [e.item.states for e in refuted if not (e.finding.u and re.search(r"\d", e.finding.error))] == []


def test_without_u_nothing_is_refuted() -> None:
    assert judged(False, "9 %").verdict is PaperVerdict.NOT_ATTEMPTED
    assert judged(False, "9 %", "1 %").words == "9 % (U 1 %)"


@pytest.mark.parametrize(
    ("a", "b", "alike"),
    [
        ("off by 1.2 %", "off by 1.3 %", True),
        ("off by 1.2 %", "off by 1.4 %", False),
        ("36 of 79", "37 of 79", False),
        ("| reproduced | 1.2", "| refuted | 1.2", False),
    ],
)
def test_pages_may_differ_by_rounding_alone(a: str, b: str, alike: bool) -> None:
    assert same(a, b) is alike


PLACES = {
    "Wheel on a belt": [f"Fig {i}" for i in range(1, 16)] + [f"Eq {i}" for i in range(1, 10)]
    + [f"Table {i}" for i in (1, 2, 3)] + ["Appendix A", "Appendix B", "5 (1)", "5 (2)", "5 (3)"],
    "Grosch and Persson": [f"Fig {i}" for i in range(1, 18)] + [f"Eq {i}" for i in range(1, 5)] + ["Table 1", "8", "9"],
    "GrETA": [f"Fig {i}" for i in range(1, 22)] + [f"Eq {i}" for i in range(1, 23)] + ["Table 1", "Conclusions"],
}  # fmt: skip


def places(items: Sequence[PaperItem]) -> set[str]:
    """Return the places named by items, with spans and lists expanded."""
    found: set[str] = set()
    for item in items:
        for kind, text in re.findall(r"(Fig|Eq|Table)s? ([\d, abcto]+)", item.where):
            spans = re.findall(r"(\d+)[abc]?(?: to (\d+))?", text)
            found |= {f"{kind} {i}" for low, high in spans for i in range(int(low), int(high or low) + 1)}
        found |= {part.strip() for part in item.where.split(",")}
    return found


@pytest.mark.parametrize("name", PLACES)
def test_every_figure_table_and_equation_is_there(name: str) -> None:
    (paper,) = [one for one in packaged_papers() if one.name == name]
    assert set(PLACES[name]) - places(paper.items) == set()


@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_of_the_page_is_one(command: str) -> None:
    for one in command.replace("RUN", "latest").split(", then "):
        name, *arguments = shlex.split(one.removeprefix("tester "))
        context = click.Context(root)
        found = root.get_command(context, name)
        assert found is not None
        while isinstance(found, click.Group):
            part = found.get_command(context, arguments.pop(0))
            assert part is not None
            found = part
        found.make_context(name, arguments)


def test_json_has_the_same_items_as_the_page(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    small = (Paper("P", "somebody", (PaperItem("Eq 1", "a | b", "tester runs", lambda: judged(True, "0.1 %")),)),)
    monkeypatch.setattr("tester.kinds.packaged_papers", lambda: small)
    assert invoke(["paper", "--all", "--json"]) == 0
    assert '"verdict": "reproduced"' in capsys.readouterr().out
    assert invoke(["paper", "--all"]) == 0
    assert r"| Eq 1 | a \| b | reproduced | 0.1 % | `tester runs` |" in capsys.readouterr().out


def test_a_verdict_is_worked_out_when_it_is_asked_for() -> None:
    asked: list[int] = []

    def work_out() -> PaperFinding:
        asked.append(1)
        return judged(len(asked) < 2, str(len(asked)), "" if len(asked) < 2 else "1")

    paper = Paper("P", "", (PaperItem("Eq 1", "", "", work_out),))
    first, second = items_text(judged_papers([paper])), items_text(judged_papers([paper]))
    assert "| reproduced | 1 |" in first and "| refuted | 2 (U 1) |" in second
    assert "| P | 1 | 0 | 0 |" in first and "| P | 0 | 1 | 0 |" in second


def test_an_unattempted_item_has_a_reason() -> None:
    assert not_attempted("Fig 1", "a drawing", "no numbers").work_out() == unjudged("no numbers")
    reasons = [item.work_out() for _, item in ITEMS if "not_attempted" in getattr(item.work_out, "__qualname__", "")]
    assert reasons and all(one.verdict is PaperVerdict.NOT_ATTEMPTED and len(one.error) > 10 for one in reasons)


def test_differences_of_rounding_are_not_reported_as_digits() -> None:
    assert (slight(3e-16), slight(2.4e-5)) == ("less than 1e-09", "2e-05")
