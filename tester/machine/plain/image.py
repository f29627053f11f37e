"""The process image of a plain machine: drives and sensors by their names in the rig file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field

from tester.base.deriving import derivable
from tester.machine.image import NEVER, BaseDemand, BaseReadings, BaseSetpoints


@derivable
class PlainReadings(BaseReadings):
    """Newest values, NaN until read. A kind adds a field for each of its channels and fills them in ``update``."""

    drives: dict[str, float] = field(default_factory=dict[str, float])
    """Actual speed of each drive, in the unit of its axis."""
    drives_at_s: float = NEVER
    """Time stamp of the drive with the oldest data."""
    standing: bool = False
    """Every drive is known to be at rest."""
    sensors: dict[str, Sequence[float]] = field(default_factory=dict[str, Sequence[float]])
    """Values of each of the machine's own sensors, in the order of its profile; NaN where not valid."""
    sensors_at_s: float = NEVER
    """Time stamp of the sensor with the oldest data; ``NEVER`` while one is not valid."""
    slid_m: float = 0.0
    """Sliding distance of the mounted specimen."""


    def drive_stamps_s(self) -> tuple[float, ...]:
        return (self.drives_at_s,)
    def update(self, dt: float) -> None:
        """Derive the kind's channels from ``drives`` and ``sensors``; ``dt``: time since the scan before, s."""


@derivable
class PlainDemand(BaseDemand):
    """The demand of a step on the drives; a drive that is not listed is at rest."""

    speeds: dict[str, float] = field(default_factory=dict[str, float])


@derivable
class PlainSetpoints(BaseSetpoints):
    """The setpoints of every drive."""

    speeds: dict[str, float] = field(default_factory=dict[str, float])
