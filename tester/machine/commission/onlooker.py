"""Onlooker of a commissioning: a screen that shows the growing record and the rig's readings."""

from __future__ import annotations

from typing import Protocol

from tester.machine.commission.record import RecordEntry
from tester.machine.commission.step import CommissionStep, Walk


class Onlooker(Protocol):
    """Called in the engine's thread, between ticks: must not block, and changes nothing."""

    def entered(self, entry: RecordEntry) -> None:
        """Take an entry that was just recorded."""
        ...

    def look(self, step: CommissionStep, walk: Walk) -> None:
        """Look at the rig in a step; called about every tester.machine.tickers.POLL_S of wall time."""
        ...
