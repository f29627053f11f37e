"""Drawings: points and bars on matplotlib's canvas, and the numbers written into surfaces."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import isfinite
from typing import Any

from tests.campaigns.agreement.facts import Facts, Subject
from tests.campaigns.agreement.names import MU, U_THIS
from tests.campaigns.agreement.record import Record, RecordedAxis, plain_heading

_DRAWN = 1e-9
"""Relative error of a number on a canvas: a bar is stored as its two ends."""
_FLAT = 1e-6
"""Smallest length of a bar that counts, in units of the coefficient."""


@contextmanager
def canvases() -> Iterator[list[Any]]:
    """Collect the canvases written inside the block."""
    from matplotlib.figure import Figure

    collected: list[Any] = []
    save = Figure.savefig

    def keep(canvas: Any, *arguments: Any, **options: Any) -> None:
        collected.append(canvas)
        save(canvas, *arguments, **options)

    Figure.savefig = keep
    try:
        yield collected
    finally:
        Figure.savefig = save


def read_canvases(records: Sequence[Record], drawn: Sequence[Any], output: str) -> Facts:
    """Return the facts of drawings of one run, or of several in one picture.

    A point belongs to the condition with its setpoint; if there are several, to the one with the nearest coefficient.
    """
    facts = Facts(output)
    for canvas in drawn:
        title = canvas.get_suptitle().replace("\n", " ")
        for place in canvas.axes:
            if title.startswith("friction coefficient over"):
                _chart(facts, records, place)
                _surface(facts, records, place)
            elif title.startswith(("the run", "runs, one after")):
                _overview(facts, records, place)
            elif title.startswith("repeats of"):
                _repeats(facts, records, place, title)
    return facts


def _points(place: Any) -> Iterator[tuple[str, list[tuple[float, float, float]]]]:
    """Yield the label of each series with bars, and its points: x, y, half the length of the upright bar."""
    for container in place.containers:
        line, _, bars = container
        xy = line.get_xydata()
        upright = [0.0] * len(xy)
        for collection in bars:
            segments = collection.get_segments()
            lengths = [abs(part[1][1] - part[0][1]) if len(part) else 0.0 for part in segments]  # none: no U
            if len(lengths) == len(xy) and any(length > _FLAT for length in lengths):
                upright = [0.5 * length for length in lengths]
        yield (
            str(container.get_label()),
            [(float(x), float(y), bar) for (x, y), bar in zip(xy, upright, strict=True)],
        )


def _chart(facts: Facts, records: Sequence[Record], place: Any) -> None:
    title = place.get_title().replace("\n", " ")
    for label, points in _points(place):
        of_run = [record for record in records if record.name == label]
        for record in of_run or records:
            axis = record.axis_of(place.get_xlabel())
            if axis is None:
                continue
            for x, y, bar in points:
                rows = _rows_at(record, axis, x, title, label)
                _take(facts, record, rows, y, bar, f"{label} at {x:g}")


def _rows_at(record: Record, axis: RecordedAxis, x: float, title: str, label: str) -> list[int]:
    """Return the rows at a place of an axis, of the panel's compound and the label's level."""
    number = re.match(r"([-+.e\d]+) ?(\S*)$", label)
    rows: list[int] = []
    for row, replicates in record.rows.items():
        condition = replicates[0]
        value = condition.setpoint.get(axis.name)
        named = not title or title.startswith(condition.compound)
        if record.is_reference(row) or not named or not _is(value, x):
            continue
        others = (condition.setpoint.get(other.name) for other in record.axes if other.name != axis.name)
        if number is None or any(_is(other, float(number.group(1))) for other in others):
            rows.append(row)
    return rows


def _is(value: float | str | None, x: float) -> bool:
    return isinstance(value, float | int) and abs(value - x) <= 1e-6 * max(abs(x), 1.0)


def _take(facts: Facts, record: Record, rows: Sequence[int], y: float, bar: float, where: str) -> None:
    """Add a point to the facts of a row if there is only one. Of several rows, any may be the right one
    (``NEAREST``)."""
    if not rows:
        facts.strange.append(f"no condition is like this point: {where}, {y:.4f}")
        return
    subject: Subject = record.of_row(rows[0]) if len(rows) == 1 else ("nearest", record.name, *rows)
    facts.add(subject, MU, y, _DRAWN * abs(y))
    facts.add(subject, U_THIS, bar if bar > 0.0 else None, _DRAWN * abs(y))


def _surface(facts: Facts, records: Sequence[Record], place: Any) -> None:
    for record in records[:1]:
        along, upward = record.axis_of(place.get_xlabel()), record.axis_of(place.get_ylabel())
        if along is None or upward is None:
            continue
        title = place.get_title().replace("\n", " ")
        for text in place.texts:
            x, y = text.get_position()
            at_y = set(_rows_at(record, upward, float(y), title, ""))
            rows = [row for row in _rows_at(record, along, float(x), title, "") if row in at_y]
            if len(rows) == 1:
                facts.number(record.of_row(rows[0]), MU, text.get_text())


def _overview(facts: Facts, records: Sequence[Record], place: Any) -> None:
    """Read the strip of coefficients: a point is at half of the time that its condition took."""
    if plain_heading(place.get_ylabel()) != "coefficient":
        return
    for label, points in _points(place):
        if label in ("make-up repeat", "repeat left out"):
            continue
        for x, y, bar in points:
            at = _condition_at(records, x)
            if at is None:
                facts.strange.append(f"no condition is at {x:.3f} min")
                continue
            facts.add(at, MU, y, _DRAWN * abs(y))
            facts.add(at, U_THIS, bar if bar > 0.0 else None, _DRAWN * abs(y))


def _condition_at(records: Sequence[Record], minute: float) -> Subject | None:
    origin = 0.0
    for record in records:
        for condition in record.conditions:
            begin = condition.began_s
            end = begin if condition.ended_s is None else condition.ended_s
            if begin is not None and end is not None and abs(origin + (begin + end) / 120.0 - minute) < 1e-6:
                return record.of_condition(condition.number)
        origin += record.rig_seconds / 60.0
    return None


def _repeats(facts: Facts, records: Sequence[Record], place: Any, title: str) -> None:
    """Read the title of a plot of repeats; the hover texts of the page serve to compare its points."""
    match = re.fullmatch(r"repeats of (.+): (-?[\d.]+) ± ([\d.]+)", title)
    if match is None:
        return
    record = records[0]
    rows = record.in_words(match.group(1))
    if len(rows) == 1 and isfinite(float(match.group(2))):
        condition = record.rows[rows[0]]
        if len(condition) == 1:
            facts.number(record.of_row(rows[0]), MU, match.group(2))
            facts.number(record.of_row(rows[0]), U_THIS, match.group(3))
