"""A report: every table, sentence and hover text of the page, read by a strict HTML parser."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from xml.etree.ElementTree import Element

from tests.campaigns.agreement.facts import Facts
from tests.campaigns.agreement.names import (
    CONDITIONS,
    LEFT_OUT,
    MU,
    MU_MEASURED,
    STATUS,
    U_THIS,
    quantity_of,
)
from tests.campaigns.agreement.read_text import BUDGET, OF_BUDGET, of_budget, pair_of, read_tally, term
from tests.campaigns.agreement.record import Record
from tests.campaigns.agreement.table import TableReader

_X = "{http://www.w3.org/1999/xhtml}"


class PageError(Exception):
    """The page is not well-formed HTML."""


def page(text: str) -> Element:
    """Return the root of a page; raises PageError for the first violation of HTML."""
    import html5lib  # not an extra of the package: .ci/run installs it; the other outputs do not need it

    parser = html5lib.HTMLParser(strict=True)
    try:
        root: Element = parser.parse(text)
    except html5lib.html5parser.ParseError as error:
        raise PageError(f"the page is no HTML: {error}") from error
    return root


def _text(element: Element) -> str:
    return "".join(element.itertext()).strip()


def read_page(records: Sequence[Record], worn: Sequence[str], text: str, output: str) -> Facts:
    """Return the facts of a report of one run or several."""
    facts = Facts(output)
    root = page(text)
    body = next(root.iter(f"{_X}body"))
    header = next(body.iter(f"{_X}header"))
    _cover(facts, records, worn, header)
    articles = list(body.iter(f"{_X}article"))
    chapters = [one for one in articles if re.fullmatch(r"r\d+", one.get("id", ""))]
    for record, kind, chapter in zip(records, worn, chapters, strict=True):
        _tables(facts, record, kind, chapter)
        _pictures(facts, [record], chapter)
    for chapter in articles:
        if chapter.get("id") == "all":
            _together(facts, records, chapter)
    return facts


def _cover(facts: Facts, records: Sequence[Record], worn: Sequence[str], header: Element) -> None:
    """Read the first page: facts, verdict and short table of each run, one run after the other."""
    at = -1
    for element in header.iter():
        record = records[max(at, 0)]
        if element.tag == f"{_X}dl":
            at += 1
            record = records[at]
            for name, value in zip(element.iter(f"{_X}dt"), element.iter(f"{_X}dd"), strict=True):
                if _text(name) == "conditions":
                    facts.count(record.run, CONDITIONS, _text(value))
                if _text(name) == "status":
                    facts.add(record.run, STATUS, _text(value).split(":")[0])
        elif element.tag == f"{_X}p":
            read_tally(facts, record, _text(element))
        elif element.tag == f"{_X}figure" and at >= 0:
            _table(facts, record, worn[at], element, TableReader(facts, record, worn[at]))


def _heads_and_rows(figure: Element) -> tuple[list[str], list[list[str]]]:
    heads = [_text(one) for one in figure.iter(f"{_X}th")]
    rows = [[_text(cell) for cell in row.iter(f"{_X}td")] for row in figure.iter(f"{_X}tr")]
    return heads, [row for row in rows if row]


def _caption(figure: Element) -> str:
    return next((_text(one) for one in figure.iter(f"{_X}figcaption")), "")


_OF_CONDITIONS = ("What was found", "Conditions of", "Drift and repeats", "Repeats that are left out")
def _tables(facts: Facts, record: Record, worn: str, chapter: Element) -> None:
    budgets = TableReader(facts, record, worn)
    for figure in chapter.iter(f"{_X}figure"):
        if "table" not in figure.get("class", ""):
            continue
        caption = _caption(figure)
        if match := BUDGET.fullmatch(caption):
            _budget(facts, budgets, match, figure)
        elif caption.startswith("What was mounted"):
            _mounted(facts, record, worn, figure)
        elif caption.startswith(_OF_CONDITIONS):
            _table(facts, record, worn, figure, TableReader(facts, record, worn))


_OF_PIECE = {
    "diameter installed (mm)": "installed diameter mm",
    "diameter at the end (mm)": "diameter mm",
    "slid (m)": "sliding m",
}


def _mounted(facts: Facts, record: Record, worn: str, figure: Element) -> None:
    heads, rows = _heads_and_rows(figure)
    for row in rows:
        for head, cell in zip(heads[1:], row[1:], strict=True):
            if head not in ("specimen", "replicate", "compound", "mounted at"):
                facts.number(("piece", record.name, int(row[0])), _OF_PIECE.get(head, quantity_of(head, worn)), cell)


def _table(facts: Facts, record: Record, worn: str, figure: Element, reader: TableReader) -> None:
    caption = _caption(figure)
    heads, rows = _heads_and_rows(figure)
    if caption.startswith("What was found, by compound"):
        return
    if caption.startswith("Repeats that are left out"):
        for row in rows:
            condition, repeat = (int(part) for part in row[0].split("/"))
            subject = record.of_repeat(condition, repeat)
            facts.number(subject, f"repeat {MU_MEASURED}", row[2])
            facts.add(subject, "repeat exclusion", row[3])
        facts.count(record.run, LEFT_OUT, len(rows))
        return
    reader.read(heads, rows)


def _budget(facts: Facts, reader: TableReader, match: re.Match[str], figure: Element) -> None:
    subject = reader.next_of(reader.record.in_words(match["words"]))
    if subject is None:
        facts.strange.append(f"no condition is like this caption: {match.group()}")
        return
    reader.cell(subject, MU, match["mu"])
    facts.number(subject, MU_MEASURED, match["measured"])
    note = " ".join(_text(one) for one in figure.iter(f"{_X}p")).replace("\u00a0", " ")
    for found in OF_BUDGET.finditer(note):
        of_budget(facts, subject, found)
    heads, rows = _heads_and_rows(figure)
    for row in rows:
        term(facts, subject, reader.worn, dict(zip(heads, row, strict=True)))


_POINT = re.compile(
    r"(?:(?P<run>\S+): )?(?:condition (?P<condition>\d+), )?(?P<words>[^:]+): (?P<mu>-?\d+\.\d+)(?: ± (?P<u>[\d.]+))?"
)
_REPEAT = re.compile(r"repeat (?P<condition>\d+)/(?P<repeat>\d+): (?P<mu>-?\d+\.\d+)(?:, (?P<why>.*))?")


def hovers(element: Element) -> Iterator[str]:
    """Yield the hover texts of a drawing's points."""
    for one in element.iter():
        if isinstance(one.tag, str) and one.tag.endswith("}title") and not one.tag.startswith(_X):
            yield _text(one).replace("\u00a0", " ")


