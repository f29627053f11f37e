"""Stores a run's statistics of the skew between the transmitters of its load cell."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.joined_cell import JoinedCell
from tester.store.recorder import Recorder


@dataclass(frozen=True, slots=True)
class CellSkew:
    """Stored with the counters of the buses when a run, or a part of one, ends."""

    cell: JoinedCell

    def store(self, recorder: Recorder, now_s: float) -> None:
        """Store the greatest skew of a whole reading (ms), and how often parts lay too far apart for one."""
        cell = self.cell
        recorder.bus_statistic(now_s, "load cell", "", "greatest skew ms", 1e3 * cell.greatest_skew_s)
        recorder.bus_statistic(now_s, "load cell", "", "parts too far apart", cell.apart)
