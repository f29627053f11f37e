"""Finds the table in an instrument's file: its delimiter, its row of headings, its row of units."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from tester.inputs.materials.headings import UnitRefusedError, heading, is_unit

LOOKED_AT = 400
"""Lines at the beginning that are searched for the headings."""

_DELIMITERS = ("\t", ";", ",")
_IN_BRACKETS = re.compile(r"^[\[({](.*)[\])}]$")


@dataclass(frozen=True, slots=True)
class DmaLayout:
    """Places of headings, units and rows; lines count from 0."""

    lines: Sequence[str]
    delimiter: str
    at: int
    headings: Sequence[str]
    units: Sequence[str] | None

    def cells(self, line: int) -> list[str]:
        """Return the cells of a line."""
        return _split(self.lines[line], self.delimiter)

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Yield line and cells of every row that is not empty."""
        for line in range(self.at + (2 if self.units is not None else 1), len(self.lines)):
            cells = self.cells(line)
            if any(cells):
                yield line, cells


def _split(line: str, delimiter: str) -> list[str]:
    return [cell.strip() for cells in csv.reader([line], delimiter=delimiter) for cell in cells]


def layout_of(lines: Sequence[str], headings: Iterable[str]) -> DmaLayout | None:
    """Return the row with the most recognised quantities, at least two; None where there is none.

    ``headings``: headings that a person has named.
    """
    named = {text.casefold() for text in headings}
    best: tuple[int, int, str] | None = None
    for delimiter in _DELIMITERS:
        for at, line in enumerate(lines[:LOOKED_AT]):
            cells = _split(line, delimiter)
            score = len({_named(cell) or cell for cell in cells if _named(cell) or cell.casefold() in named})
            if len(cells) >= 2 and score >= 2 and (best is None or score > best[0]):
                best = (score, at, delimiter)
    if best is None:
        return None
    _, at, delimiter = best
    units = None
    if at + 1 < len(lines):
        below = [without_brackets(cell) for cell in _split(lines[at + 1], delimiter)]
        if any(below) and all(is_unit(cell) for cell in below) and not all(_numeric(cell) for cell in below if cell):
            units = below
    return DmaLayout(lines, delimiter, at, _split(lines[at], delimiter), units)


def _numeric(cell: str) -> bool:
    return bool(re.fullmatch(r"[-+]?[0-9.]+", cell))


def _named(cell: str) -> str:
    try:
        return heading(cell).quantity
    except UnitRefusedError:
        return "a unit that is refused"


def without_brackets(text: str) -> str:
    """Return a unit without its brackets."""
    return _IN_BRACKETS.sub(r"\1", text.strip())
