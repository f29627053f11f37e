"""Steps of this machine: specimens put on, weights and interface changed, the air tempered, conditions slid.

Units are in the names: _m, _m_s, _n, _c (temperature in degC), _k (temperature difference in K), _s.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from tester.inputs.recipe.plain_recipe import Mount
from tester.inputs.recipe.plan import ConditionStep, Settings, Step

STRETCHES: Final = 10
"""Parts of a condition's way in which friction is averaged and held against each other [A]."""
INSERTED: Final = -1
"""Place of a step that the plan did not have."""


@dataclass(frozen=True, slots=True)
class MountSpecimen(Mount):
    """A person puts a specimen on the arm.

    ``again``: it is on, as an interruption left it, and has slid ``sliding_m``.
    """

    kind: ClassVar[str] = "install"
    again: bool = False
    sliding_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Prepare(Step):
    """A person hangs weights on the arm and makes the track dry, wet or powdered; ``text`` asks for what changes."""

    kind: ClassVar[str] = "prepare"
    load_n: float
    interface: str
    text: str


@dataclass(frozen=True, slots=True)
class Temper(Step):
    """Wait until the air is within ``within_k`` of a temperature for ``for_s``, at most ``at_most_s``."""

    kind: ClassVar[str] = "temper"
    temperature_c: float
    within_k: float
    for_s: float
    at_most_s: float


@dataclass(frozen=True)
class TrackSettings(Settings):
    """How a condition is measured: over a way, or for as long as ``at_least_s`` takes at its speed."""

    distance_m: float
    at_least_s: float

    def way_m(self, speed_m_s: float) -> float:
        """Return the way over which friction is to be stationary at a speed."""
        return max(self.distance_m, self.at_least_s * speed_m_s)


@dataclass(frozen=True, slots=True)
class TrackCondition(TrackSettings, ConditionStep):
    """A condition: stationary friction is collected over its way, half as much again in each repeat."""
