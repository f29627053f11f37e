"""Reads the state log of `tester sim` while it is being written."""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Row:
    """The rig at one moment; ``clock_s`` is the machine's monotonic clock."""

    time_s: float
    clock_s: float
    controlled: float
    wheel_m_s: float
    belt_m_s: float
    slip_m_s: float
    force_z_n: float
    press_mm: float
    heater_w: float
    hub_c: float
    surface_c: float


class StateReader:
    """Yields the rows written since the last read."""

    def __init__(self, path: Path) -> None:
        """Begin at the start of the file."""
        self.rows: list[Row] = []
        self._path = path
        self._at = 0
        self._columns: list[str] = []

    def fresh(self) -> list[Row]:
        """Return the rows that are complete by now and were not returned before; ``rows`` keeps all."""
        with self._path.open("rb") as file:
            file.seek(self._at)
            whole, newline, _ = file.read().rpartition(b"\n")
        self._at += len(whole) + len(newline)
        found: list[Row] = []
        for cells in csv.reader(whole.decode("utf-8").splitlines()):
            if not self._columns:
                self._columns = cells
            else:
                found.append(Row(**dict(zip(self._columns, map(float, cells), strict=True))))
        self.rows += found
        return found


def since(rows: Sequence[Row], clock_s: float) -> list[Row]:
    """Return the rows from a moment on."""
    return [row for row in rows if row.clock_s >= clock_s]


def for_good(rows: Sequence[Row], so: Callable[[Row], bool]) -> float:
    """Return from when on (clock, s) something holds in every row to the end; infinity if not in the last one."""
    found = inf
    for row in reversed(rows):
        if not so(row):
            break
        found = row.clock_s
    return found
