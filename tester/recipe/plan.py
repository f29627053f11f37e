"""The plan: what a recipe becomes before anything moves. Data only.

A plan is a flat tuple of frozen steps. Describing it, estimating it, checking it against a rig, executing it
and resuming it are five readers of this one structure. Repeats and bursts are counts in a condition and no
nodes of their own, so a plan of 100,000 conditions stays small.

Units are in the names: _m_s, _n, _mm, _c (temperature in degC), _k (temperature difference in K), _s, _deg.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Literal, NamedTuple, TypeAlias

WearCheck: TypeAlias = Literal["never", "each_condition", "prompt"]
"""Diameter check after a condition: not at all, by rolling at zero slip, or measured by a person."""


@dataclass(frozen=True, slots=True)
class Specimen:
    """One compound to be tested; every replicate of it starts on a new wheel. ``index`` counts from 1."""

    index: int
    compound: str
    note: str = ""


class Setpoint(NamedTuple):
    """What is held during a condition. Speeds m/s, load N, angles degrees, surface temperature degC.

    A tuple: plans have tens of thousands of them and look conditions up by setpoint.
    ``slip_velocity_m_s`` is wheel speed minus belt speed at sideslip 0; negative is braking.
    """

    compound: str
    slip_velocity_m_s: float
    load_n: float
    sideslip_deg: float
    camber_deg: float
    temperature_c: float
    wheel_speed_m_s: float

    @property
    def belt_speed_m_s(self) -> float:
        """Return the belt speed in m/s: wheel speed less slip velocity."""
        # Rounded to 1 nm/s: 0.8 - 0.3 is to be 0.5 in every output, not 0.5000000000000001.
        return round(self.wheel_speed_m_s - self.slip_velocity_m_s, 9)


@dataclass(frozen=True, slots=True)
class Window:
    """How much a repeat collects: wheel revolutions or seconds, exactly one of the two is not None.

    Drift is per window; a repeat collects 1.5 of them. ``extend_to`` (same unit, at least the window): the most that it
    collects, its transient included, and where it is judged alone.
    """

    revolutions: float | None
    seconds: float | None
    extend_to: float

    def duration_s(self, revolutions_per_s: float) -> float:
        """Return the seconds in which the window is collected at a wheel speed in revolutions/s (> 0)."""
        if self.seconds is not None:
            return self.seconds
        return (self.revolutions or 0.0) / revolutions_per_s


@dataclass(frozen=True, slots=True)
class Soak:
    """When a temperature counts as reached: within ``within_k`` for ``for_s``; at most ``at_most_s``."""

    within_k: float
    for_s: float
    at_most_s: float


@dataclass(frozen=True, slots=True)
class WornState:
    """What a wheel that goes on after an interruption was like: diameter in mm, sliding distance in m."""

    diameter_mm: float
    sliding_m: float


@dataclass(frozen=True, slots=True)
class Install:
    """A person mounts a wheel. ``wheel`` counts from 1 in the plan, ``replicate`` from 1 in a specimen.

    ``worn``: the wheel is still on, as an interruption left it; None for a new one.
    """

    kind: ClassVar[Literal["install"]] = "install"
    index: int
    specimen: int
    wheel: int
    compound: str
    note: str = ""
    replicate: int = 1
    worn: WornState | None = None


@dataclass(frozen=True, slots=True)
class PreGrind:
    """Grind a new wheel: line speeds m/s, load N, seconds with load in band and both speeds reached."""

    kind: ClassVar[Literal["pre_grind"]] = "pre_grind"
    index: int
    wheel_speed_m_s: float
    belt_speed_m_s: float
    load_n: float
    duration_s: float


@dataclass(frozen=True, slots=True)
class Rest:
    """Stand lifted for ``at_least_s`` and until the surface is within ``within_k`` of ``until_c``.

    ``until_c`` None: only the time counts. Past ``at_most_s`` it is a prompt on hardware, "not reached"
    otherwise.
    """

    kind: ClassVar[Literal["rest"]] = "rest"
    index: int
    at_least_s: float
    until_c: float | None
    within_k: float
    at_most_s: float


@dataclass(frozen=True, slots=True)
class Heat:
    """Bring the surface to a temperature (degC) before the conditions at it; they soak on their own."""

    kind: ClassVar[Literal["heat"]] = "heat"
    index: int
    temperature_c: float


@dataclass(frozen=True, slots=True)
class ConditionStep:
    """Measure one condition: ``repeats`` values that count, each collected in up to ``max_bursts`` contacts.

    Up to ``at_most`` repeats are made: what is refused is made up for, and with ``until_percent`` the condition goes on
    until its expanded repeatability (95 %, per cent of the coefficient) is reached.

    ``condition`` counts from 1 through the plan (a replicate's conditions have numbers of their own).
    ``row`` counts from 1 in the recipe's order and is the same for all replicates: its row of the table.
    """

    kind: ClassVar[Literal["condition"]] = "condition"
    index: int
    condition: int
    row: int
    specimen: int
    replicate: int
    wheel: int
    grid: str
    setpoint: Setpoint
    repeats: int
    min_valid: int
    window: Window
    temperature_band_k: float
    soak: Soak
    max_bursts: int
    wear_check: WearCheck
    at_most: int
    until_percent: float | None = None


@dataclass(frozen=True, slots=True)
class Cool:
    """Turn unloaded, without heat, until the hub is below ``hub_below_c`` [A]: safe to touch."""

    kind: ClassVar[Literal["cool"]] = "cool"
    index: int
    hub_below_c: float = 45.0


@dataclass(frozen=True, slots=True)
class Prompt:
    """Something a person does and acknowledges; ``text`` is shown as it is."""

    kind: ClassVar[Literal["prompt"]] = "prompt"
    index: int
    text: str


Step: TypeAlias = Install | PreGrind | Rest | Heat | ConditionStep | Cool | Prompt


@dataclass(frozen=True, slots=True)
class WheelWear:
    """What a wheel is predicted to lose in the plan: loss of diameter in mm, sliding distance in m."""

    wheel: int
    specimen: int
    replicate: int
    conditions: int
    loss_mm: float
    sliding_m: float


@dataclass(frozen=True, slots=True)
class PreparePolicy:
    """What a new wheel goes through before it measures; None where the recipe leaves a step out.

    ``person_steps`` are prompts after every installation, in the recipe's order. ``ready_c`` and
    ``ready_within_k``: the surface is this near to ambient before pre-grinding.
    """

    pre_grind: PreGrind | None = None
    rest: Rest | None = None
    person_steps: tuple[str, ...] = ()
    ready_c: float = 25.0
    ready_within_k: float = 5.0


@dataclass(frozen=True, slots=True)
class Plan:
    """A whole recipe as steps. ``replace_after_mm``: loss of diameter after which a wheel is replaced."""

    name: str
    steps: tuple[Step, ...]
    specimens: tuple[Specimen, ...]
    wear: tuple[WheelWear, ...]
    replace_after_mm: float
    min_valid: int
    prepare: PreparePolicy = field(default_factory=PreparePolicy)
    metadata: Mapping[str, str] = field(default_factory=dict[str, str])

    def conditions(self) -> Iterator[ConditionStep]:
        """Yield the condition steps in the order in which they are measured."""
        for step in self.steps:
            if isinstance(step, ConditionStep):
                yield step

    def specimen(self, index: int) -> Specimen:
        """Return the specimen that a step names (``index`` from 1); raises IndexError."""
        if not 1 <= index <= len(self.specimens):
            raise IndexError(f"the plan has no specimen {index}")
        return self.specimens[index - 1]
