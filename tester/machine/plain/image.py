"""The process image of a plain machine: drives and sensors by their names in the rig file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tester.machine.image import NEVER, BaseDemand, BaseReadings, BaseSetpoints


@dataclass(slots=True)
class PlainReadings(BaseReadings):
    """Newest values, NaN until read. A kind adds a field for each of its channels and fills them in ``update``."""

    drives: dict[str, float] = field(default_factory=dict[str, float])
    """Actual speed of each drive, in the unit of its axis."""
    drives_at_s: float = NEVER
    """When the drive was heard that was heard of least lately."""
    standing: bool = False
    """Every drive is known to stand."""
    sensors: dict[str, Sequence[float]] = field(default_factory=dict[str, Sequence[float]])
    """What each of the machine's own sensors measures, in the order of its profile; NaN where it is not valid."""
    sensors_at_s: float = NEVER
    """When the sensor answered that answered least lately; ``NEVER`` where one says that it is not valid."""
    slid_m: float = 0.0
    """How far the specimen that is on has slid."""

    def update(self, dt: float) -> None:
        """Work out the kind's channels from ``drives`` and ``sensors``; ``dt``: since the scan before, s."""


@dataclass(slots=True)
class PlainDemand(BaseDemand):
    """What a step wants of the drives; one that is not named stands."""

    speeds: dict[str, float] = field(default_factory=dict[str, float])


@dataclass(slots=True)
class PlainSetpoints(BaseSetpoints):
    """What every drive is told."""

    speeds: dict[str, float] = field(default_factory=dict[str, float])