def _pictures(facts: Facts, records: Sequence[Record], chapter: Element) -> None:
    """Read the texts beside the points of the drawings."""
    names = {record.name: record for record in records}
    for figure in chapter.iter(f"{_X}figure"):
        for text in hovers(figure):
            read_hover(facts, names, text)


def read_hover(facts: Facts, names: dict[str, Record], text: str) -> None:
    """Read the text beside a point: which condition or repeat, the coefficient, U."""
    if text.startswith("as published"):
        return
    if match := _REPEAT.fullmatch(text):
        for record in names.values():
            if len(names) == 1:
                at = record.of_repeat(int(match["condition"]), int(match["repeat"]))
                facts.number(at, f"repeat {MU_MEASURED}", match["mu"])
        return
    match = _POINT.fullmatch(text)
    if match is None:
        return
    record = names.get(match["run"] or "", next(iter(names.values())) if len(names) == 1 else None)
    if record is None:
        return
    if match["condition"]:
        subject = record.of_condition(int(match["condition"]))
    else:
        rows = record.in_words(match["words"])
        if len(rows) != 1:
            return  # only the number distinguishes rows that share a setting
        subject = record.of_row(rows[0])
    facts.number(subject, MU, match["mu"])
    facts.number(subject, U_THIS, match["u"] or "-")


def _together(facts: Facts, records: Sequence[Record], chapter: Element) -> None:
    """Read the comparison of the first run with each of the others, and the pictures of all."""
    _pictures(facts, records, chapter)
    captions = {f"{records[0].name} and {other.name}": other for other in records[1:]}
    for figure in chapter.iter(f"{_X}figure"):
        other = captions.get(_caption(figure))
        if other is None:
            continue
        heads, rows = _heads_and_rows(figure)
        readers = [TableReader(facts, record, "") for record in (records[0], other)]
        for row in rows:
            cells = {head.lower(): cell for head, cell in zip(heads, row, strict=True)}
            found = [reader.by_setpoint(cells, [*cells]) for reader in readers]
            for subject, head, reader in zip(found, ("mu 1", "mu 2"), readers, strict=True):
                if subject is not None:
                    reader.cell(subject, MU, cells[head])
            pair = pair_of(found)
            for head in ("difference", "u", "z", "k"):
                facts.number(pair, f"pair {head}", cells[head])
            facts.add(pair, "differs", float(cells["verdict"] == "differ"))


