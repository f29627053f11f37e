"""A kind's contribution to master curves: conditions with speed and temperature, and those that heat themselves."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from tester.analysis.master_curve.points import MasterRun


class MasterPart(Protocol):
    """A kind's contribution to master curves."""

    def run(self, folder: Path) -> MasterRun:
        """Return the conditions of a run; raises StoreError where it cannot be read."""
        ...

    def packaged(self, name: str) -> MasterRun:
        """Return conditions that ship with the program; raises KeyError."""
        ...
