"""The parts of a row of the fault catalogue."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf

from sim.faults.scene import Effect


class Exposure(Enum):
    """The earliest time at which a fault of any machine can be noticed: its budget counts from then on."""

    ALWAYS = "at once, once the run has begun"
    DRIVES = "at once, once every drive is configured"
    CONNECTING = "at the next connection"
    ENABLED = "while the drives are on"
    MOVING = "while something moves"


class Expected(Enum):
    """Required reaction to a fault."""

    TRIP = "trips: the run ends latched"
    STOP = "the run ends in a controlled stop"
    HOLD = "holds: lifted, slip to zero"
    RIDE = "the run goes on"
    MAY = "may trip or go on, both safely"
    DEVICES = "the devices stop by themselves"


@dataclass(frozen=True, slots=True)
class FaultKind:
    """One fault: its name, the way to apply it, the required reaction, and its time limit.

    ``make`` gets the value, if the fault has one (``unit`` not None), or ``value`` if none is given.
    ``budget_s`` counts up to the safe commands, from the onset, or from the time when the fault can be noticed
    (``exposure``: an ``Exposure``, or one of the machine's own).
    ``force_stays``: no command can remove the force (the reason is in ``note``).
    ``lasts_s``: time after which the fault ends by itself.
    ``slow``: a fault of temperature, watched for two minutes and more.
    ``axis``: its drive, if its exposure depends on one.
    A row that MAY trip has no budget, and a ``note`` with the reason why no trip is required.
    """

    phrase: str
    make: Callable[..., Effect]
    exposure: Enum
    reaction: Expected
    budget_s: float = 0.0
    unit: str | None = None
    value: float = 0.0
    lasts_s: float = inf
    slow: bool = False
    force_stays: bool = False
    axis: str = ""
    note: str = ""

    def effect(self, value: float | None = None) -> Effect:
        """Return the fault, ready to begin."""
        if self.unit is None:
            return self.make()
        return self.make(self.value if value is None else value)
