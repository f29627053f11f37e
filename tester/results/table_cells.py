"""Cells of a CSV file: numbers stay numbers, text is never a formula, and both read back unchanged.

RFC 4180 with LF line ends and UTF-8. A text cell that a spreadsheet could take for a formula gets an apostrophe in
front (so does one that begins with an apostrophe, which makes it reversible).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from math import isfinite

from tester.base.words import harmless

BOM = b"\xef\xbb\xbf"

_FORMULA = frozenset("=+-@\t\r\n'＝＋－＠")
"""First characters of formulas in Excel, Calc or Sheets, the full-width forms included, and the apostrophe."""

_QUOTED = frozenset('",\r\n')

Cell = str | int | float | None


class Number(str):
    """A formatted number: written unchanged, never escaped."""

    __slots__ = ()


def text(value: str) -> str:
    """Return a text cell, escaped where it could be taken for a formula; characters that could steer a terminal become
    ``?``."""
    value = harmless(value)
    return f"'{value}" if begins_like_a_formula(value) else value


def begins_like_a_formula(value: str) -> bool:
    """Return whether a spreadsheet could take a text for a formula, or its apostrophe for a mark of text."""
    return value[:1] in _FORMULA and bool(value)


def number(value: float | None) -> Number:
    """Return a number with seven significant digits, an integer in full, empty for a missing value."""
    if value is None or not isfinite(value):
        return Number("")
    if isinstance(value, int):
        return Number(value)
    return Number(f"{value + 0.0:.7g}")


def exact(value: float) -> Number:
    """Return the shortest number that reads back as the same float64, empty for NaN."""
    return Number(repr(value)) if isfinite(value) else Number("")


def nominal(value: float | str) -> str:
    """Return a setpoint: an integer where it is integral (to a millionth), else the shortest decimal; or a choice."""
    if isinstance(value, str):
        return value
    rounded = round(value, 6)
    return Number(int(rounded)) if rounded == int(rounded) else Number(repr(rounded))


def line(cells: Iterable[Cell]) -> str:
    """Return one line of CSV: str cells are text (escaped, quoted as needed), the others numbers."""
    return ",".join([_cell(cell) for cell in cells]) + "\n"


def _cell(cell: Cell) -> str:
    if isinstance(cell, Number):
        return cell
    if not isinstance(cell, str):
        return number(cell)
    escaped = text(cell)
    if not _QUOTED.isdisjoint(escaped) or escaped != escaped.strip():
        return '"' + escaped.replace('"', '""') + '"'
    return escaped


def encode(rows: Iterable[Sequence[Cell]], *, bom: bool = False) -> Iterator[bytes]:
    """Yield rows as the bytes of a CSV file, some rows at a time."""
    if bom:
        yield BOM
    pending: list[str] = []
    for row in rows:
        pending.append(line(row))
        if len(pending) >= 512:
            yield "".join(pending).encode()
            pending.clear()
    yield "".join(pending).encode()
