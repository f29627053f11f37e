"""The slip rings of stored runs, for the screen. Reading them is slow enough to need a thread."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from tester.analysis.ring_errors import RingRun, RingSector, ages_of
from tester.run.kind_lookup import RingFound, of_one_rig, ring_in
from tester.store.record_schema import StoreError
from tester.store.run_folders import run_folders, under_way

MOST: Final = 200
"""Greatest number of runs read; the newest are read."""


@dataclass(frozen=True, slots=True)
class RingRow:
    """A run: the turns of the ring up to its end, and the sectors in which its errors are concentrated."""

    run: RingRun
    age: float
    sectors: tuple[RingSector, ...]


@dataclass(slots=True)
class KeptRings:
    """The runs of one rig: the rig of the newest run."""

    since: str = ""
    """The run from which the ring counts as new; "" = the first."""
    counted: str = ""
    turns: str = ""
    _found: dict[str, RingFound] = field(default_factory=dict[str, RingFound])
    _rows: list[RingRow] = field(default_factory=list[RingRow])

    def read(self, runs: Path) -> KeptRings:
        """Read new runs, skipping unreadable ones, and return this object; raises OSError."""
        known: dict[str, RingFound] = {}
        for folder in list(run_folders(runs))[-MOST:]:
            ring = self._found.get(folder.name)
            if ring is None and under_way(folder) is None:
                with suppress(StoreError):
                    ring = ring_in(folder)
            if ring is not None:
                known[folder.name] = ring
        self._found = known
        with_any = [ring for ring in known.values() if ring.run.requests]
        if not with_any:
            self._rows, self.counted, self.turns = [], "", ""
            return self
        newest = max(with_any, key=lambda ring: ring.run.started)
        self.counted, self.turns = newest.part.counted, newest.part.turns
        old = {row.run.name: row for row in self._rows}
        self._rows = [
            old.get(ring.run.name) or RingRow(ring.run, 0.0, tuple(ring.run.sectors()))
            for ring in of_one_rig(with_any, newest)
        ]
        return self

    def rows(self) -> list[RingRow]:
        """Return the runs from ``since`` on, oldest first, each with the ring's age."""
        names = [row.run.name for row in self._rows]
        shown = self._rows[names.index(self.since) :] if self.since in names else self._rows
        ages = ages_of([row.run for row in shown])
        return [RingRow(row.run, age, row.sectors) for row, age in zip(shown, ages, strict=True)]
