"""Printed text of commands: the end of a run, `show`, `show --budget`, `compare`, `runs`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from tests.campaigns.agreement.facts import Facts, Subject, is_dash, marks_of, seconds_of
from tests.campaigns.agreement.names import (
    CONDITIONS,
    FLAGS,
    MADE,
    MARK,
    MU,
    MU_MEASURED,
    RIG_SECONDS,
    STATUS,
    VALUES,
    WITH_CARE,
)
from tests.campaigns.agreement.record import Record
from tests.campaigns.agreement.table import TableReader, columns_of, headings_of

_NOT_MEASURED = re.compile(r"\s*(\d+) of (\d+) conditions not measured")


def read_ending(record: Record, worn: str, lines: Sequence[str], output: str) -> Facts:
    """Return the facts of the table at the end of a run."""
    facts = Facts(output)
    _conditions(facts, record, worn, lines)
    for line in lines:
        _counted(facts, record, line)
        read_tally(facts, record, line)
    return facts


def _conditions(facts: Facts, record: Record, worn: str, lines: Sequence[str]) -> None:
    """Read the table of conditions: headings in two lines, flags behind a row or below it."""
    begin = next((at for at, line in enumerate(lines) if line.startswith("compound  ")), None)
    if begin is None:
        return
    headings = headings_of(lines[begin], lines[begin + 1])
    reader = TableReader(facts, record, worn)
    for cells, remarks in _rows(lines[begin + 2 :], len(headings)):
        reader.read([*headings, FLAGS], [[*cells, remarks]])


def _rows(lines: Sequence[str], columns: int) -> list[tuple[list[str], str]]:
    """Return the rows of a table's body with their remarks, which may be on lines of their own."""
    found: list[tuple[list[str], str]] = []
    for line in lines:
        cells = [text for _, _, text in columns_of(line)]
        if line.startswith("    ") and found and " mm to " not in line:
            found[-1] = found[-1][0], f"{found[-1][1]} {line.strip()}".strip()
        elif len(cells) < columns:
            break
        else:
            found.append((cells[:columns], " ".join(cells[columns:])))
    return found


def _counted(facts: Facts, record: Record, line: str) -> None:
    if match := _NOT_MEASURED.match(line):
        facts.count(record.run, "not measured", match.group(1))
        facts.count(record.run, CONDITIONS, match.group(2))


def read_tally(facts: Facts, record: Record, text: str) -> None:
    """Read from a sentence how many conditions have a value, and how many of these have a doubt or a note."""
    if match := re.match(r"All (\d+) conditions have a value|(The condition) has a value", text):
        total = match.group(1) or "1"
        values = (total, total)
    elif match := re.match(r"(\d+) of (\d+) conditions? ha(?:ve|s) a value", text):
        values = (match.group(1), match.group(2))
    else:
        return
    facts.count(record.run, VALUES, values[0])
    facts.count(record.run, CONDITIONS, values[1])
    for word, quantity in (("doubt", WITH_CARE), ("note", "noted")):
        if match := re.search(rf"(\d+|none) carr(?:y|ies) a {word}", text):
            facts.count(record.run, quantity, match.group(1).replace("none", "0"))


def read_show(record: Record, worn: str, text: str, output: str) -> Facts:
    """Return the facts of `tester show`."""
    facts = Facts(output)
    lines = text.splitlines()
    _conditions(facts, record, worn, lines)
    for line in lines:
        _counted(facts, record, line)
        read_tally(facts, record, line)
        if match := re.match(r"status   ([a-z ]+)", line):
            facts.add(record.run, STATUS, match.group(1).strip())
        elif match := re.match(r"rig time ([\d:]+)", line):
            facts.add(record.run, RIG_SECONDS, seconds_of(match.group(1)), 0.5)
    return facts


BUDGET = re.compile(r"(?P<words>\S.*?): mu (?P<mu>\S+), mu as measured (?P<measured>\S+)")
"""Heading above the terms of a budget, on a terminal and in a report."""
OF_BUDGET = re.compile(
    r"U (?P<what>this [a-z]+|compound) (?P<u>[\d.]+|–)(?:, (?P<percent>[\d.]+|–)(?: %)?)?, "
    r"k (?:compound )?(?P<k>[\d.]+|–)"
)


def of_budget(facts: Facts, subject: Subject, match: re.Match[str]) -> None:
    """Read one of the two uncertainties of a budget."""
    which = "compound" if match["what"] == "compound" else "this piece"
    facts.number(subject, f"U {which}", match["u"])
    facts.number(subject, f"U {which} %", match["percent"] or "-")
    facts.number(subject, f"k {which}", match["k"])


