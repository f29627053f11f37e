"""The parts of a row of the fault catalogue."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf

from sim.faults.scene import Effect


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
    (``exposure``, in each machine's own words).
    ``force_stays`` and ``heat_stays``: no command can remove the force, or the heat (the reason is in ``note``).
    ``lasts_s``: time after which the fault ends by itself.
    ``slow``: a fault of temperature, watched for two minutes and more.
    ``axis``: its drive, if its exposure depends on one.
    A row that MAY trip has no budget, and a ``note`` with the reason why no trip is required.
    """

    phrase: str
    make: Callable[..., Effect]
    exposure: Enum
    reaction: Expected
    budget_s: float
    unit: str | None = None
    value: float = 0.0
    lasts_s: float = inf
    slow: bool = False
    force_stays: bool = False
    heat_stays: bool = False
    axis: str = ""
    note: str = ""

    def effect(self, value: float | None = None) -> Effect:
        """Return the fault, ready to begin."""
        if self.unit is None:
            return self.make()
        return self.make(self.value if value is None else value)

    @property
    def group(self) -> str:
        """Subject of the fault: the first word of its phrase, even where a name has two words."""
        return self.phrase.split()[0]


@dataclass(frozen=True, slots=True)
class Parametric:
    """A fault whose magnitude lies between ``least`` and ``most`` (the kind's unit); ``normal`` is no fault."""

    kind: FaultKind
    least: float
    most: float
    normal: float = 0.0

    def __post_init__(self) -> None:
        """Raise ValueError unless least <= normal <= most leaves something to search, and the kind takes a value."""
        if not self.least <= self.normal <= self.most or self.least == self.most or self.kind.unit is None:
            raise ValueError(f"{self.kind.phrase}: {self.least:g} to {self.most:g} around {self.normal:g}")

    @property
    def ends(self) -> tuple[float, ...]:
        """Return ``least`` and ``most``, except an end that equals ``normal``."""
        return tuple(end for end in (self.least, self.most) if end != self.normal)

    def between(self, end: float, share: float) -> float:
        """Return the magnitude at a share (0 to 1) of the way from ``normal`` to one of ``ends``."""
        return self.normal + share * (end - self.normal)

    def text(self, value: float) -> str:
        """Return the fault as in a script, without its time."""
        unit = self.kind.unit or ""
        return f"{self.kind.phrase} {value:.6g} {'s' if unit == 'ms' else unit}".rstrip()
