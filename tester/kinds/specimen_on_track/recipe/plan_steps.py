"""Steps of this machine: specimens put on, weights and interface changed, the air tempered, conditions slid.

Units are in the names: _m, _m_s, _n, _c (temperature in degC), _k (temperature difference in K), _s.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from tester.inputs.recipe.plain_recipe import Mount
from tester.inputs.recipe.plan import ConditionStep, Step

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


@dataclass(frozen=True, slots=True)
class TrackCondition(ConditionStep):
    """A condition: stationary friction is collected over ``distance_m``, half as much again in each repeat."""

    distance_m: float
