"""The rings of stored runs as a screen shows them. Reading takes long enough to be done in a thread."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from tester.analysis.ring_errors import RingSector
from tester.analysis.ring_runs import RingRun, ages_of
from tester.run.kinds import RingFound, of_one_rig, ring_in
from tester.store.catalogue import run_folders, under_way
from tester.store.schema import StoreError

MOST: Final = 200
"""Runs that are read, the newest."""


@dataclass(frozen=True, slots=True)
class RingRow:
    """A run: the turns of the ring until its end, where its errors gather."""

    run: RingRun
    age: float
    sectors: tuple[RingSector, ...]


@dataclass(slots=True)
class KeptRings:
    """The runs of one rig: the one that ran last."""

    since: str = ""
    """The run from which on the ring counts as new; "" the first."""
    counted: str = ""
    turns: str = ""
    _found: dict[str, RingFound] = field(default_factory=dict[str, RingFound])
    _rows: list[RingRow] = field(default_factory=list[RingRow])

    def read(self, runs: Path) -> None:
        """Read the runs that are not known yet; raises OSError. One that cannot be read is left out."""
        known: dict[str, RingFound] = {}
        for folder in list(run_folders(runs))[-MOST:]:
            found = self._found.get(folder.name)
            if found is None and under_way(folder) is None:
                with suppress(StoreError):
                    found = ring_in(folder)
            if found is not None:
                known[folder.name] = found
        self._found = known
        with_any = [one for one in known.values() if one.run.requests]
        if not with_any:
            self._rows, self.counted, self.turns = [], "", ""
            return
        newest = max(with_any, key=lambda one: one.run.started)
        self.counted, self.turns = newest.part.counted, newest.part.turns
        old = {row.run.name: row for row in self._rows}
        self._rows = [
            old.get(one.run.name) or RingRow(one.run, 0.0, tuple(one.run.sectors()))
            for one in of_one_rig(with_any, newest)
        ]

    def rows(self) -> list[RingRow]:
        """Return the runs from ``since`` on, oldest first, each with the ring's age."""
        names = [row.run.name for row in self._rows]
        shown = self._rows[names.index(self.since) :] if self.since in names else self._rows
        ages = ages_of([row.run for row in shown])
        return [RingRow(row.run, age, row.sectors) for row, age in zip(shown, ages, strict=True)]
