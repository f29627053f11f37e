"""Recipes of a plain machine: a grid of its axes, one step for each condition, each specimen mounted once.

A kind defines how fast a condition slides, and how many blocks it makes in a second; the rest of a recipe follows.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import count, product
from typing import ClassVar

from tester.analysis.stability import REPEAT_WINDOWS
from tester.base.axes import AxisValue, Setpoint
from tester.base.source import Problem, Tree
from tester.base.units import show
from tester.inputs.recipe.axis_lists import readable
from tester.inputs.recipe.conditions import Condition, conditions_of, metadata_of, ordered
from tester.inputs.recipe.plan import ConditionStep, Plan, Settings, Stand, Step
from tester.inputs.recipe.recipe_part import RecipePart
from tester.inputs.recipe.recipe_schema import Recipe
from tester.inputs.recipe.repeats_section import expected
from tester.inputs.recipe.specimen_section import specimens_of
from tester.inputs.recipe.time_estimate import Estimator, StepEstimate
from tester.inputs.rig import Rig
from tester.inputs.rig.rig_keys import value_at


@dataclass(frozen=True, slots=True)
class Mount(Step):
    """A person puts a specimen on. ``piece`` counts from 1 in the plan, ``replicate`` from 1 in a specimen.

    ``hardness``: the person reads its hardness, too.
    """

    kind: ClassVar[str] = "mount"
    specimen: int
    replicate: int
    piece: int
    compound: str
    note: str = ""
    hardness: bool = field(default=False, kw_only=True)

    @property
    def title(self) -> str:
        return f"put on specimen {self.specimen}: {self.compound}" + (f" ({self.note})" if self.note else "")


class PlainEstimator(Estimator):
    """Durations of the steps of a plain machine."""

    def __init__(self, part: PlainPart, rig: Rig, repeatability: Mapping[str, float] | None = None) -> None:
        """``part``: of the rig's kind; ``repeatability``: as in every estimator."""
        super().__init__(repeatability)
        self.part = part
        self.person_s = 0.0 if rig.simulated else part.person_s

    def walk(self, plan: Plan) -> list[StepEstimate]:
        return [
            self._condition(step) if isinstance(step, ConditionStep) else StepEstimate(self.person_s)
            for step in plan.steps
        ]

    def _condition(self, step: ConditionStep) -> StepEstimate:
        repeats = expected(step, self.s_percent(step.setpoint.compound))
        blocks_per_s, m_per_s = self.part.pace(step.setpoint)
        contact_s = REPEAT_WINDOWS * step.window.duration_s(blocks_per_s) + self.part.settle_s
        return StepEstimate(
            repeats * (contact_s + self.part.between_s), repeats * contact_s * m_per_s, bursts=1, repeats=repeats
        )

    def shut_down_s(self, plan: Plan) -> float:
        return self.part.between_s


