"""The operator's screens as text: results, repeats, replay."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise

from tester.analysis.flags import FLAGS
from tests.campaigns.agreement.facts import Facts, seconds_of
from tests.campaigns.agreement.names import CONDITIONS, MU, RIG_SECONDS, STATUS, VALUES, quantity_of
from tests.campaigns.agreement.record import Record
from tests.campaigns.agreement.table import TableReader

_EDGE = "│"


def boxes(text: str) -> dict[str, list[str]]:
    """Return the contents of a screen's full-width boxes, by title."""
    found: dict[str, list[str]] = {}
    title = ""
    for line in text.splitlines():
        if line.startswith("╭"):
            title = line.strip("╭─╮ ")
            found[title] = []
        elif line.startswith(_EDGE) and title:
            found[title].append(line.strip(_EDGE))
        elif line.startswith("╰"):
            title = ""
    return found


def cells_of(header: str, line: str) -> list[str]:
    """Return the cells of a line below a table's headings; columns begin where the headings begin."""
    starts = [match.start() for match in re.finditer(r"(?:(?<=  )|^ ?)\S", header)]
    starts = [at + len(header[at:]) - len(header[at:].lstrip()) for at in starts]
    return [line[begin:end].strip() for begin, end in pairwise([*starts, len(line) + 1])]


def read_results(record: Record, worn: str, text: str, output: str) -> Facts:
    """Return the facts of the Results screen: the line of the run, and its conditions."""
    facts = Facts(output)
    for title, lines in boxes(text).items():
        if title.startswith("Runs") and lines:
            _runs(facts, record, lines)
        elif title.startswith(record.name) and lines:
            _conditions(facts, record, worn, lines)
    return facts


def _runs(facts: Facts, record: Record, lines: Sequence[str]) -> None:
    for line in lines[1:]:
        cells = dict(zip(cells_of(lines[0], lines[0]), cells_of(lines[0], line), strict=True))
        if cells.get("Run") != record.name:
            continue
        facts.add(record.run, STATUS, cells["Status"])
        values, conditions = cells["Values"].split("/")
        facts.count(record.run, VALUES, values)
        facts.count(record.run, CONDITIONS, conditions)
        facts.add(record.run, RIG_SECONDS, seconds_of(cells["Rig time"]), 0.5)


def _conditions(facts: Facts, record: Record, worn: str, lines: Sequence[str]) -> None:
    """Read the table of conditions, a line each in the order of the record, references last."""
    headings = cells_of(lines[0], lines[0])
    order = _order(record)
    for line in lines[1:]:
        cells = cells_of(lines[0], line)
        if not any(cells):
            break
        number = next(order, None)
        if number is None:
            facts.strange.append(f"no condition is like this line: {line.strip()}")
            return
        reader = TableReader(facts, record, worn)
        for heading, cell in zip(headings, cells, strict=True):
            if not cell.endswith("…"):
                reader.cell(record.of_condition(number), heading, cell)


def _order(record: Record) -> Iterator[int]:
    """Yield the numbers of conditions as tables list them: the recipe's rows, then references."""
    rows = sorted(record.rows, key=lambda row: (record.is_reference(row), row))
    for row in rows:
        yield from (condition.number for condition in record.rows[row])


_REPEAT = re.compile(r"repeat (?P<repeat>\d+): (?P<rest>.*)")
_REPEAT_STATUS = frozenset({"valid", "refused", "too few revolutions", "temperature cannot be held", "not reached"})
_FIGURE = re.compile(r"(?P<heading>.+?) (?P<value>\d+ of \d+.*|\S+|\S+ %)")


def read_repeats(record: Record, worn: str, condition: int, text: str, output: str) -> Facts:
    """Return the facts of the dialog that shows the repeats of a condition: its figures, then a line a repeat."""
    facts = Facts(output)
    reader = TableReader(facts, record, worn)
    subject = record.of_condition(condition)
    lines = [line.strip("│┃ ") for line in text.splitlines()]
    for figure in _heading(lines).split("  ")[1:]:
        if figure.startswith("flags "):
            reader.cell(subject, "flags", figure.removeprefix("flags "))
        elif match := _FIGURE.fullmatch(figure.strip()):
            reader.cell(subject, match["heading"], match["value"])
    for line in lines:
        match = _REPEAT.match(line)
        if match is None:
            continue
        at = record.of_repeat(condition, int(match["repeat"]))
        for part in match["rest"].split("  "):
            figure = _FIGURE.fullmatch(part.strip())
            if part.strip() in _REPEAT_STATUS:
                facts.add(at, "repeat status", part.strip())
                facts.add(at, "repeat in mean", float("not in the mean" not in line))
            elif figure is not None and not part.startswith("✘"):
                facts.number(at, f"repeat {quantity_of(figure['heading'], worn)}", figure["value"])
    return facts


def _heading(lines: Sequence[str]) -> str:
    """Return the condition's line, which the dialog wraps; "word (weight): meaning" of each flag follows it."""
    begin = next((at for at, line in enumerate(lines) if re.search(r"  mu [\d.–]", line)), len(lines))
    whole = [*lines[begin : begin + 1]]
    for line in lines[begin + 1 :]:
        if not line or _REPEAT.match(line) or any(line.startswith(f"{word} (") for word in FLAGS):
            break
        whole.append(line)
    return " ".join(whole)


_COND = re.compile(r"(\d+)/(\d+) done")
_HEAD_LEFT, _CAMPAIGN_LEFT = re.compile(r"left (\d+:\d\d:\d\d)"), re.compile(r"Campaign .*?(\d+:\d\d:\d\d) left")
_STEP = re.compile(r"([✔▶·]) (\S.*?)\s+(~?\d+:\d\d(?::\d\d)?)\s*[│┃]")


def moment(facts: Facts, record: Record, at: str, text: str) -> None:
    """Read a moment of a run from the Run screen: conditions done, time left, the list of steps."""
    subject = ("moment", record.name, at)
    if match := _COND.search(text):
        facts.count(subject, "conditions done", match.group(1))
        facts.count(record.run, "conditions of the plan", match.group(2))
    for found in (_HEAD_LEFT.search(text), _CAMPAIGN_LEFT.search(text)):
        if found is not None:
            facts.add(subject, "time left", seconds_of(found.group(1)), 0.49)
    steps = [(match.group(1), seconds_of(match.group(3)) or 0.0) for match in _STEP.finditer(text)]
    if steps:  # the list adds up to the second
        facts.add(subject, "time left", sum(seconds for sign, seconds in steps if sign != "✔"), 0.49)


_STEP_VALUE = re.compile(r"✔ (\S.*?)\s+(-?\d\.\d+[?!]?) ± (\d\.\d+)")


def read_steps(record: Record, worn: str, text: str, output: str) -> Facts:
    """Return the facts of the list of steps: mu and U of each finished condition with unique words."""
    facts = Facts(output)
    reader = TableReader(facts, record, worn)
    for match in _STEP_VALUE.finditer(text):
        rows = record.in_words(match[1])
        numbers = [condition.number for row in rows for condition in record.rows[row]]
        if len(numbers) == 1:
            reader.cell(record.of_condition(numbers[0]), MU, match[2])
            reader.cell(record.of_condition(numbers[0]), f"U this {worn}", match[3])
        elif not rows and not match[1].endswith("…"):
            facts.strange.append(f"no condition is like this step: {match.group()}")
    return facts


def done_by(record: Record, at_s: float) -> int:
    """Return how many conditions were finished at a rig time."""
    return sum(one.ended_s is not None and one.ended_s <= at_s for one in record.conditions)
