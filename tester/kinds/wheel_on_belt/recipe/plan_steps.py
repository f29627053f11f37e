"""Steps and plan of this machine: mount, grind, rest, heat, measure in slip pulses, and cool wheels; change belts.

Units are in the names: _m_s, _n, _mm, _c (temperature in degC), _k (temperature difference in K), _s.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Literal, TypeAlias

from tester.inputs.recipe.plan import ConditionStep, Mounted, Plan, PromptStep, Settings, Step
from tester.inputs.recipe.surface_turns import ChangeSurface
from tester.kinds.wheel_on_belt.rig.sections import HAND_C

WearCheck: TypeAlias = Literal["never", "each_condition", "prompt"]
"""Diameter check after a condition: not at all, by rolling at zero slip, or measured by a person."""


@dataclass(frozen=True, slots=True)
class Install(Step):
    """A person mounts a wheel. ``wheel`` counts from 1 in the plan, ``replicate`` from 1 in a specimen.

    ``worn``: the state of a wheel that an interruption left mounted; None for a new wheel. ``again``: an earlier
    wheel is mounted again, with its wear. ``hardness``: the person reads that of a new wheel, too.
    """

    kind: ClassVar[str] = "install"
    specimen: int
    wheel: int
    compound: str
    note: str = ""
    replicate: int = 1
    worn: Mounted | None = None
    again: bool = False
    hardness: bool = False

    @property
    def title(self) -> str:
        return f"{'mount again' if self.again else 'install'} wheel {self.wheel} ({self.compound})"


@dataclass(frozen=True, slots=True)
class ChangeBelt(ChangeSurface):
    """A person puts a belt on that the grids name, clean and without dust. ``again``: a run resumes on it."""

    again: bool = False

    @property
    def title(self) -> str:
        return f"put belt {self.surface} on"


@dataclass(frozen=True, slots=True)
class PreGrind(Step):
    """Grind a new wheel: line speeds m/s, load N, seconds with load in band and both speeds reached."""

    kind: ClassVar[str] = "pre_grind"
    contact: ClassVar[bool] = True
    wheel_speed_m_s: float
    belt_speed_m_s: float
    load_n: float
    duration_s: float

    @property
    def title(self) -> str:
        return f"pre-grind {self.duration_s / 60:g} min at {self.load_n:g} N"


@dataclass(frozen=True, slots=True)
class Rest(Step):
    """Stand lifted for ``at_least_s`` and until the surface is within ``within_k`` of ``until_c``.

    ``until_c`` None: only the time counts. After ``at_most_s`` hardware asks a person; a simulated rig records "not
    reached".
    """

    kind: ClassVar[str] = "rest"
    at_least_s: float
    until_c: float | None
    within_k: float
    at_most_s: float

    @property
    def title(self) -> str:
        return f"rest {self.at_least_s / 60:g} min"


@dataclass(frozen=True, slots=True)
class Heat(Step):
    """Bring the surface to a temperature (degC) before the conditions at it; they soak on their own."""

    kind: ClassVar[str] = "heat"
    contact: ClassVar[bool] = True
    temperature_c: float

    @property
    def title(self) -> str:
        return f"heat to {self.temperature_c:g} degC"


@dataclass(frozen=True)
class WheelSettings(Settings):
    """How a condition on a wheel is measured: each repeat is collected in up to ``max_bursts`` contacts."""

    max_bursts: int
    wear_check: WearCheck
    run_in_m: float
    """Sliding that does not count after a reversal of the slip, m [A]: no data is published on the distance in which
    these compounds reverse their abrasion pattern."""


@dataclass(frozen=True, slots=True)
class WheelCondition(WheelSettings, ConditionStep):
    """A condition on a wheel. ``reference``: the reference condition, which watches the belt."""

    wheel: int
    reference: bool = False


@dataclass(frozen=True, slots=True)
class Cool(Step):
    """Turn unloaded, without heat, until the hub is below ``hub_below_c`` [A] and safe to touch."""

    kind: ClassVar[str] = "cool"
    hub_below_c: float = HAND_C

    @property
    def title(self) -> str:
        return f"cool the hub to {self.hub_below_c:g} degC"


@dataclass(frozen=True, slots=True)
class ToolPrompt(PromptStep):
    """A task at the wheel with a tool that keeps hands off it, at a hub of ``limits.tool_hub`` or less."""


WheelStep: TypeAlias = Install | ChangeBelt | PreGrind | Rest | Heat | WheelCondition | Cool | PromptStep


@dataclass(slots=True)
class WheelWear:
    """Predicted wear of a wheel: loss of diameter in mm, sliding distance in m; it grows as the plan is built."""

    wheel: int
    specimen: int
    replicate: int
    conditions: int
    loss_mm: float
    sliding_m: float


@dataclass(frozen=True, slots=True)
class PreparePolicy:
    """Preparation of a new wheel before it measures; None for a step that the recipe leaves out.

    ``person_steps`` are prompts after every installation, in the recipe's order. ``ready_c`` and
    ``ready_within_k``: the surface's target before pre-grinding, ambient, and its tolerance.
    """

    pre_grind: PreGrind | None = None
    rest: Rest | None = None
    person_steps: tuple[PromptStep, ...] = ()
    ready_c: float = 25.0
    ready_within_k: float = 5.0


@dataclass(frozen=True, slots=True)
class WheelPlan(Plan):
    """A whole recipe for wheels. ``replace_after_mm``: loss of diameter after which a wheel is replaced.

    ``references``: number of reference conditions; they watch one belt through the whole plan.
    """

    steps: tuple[WheelStep, ...]
    wear: tuple[WheelWear, ...] = ()
    replace_after_mm: float = 2.0
    prepare: PreparePolicy = field(default_factory=PreparePolicy)
    references: int = 0

    @classmethod
    def of(cls, plan: Plan) -> WheelPlan:
        """Return a plan as one of this machine's; raises TypeError."""
        if not isinstance(plan, cls):
            raise TypeError(f"{plan.name}: the plan is for a rig of kind {plan.kind}")
        return plan

    def conditions(self) -> Iterator[WheelCondition]:
        """Yield the condition steps in the order in which they are measured."""
        for step in self.steps:
            if isinstance(step, WheelCondition):
                yield step


def starts_of(steps: Sequence[Step], part: Callable[[Install], object]) -> list[int]:
    """Return the start positions of a plan's parts, the first at 0: each part's first Install, with a Cool and a change
    of the belt before it."""
    starts = [0]
    before: object = None
    for position, step in enumerate(steps):
        if isinstance(step, Install):
            if before is not None and part(step) != before:
                starts.append(begin_of(steps, position))
            before = part(step)
    return starts


def begin_of(steps: Sequence[Step], install: int) -> int:
    """Return the position of the first step that belongs to an Install at a position: a Cool, a change of the belt."""
    begin = install
    while begin and isinstance(steps[begin - 1], Cool | ChangeBelt):
        begin -= 1
    return begin
