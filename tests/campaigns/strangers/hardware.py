"""The written table of defects against which only hardware protects: docs/hardware-strangers.csv."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

from tests.campaigns.strangers.draw import Case, Drawn

WRITTEN = Path(__file__).resolve().parents[3] / "docs" / "hardware-strangers.csv"


@dataclass(frozen=True, slots=True)
class Row:
    """A defect whose size is at least ``beyond`` (in its unit, to either side), alone or with ``other``.

    ``place`` and ``other`` are patterns of names; "" for ``other``: the first alone suffices. ``kind``: of machine.
    """

    kind: str
    place: str
    beyond: float
    other: str
    device: str
    why: str

    def covers(self, kind: str, case: Case) -> bool:
        """Return whether a case is of this row."""
        mine = [one for one in case.defects if self._is(one)] if kind == self.kind else []
        if not self.other:
            return bool(mine)
        return any(fnmatchcase(two.place.name, self.other) for one in mine for two in case.defects if two is not one)

    def _is(self, one: Drawn) -> bool:
        return fnmatchcase(one.place.name, self.place) and (one.place.whole or abs(one.size) >= self.beyond)


@cache
def written() -> tuple[Row, ...]:
    """Return the written table."""
    with WRITTEN.open(encoding="utf-8", newline="") as file:
        return tuple(
            Row(row["kind"], row["place"], float(row["beyond"] or 0.0), row["other"], row["device"], row["why"])
            for row in csv.DictReader(file)
        )


def row_of(kind: str, case: Case) -> Row | None:
    """Return the row that covers a case, or None."""
    return next((row for row in written() if row.covers(kind, case)), None)
