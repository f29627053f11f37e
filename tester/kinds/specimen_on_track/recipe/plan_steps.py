"""Steps of this machine: specimens put on, surface, weights and interface changed, air tempered, conditions slid.

Units are in the names: _m, _m_s, _n, _c (temperature in degC), _k (temperature difference in K), _s.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from tester.inputs.recipe.plain_recipe import Mount
from tester.inputs.recipe.plan import ConditionStep, Settings, Step
from tester.inputs.recipe.surface_turns import ChangeSurface

STRETCHES: Final = 10
"""Number of parts of a condition's way whose mean frictions are compared [A]."""
INSERTED: Final = -1
"""Index of a step that is not in the plan."""


@dataclass(frozen=True, slots=True)
class MountSpecimen(Mount):
    """A person puts a specimen on the arm.

    ``again``: an interruption left the specimen mounted; it has slid ``sliding_m``.
    """

    kind: ClassVar[str] = "install"
    again: bool = False
    sliding_m: float = 0.0

    @property
    def title(self) -> str:
        return f"install specimen {self.piece} ({self.compound})"


@dataclass(frozen=True, slots=True)
class Cover(ChangeSurface):
    """A person covers the track with another surface, clean and dry."""

    @property
    def title(self) -> str:
        return f"cover the track with {self.surface}"


@dataclass(frozen=True, slots=True)
class Prepare(Step):
    """A person hangs weights on the arm and makes the track dry, wet or powdered; ``text`` asks for the changes."""

    kind: ClassVar[str] = "prepare"
    load_n: float
    interface: str
    text: str

    @property
    def title(self) -> str:
        return f"prepare {self.load_n:g} N, {self.interface}"


@dataclass(frozen=True, slots=True)
class Temper(Step):
    """Wait until the air is within ``within_k`` of a temperature for ``for_s``, at most ``at_most_s``."""

    kind: ClassVar[str] = "temper"
    temperature_c: float
    within_k: float
    for_s: float
    at_most_s: float

    @property
    def title(self) -> str:
        return f"temper to {self.temperature_c:g} degC"


@dataclass(frozen=True, slots=True)
class Open(Temper):
    """Bring the chamber's air near the room's, so that a person can open it."""

    kind: ClassVar[str] = "open"


@dataclass(frozen=True)
class TrackSettings(Settings):
    """Settings of a condition: its way, or the longer way that ``at_least_s`` takes at its speed.

    ``least_mu``: the least coefficient expected; 0: none is stated.
    """

    distance_m: float
    at_least_s: float
    least_mu: float

    def way_m(self, speed_m_s: float) -> float:
        """Return the way, at a speed, over which friction must be stationary."""
        return max(self.distance_m, self.at_least_s * speed_m_s)


@dataclass(frozen=True, slots=True)
class TrackCondition(TrackSettings, ConditionStep):
    """A condition: stationary friction is collected over its way, half as much again in each repeat."""
