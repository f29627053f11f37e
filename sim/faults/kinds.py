"""What a row of the fault catalogue is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import inf

from sim.faults.scene import Effect


class Expected(Enum):
    """What has to come of it."""

    TRIP = "trips: the run ends latched"
    STOP = "the run ends in a controlled stop"
    HOLD = "holds: lifted, slip to zero"
    RIDE = "the run goes on"
    MAY = "may trip or go on, both safely"
    DEVICES = "the devices stop by themselves"


@dataclass(frozen=True, slots=True)
class FaultKind:
    """One fault: its name, how it is applied, what has to come of it and by when.

    ``make`` gets the value, where the fault has one (``unit`` not None), and ``value`` where none is given.
    ``budget_s`` counts from the onset, or from when the fault can be noticed (``exposure``, each
    machine's own words), to the safe commands.
    ``force_stays`` and ``heat_stays``: the force, or the heat, cannot go by any command (the reason is in ``note``).
    ``lasts_s``: it is over by itself after this time.
    ``slow``: a matter of temperature, watched for two minutes and more.
    ``axis``: of which drive it is, where its exposure asks for that.
    A row that MAY trip has no budget, and a ``note`` that says why nothing is asked of it.
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
        """What it concerns: the first word, but for the devices' and operators' names of two words."""
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
        """Return ``least`` and ``most``, except one that equals ``normal``."""
        return tuple(end for end in (self.least, self.most) if end != self.normal)

    def between(self, end: float, share: float) -> float:
        """Return the magnitude at a share (0 to 1) of the way from ``normal`` to one of ``ends``."""
        return self.normal + share * (end - self.normal)

    def text(self, value: float) -> str:
        """Return the fault as a script has it, without its time."""
        unit = self.kind.unit or ""
        return f"{self.kind.phrase} {value:.6g} {'s' if unit == 'ms' else unit}".rstrip()