class SpecimenPart(RecipePart):
    """The part of a kind that mounts one specimen after the other, each for all of its conditions.

    Conditions come in blocks of one value of the axis ``blocks`` (``Axes``). A kind adds its steps between them.
    """

    condition: ClassVar[type[ConditionStep]] = ConditionStep
    """The class of its condition steps."""
    mount: ClassVar[type[Mount]] = Mount
    """The class of the steps that put a specimen on."""

    def in_turns(self, conditions: Sequence[Condition[Settings]]) -> Sequence[Sequence[Condition[Settings]]]:
        """Return the conditions of a specimen in the parts that it goes through one after the other."""
        return (conditions,)

    def before_turn(self, index: int, values: tuple[AxisValue, ...], settings: Settings, rig: Rig) -> Sequence[Step]:
        """Return the steps before such a part, from ``index`` on; ``values``: of its first condition."""
        return ()

    def before_block(self, index: int, value: float, settings: Settings) -> Sequence[Step]:
        """Return the steps before a block of conditions with this value of the axis ``blocks``, from ``index`` on."""
        return ()

    def before_condition(self, index: int, setpoint: Setpoint, before: Setpoint | None) -> Sequence[Step]:
        """Return the steps before a condition, from ``index`` on; ``before``: the one before it on this specimen."""
        return ()

    def expand(self, recipe: Recipe, rig: Rig, estimator: object = None) -> Plan:
        """Return the plan: each replicate of a specimen is mounted and goes through its conditions."""
        conditions = conditions_of(recipe, self.settings)
        turns = self.in_turns(conditions) if conditions else ()
        block_value = self.axes.number_of(self.axes.blocks)
        specimens = specimens_of(recipe)
        steps: list[Step] = []
        numbers = count(1)
        pieces = product(specimens, range(1, recipe.replicates + 1))
        for piece, (specimen, replicate) in enumerate(pieces, start=1):
            mount = self.mount(len(steps), specimen.index, replicate, piece, specimen.compound, specimen.words)
            steps.append(replace(mount, hardness=specimen.hardness))
            before: Setpoint | None = None
            for turn in turns:
                steps += self.before_turn(len(steps), turn[0].values, turn[0].settings, rig)
                for block in ordered(turn, block_value, recipe.order, specimen.index, replicate):
                    steps += self.before_block(len(steps), block_value(block[0].values), block[0].settings)
                    for values, row, grid, how in block:
                        setpoint = Setpoint(specimen.compound, values, self.axes)
                        steps += self.before_condition(len(steps), setpoint, before)
                        before = setpoint
                        steps.append(self.condition(
                            index=len(steps), condition=next(numbers),
                            row=(specimen.index - 1) * len(conditions) + row,
                            specimen=specimen.index, replicate=replicate, grid=grid, setpoint=setpoint, **vars(how),
                        ))  # fmt: skip
        least = min((condition.settings.min_valid for condition in conditions), default=1)
        return Plan(recipe.recipe, tuple(steps), specimens, least, metadata_of(recipe), recipe.kind, self.axes)


class PlainPart(SpecimenPart):
    """A plain machine's part of the recipe reader. A kind sets ``kind`` and ``axes`` and defines its ``pace``.

    An axis with a ``limit`` is checked against the key of that name in the rig file, in the axis's ``recipe_unit``.
    """

    settle_s: ClassVar[float] = 2.0
    """Time at a condition before its samples count, s [A]."""
    between_s: ClassVar[float] = 2.0
    """Time from one repeat to the next: standstill and commit, s [A]."""
    person_s: ClassVar[float] = 300.0
    """Time that a person takes to mount a specimen, s [A]."""

    @abstractmethod
    def pace(self, setpoint: Setpoint) -> tuple[float, float]:
        """Return how many blocks (``Roles.block``) a condition makes in a second, and how many metres it slides."""

    def estimator(self, rig: Rig, repeatability: Mapping[str, float] | None = None) -> PlainEstimator:
        return PlainEstimator(self, rig, repeatability)

    def limits(self, tree: Tree, rig: Rig) -> Iterator[Problem]:
        top = tree.data if isinstance(tree.data, dict) else {}
        grids = top.get("grids")
        for index, grid in enumerate(grids if isinstance(grids, list) else []):
            for axis in (axis for axis in self.axes if axis.limit):
                listed = grid.get(axis.name) if isinstance(grid, dict) else None
                most = value_at(rig, tuple(axis.limit.split("."))) if listed is not None else None
                for asked, place in readable(listed, ("grids", index, axis.name), axis.recipe_unit):
                    if isinstance(most, int | float) and abs(asked) > most:
                        source = f'(limit {show(most, axis.recipe_unit)}: {axis.limit} of rig "{rig.name}")'
                        problem = f"{axis.name}: {show(asked, axis.recipe_unit)} is more than the rig allows {source}"
                        yield tree.problem(place, problem)

    def remaining(self, plan: Plan, stand: Stand) -> Plan:
        steps: list[Step] = []
        mount: Mount | None = None
        last = max((mounted.number for mounted in stand.mounted), default=0)
        for step in plan.steps:
            if isinstance(step, Mount):
                mount = step
            elif not isinstance(step, ConditionStep) or step.condition not in stand.ended:
                if mount is not None:
                    last += 1
                    steps.append(replace(mount, index=len(steps), piece=last))
                    mount = None
                steps.append(step)
        return replace(plan, steps=tuple(steps))

    def words(self, step: Step, one: StepEstimate) -> str:
        if isinstance(step, ConditionStep):
            return f"{step.title}: {step.repeats_words} x {step.window.words}"
        return step.title

    def heading(self, plan: Plan, step: Step) -> str:
        return f"specimen {step.specimen}, replicate {step.replicate}" if isinstance(step, Mount) else ""
