"""The plan: the steps of a recipe before anything moves. Data only.

A plan is a flat tuple of frozen steps. Five readers use this structure: they describe, estimate, check against a rig,
execute and resume a plan. Repeats and bursts are counts in a condition and no nodes of their own, so a plan of 100,000
conditions stays small.

Units are in the names: _m_s, _n, _mm, _c (temperature in degC), _k (temperature difference in K), _s, _deg.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields
from typing import ClassVar

from tester.analysis.schemes import Scheme, scheme_of
from tester.analysis.stability import Window
from tester.base.axes import Axes, Setpoint, condition_words


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a plan. A kind has its own beside ``ConditionStep`` and ``PromptStep``. ``index``: place, from 0."""

    kind: ClassVar[str] = ""
    """Sort of the step, in a word: steps of one kind take similar times relative to their estimates."""
    contact: ClassVar[bool] = False
    """Whether rubber is in contact for most of it: then samples are recorded at the full rate."""
    index: int

    @property
    def title(self) -> str:
        """Return a one-line description of the step, for people."""
        return self.kind


def fields_of(step: Step) -> dict[str, object]:
    """Return the values of a step by the names of its fields, without its place."""
    return {each.name: getattr(step, each.name) for each in fields(step) if each.name != "index"}


@dataclass(frozen=True, slots=True)
class Specimen:
    """One compound to be tested; every replicate of it starts on new rubber. ``index`` counts from 1."""

    index: int
    compound: str
    note: str = ""
    checks: str = ""
    """What a person checks when it is put on."""
    hardness: bool = False
    """Whether a person reads its hardness when it is put on."""

    @property
    def words(self) -> str:
        """Note and checks, for the question."""
        return "; ".join(text for text in (self.note, f"check: {self.checks}" if self.checks else "") if text)


@dataclass(frozen=True, slots=True)
class Soak:
    """Criterion of a reached temperature: within ``within_k`` for ``for_s``; at most ``at_most_s``."""

    within_k: float
    for_s: float
    at_most_s: float


@dataclass(frozen=True)
class Settings:
    """How a condition is measured: ``repeats`` values that count, each a window or more.

    Every condition of a grid has the same; a kind's subclass adds the values of its own sections. At most ``at_most``
    repeats are made: refused ones are replaced, and with ``until_percent`` repeats are added until the condition's
    expanded repeatability (95 %, per cent of the coefficient) is reached.
    """

    repeats: int
    at_most: int
    until_percent: float | None
    min_valid: int
    window: Window
    temperature_band_k: float
    soak: Soak
    both_directions: bool = field(default=False, kw_only=True)
    """Repeats alternate between the requested direction and the reverse; ``repeats``, ``at_most`` and ``min_valid``
    count pairs."""

    @property
    def scheme(self) -> Scheme:
        """Return how its repeats make values."""
        return scheme_of(both_directions=self.both_directions)


@dataclass(frozen=True, slots=True)
class ConditionStep(Settings, Step):
    """Measure one condition.

    ``condition`` counts from 1 through the plan (a replicate's conditions have numbers of their own). ``row`` counts
    from 1 in the recipe's order and is the same for all replicates: its row of the table.
    """

    kind: ClassVar[str] = "condition"
    contact: ClassVar[bool] = True
    condition: int
    row: int
    specimen: int
    replicate: int
    grid: str
    setpoint: Setpoint

    @property
    def title(self) -> str:
        return condition_words(self.setpoint)

    @property
    def repeats_words(self) -> str:
        """Return the number of repeats that must count, and the precision if the recipe has one: 4 (until 2 %).

        In both directions they are pairs: 4 pairs.
        """
        until = f" (until {self.until_percent:.3g} %)" if self.until_percent is not None else ""
        return f"{self.repeats}{' pairs' if self.both_directions else ''}{until}"


@dataclass(frozen=True, slots=True)
class PromptStep(Step):
    """A task for a person, who acknowledges it; ``text`` is shown unchanged."""

    kind: ClassVar[str] = "prompt"
    text: str

    @property
    def title(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Plan:
    """A whole recipe as steps. A kind's subclass adds the data that its procedures need beside the steps."""

    name: str
    steps: tuple[Step, ...]
    specimens: tuple[Specimen, ...]
    min_valid: int
    metadata: Mapping[str, str] = field(default_factory=dict[str, str])
    kind: str = ""
    """Kind of its rig."""
    axes: Axes | None = None
    """Axes of its conditions; None for a plan that can have none."""

    def conditions(self) -> Iterator[ConditionStep]:
        """Yield the condition steps in the order of measurement."""
        for step in self.steps:
            if isinstance(step, ConditionStep):
                yield step

    def specimen(self, index: int) -> Specimen:
        """Return the specimen that a step names (``index`` from 1); raises IndexError."""
        if not 1 <= index <= len(self.specimens):
            raise IndexError(f"the plan has no specimen {index}")
        return self.specimens[index - 1]


@dataclass(frozen=True, slots=True)
class Mounted:
    """A piece mounted before the interruption. Diameter in mm (NaN: it has none), sliding distance in m."""

    number: int
    """Number among all mounted pieces, from 1."""
    specimen: int
    replicate: int
    diameter_mm: float
    sliding_m: float
    ground: bool
    """Whether it was prepared completely: ground in, or run in."""
    last_condition: int = 0
    """The last condition of its use; 0: none yet."""


@dataclass(frozen=True, slots=True)
class Stand:
    """Progress of a plan: conditions by their numbers, pieces in the order of mounting."""

    ended: frozenset[int] = frozenset()
    begun: frozenset[int] = frozenset()
    """Conditions with a repeat begun, ended ones included."""
    mounted: tuple[Mounted, ...] = ()
    travels_m: Mapping[str, float] = field(default_factory=dict[str, float])
    """Travel of each counterface under load, by the name of the surface; "" is a run's only one."""