def read_budget(record: Record, worn: str, text: str, output: str) -> Facts:
    """Return the facts of `tester show --budget`."""
    facts = Facts(output)
    reader = TableReader(facts, record, worn)
    subject: Subject | None = None
    heads: list[str] = []
    for line in text.splitlines():
        if match := BUDGET.fullmatch(line):
            subject, heads = reader.next_of(record.in_words(match["words"])), []
            if subject is None:
                facts.strange.append(f"no condition is like this line: {line}")
                continue
            reader.cell(subject, MU, match["mu"])
            facts.number(subject, MU_MEASURED, match["measured"])
        elif subject is None:
            continue
        elif match := OF_BUDGET.match(line.strip()):
            of_budget(facts, subject, match)
        elif line.startswith("  term "):
            heads = [text for _, _, text in columns_of(line)]
        elif heads:
            term(facts, subject, worn, dict(zip(heads, (text for _, _, text in columns_of(line)), strict=False)))
    return facts


_OF_TERM = {
    "u": "standard uncertainty", "df": "degrees of freedom", "c": "sensitivity", "u(mu) (%)": "u mu %",
    "compound (%)": "share compound %",
}  # fmt: skip


def term(facts: Facts, subject: Subject, worn: str, cells: Mapping[str, str]) -> None:
    """Read a printed term of a budget."""
    for head, quantity in (*_OF_TERM.items(), (f"this {worn} (%)", "share this %")):
        if head in cells:
            facts.number(subject, f"{cells['term']}: {quantity}", cells[head])


_RUN = re.compile(
    r"(?P<name>\S+)  (?P<status>[a-z ]+)(?:, (?P<more>.*?))?  (?P<time>[\d:]+)  "
    r"(?P<conditions>\d+) conditions, (?P<repeats>\d+) repeats  .*"
)


def read_runs(records: Sequence[Record], text: str, output: str) -> Facts:
    """Return the facts of `tester runs`."""
    facts = Facts(output)
    known = {record.name: record for record in records}
    for line in text.splitlines():
        match = _RUN.fullmatch(line)
        if match is None or match["name"] not in known:
            facts.strange.append(f"no run is like this line: {line}")
            continue
        run = known[match["name"]].run
        facts.add(run, STATUS, match["status"].strip())
        facts.add(run, RIG_SECONDS, seconds_of(match["time"]), 0.5)
        facts.count(run, CONDITIONS, match["conditions"])
        facts.count(run, MADE, match["repeats"])
        if values := re.fullmatch(r"(\d+) of (\d+) conditions have a value", match["more"] or ""):
            facts.count(run, VALUES, values.group(1))
            facts.count(run, CONDITIONS, values.group(2))
        elif committed := re.fullmatch(r"(\d+) of (\d+) repeats committed", match["more"] or ""):
            facts.count(run, MADE, committed.group(1))
            facts.count(run, "repeats planned", committed.group(2))
    return facts


_SIDES = {"mu 1": 0, "mu 2": 1}


def read_compare(records: Sequence[Record], text: str, output: str) -> Facts:
    """Return the facts of `tester compare`: the coefficients of two runs, and what the pair gives."""
    facts = Facts(output)
    lines = text.splitlines()
    shared = next((line.removeprefix("all at ") for line in lines if line.startswith("all at ")), "")
    begin = next(at for at, line in enumerate(lines) if re.match(r"condition +mu 1", line))
    readers = [TableReader(facts, record, "") for record in records]
    headings = [text for _, _, text in columns_of(lines[begin])]
    for line in lines[begin + 1 :]:
        if line.startswith("u: "):
            break
        cells = [text for _, _, text in columns_of(line)]
        found = [reader.next_of(reader.record.in_words(cells[0], shared)) for reader in readers]
        for heading, cell in zip(headings[1:], cells[1:], strict=True):
            _side(facts, found, heading, cell)
        if "verdict" in headings:
            facts.add(pair_of(found), "differs", float(cells[-1] == "differ"))
    return facts


def pair_of(subjects: Sequence[Subject | None]) -> Subject:
    """Return two conditions that are compared, as a subject."""
    return "pair", *(repr(subject) for subject in subjects)


def _side(facts: Facts, found: Sequence[Subject | None], heading: str, cell: str) -> None:
    if heading == "verdict":
        return
    if heading not in _SIDES:
        facts.number(pair_of(found), f"pair {heading}", cell)
        return
    subject = found[_SIDES[heading]]
    if subject is not None:
        facts.number(subject, MU, cell)
        if not is_dash(cell):
            facts.add(subject, MARK, marks_of(cell))
