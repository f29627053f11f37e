"""Expansion of a recipe into a plan: ordered conditions (tester.inputs.recipe.conditions), each with its wheel.

Wheels are changed only between conditions: before a condition with more predicted wear than is left, and at a change
of temperature if that needs no further wheel. Each replicate goes through its belts one after the other
(``tester.inputs.recipe.surface_turns``); where belt and wheel change together, the wheel is ground in on the new belt.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import accumulate
from typing import TYPE_CHECKING

from tester.base.axes import Setpoint
from tester.inputs.recipe.conditions import BlockValue, Condition, conditions_of, metadata_of, ordered
from tester.inputs.recipe.plan import PromptStep, Specimen
from tester.inputs.recipe.specimen_section import specimens_of
from tester.inputs.recipe.surface_turns import in_turns, surface_among
from tester.inputs.recipe.time_estimate import StepEstimate
from tester.kinds.wheel_on_belt.recipe.estimate import WheelEstimator
from tester.kinds.wheel_on_belt.recipe.plan_steps import (
    ChangeBelt,
    Cool,
    Heat,
    PreGrind,
    PreparePolicy,
    Rest,
    ToolPrompt,
    WheelCondition,
    WheelPlan,
    WheelStep,
    WheelWear,
)
from tester.kinds.wheel_on_belt.recipe.references import ReferenceRounds, ReservedWheel
from tester.kinds.wheel_on_belt.recipe.schema import WheelRecipe, WheelSettings, wheel_settings
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED, mount_again, prepare_wheel

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig import RigConfig


def expand(recipe: WheelRecipe, rig: RigConfig, estimator: WheelEstimator | None = None) -> WheelPlan:
    """Return the plan of a valid recipe on a rig (its wear rate and geometry decide the wheel changes).

    ``estimator``: for this rig, if the caller also estimates the plan; it caches every condition.
    """
    return _Expansion(recipe, rig, estimator or WheelEstimator(rig)).plan()


def change_points(losses: Sequence[Sequence[float]], first_mm: float, limit_mm: float) -> list[set[int]]:
    """Return the positions of wheel changes in every block; the new wheel is mounted before that condition.

    ``losses``: predicted loss of diameter (mm) of the conditions, block by block; ``first_mm``: loss in a wheel's
    preparation; ``limit_mm``: loss after which a wheel is replaced. A wheel always takes at least one condition.
    """
    sums = [0.0, *accumulate(loss for block in losses for loss in block)]
    fresh = limit_mm - first_mm
    room, used, start = fresh, False, 0
    changes: list[set[int]] = []
    for block in losses:
        points: set[int] = set()
        fits = sums[start + len(block)] - sums[start] <= room
        # The block does not fit: change at its start if that needs no more wheels in total.
        if used and not fits and _changes(sums, start, fresh, fresh) < _changes(sums, start, room, fresh):
            points.add(0)
            room, used = fresh, False
        for position, loss in enumerate(block):
            if used and loss > room:
                points.add(position)
                room = fresh
            room -= loss
            used = True
        changes.append(points)
        start += len(block)
    return changes


def _changes(sums: list[float], start: int, room: float, fresh: float) -> int:
    """Return the number of wheel changes from condition ``start`` on if each wheel is used up; ``room``: mm left."""
    changes = 0
    while True:
        reached = bisect_right(sums, sums[start] + room, lo=start) - 1
        if reached >= len(sums) - 1:
            return changes
        if reached == start and room >= fresh:
            reached += 1  # a new wheel takes at least one condition
        start, room = reached, fresh
        changes += 1


class _Expansion:
    """Builds the steps of one plan."""

    def __init__(self, recipe: WheelRecipe, rig: RigConfig, estimator: WheelEstimator) -> None:
        self.recipe = recipe
        self.held: BlockValue = recipe.axes.number_of(recipe.axes.blocks)
        self.estimator = estimator
        self.prepare = _prepare(recipe, rig)
        self.conditions = conditions_of(recipe, wheel_settings)
        self.references = ReferenceRounds(recipe, rig.ambient_c, len(self.conditions))
        self.steps: list[WheelStep] = []
        self.wheels: list[WheelWear] = []
        self.count = 0
        self.at_c: float | None = None
        """Surface temperature of the mounted wheel after the last steps; None for a new wheel."""
        self.belt_among = surface_among(recipe.axes)
        self.belt = ""
        """The belt that the grids name and that is on; "" before the first."""
        self.every_condition = _prompts(recipe, "condition")
        self.every_temperature = _prompts(recipe, "temperature")

    def plan(self) -> WheelPlan:
        """Return the whole plan."""
        recipe = self.recipe
        specimens = specimens_of(recipe)
        for specimen in specimens:
            compound = specimen.compound
            setpoints = [Setpoint(compound, condition.values, recipe.axes) for condition in self.conditions]
            hows = [condition.settings for condition in self.conditions]
            costs = [self.estimator.costs.of(setpoint, how) for setpoint, how in zip(setpoints, hows, strict=True)]
            for replicate in range(1, recipe.replicates + 1):
                self._replicate(specimen, replicate, setpoints, costs)
        if self.references.reserved is not None and self.count:
            self._on_reserved(self.references.reserved, self.belt)
        return WheelPlan(
            name=recipe.recipe,
            kind=recipe.kind,
            axes=recipe.axes,
            steps=tuple(self.steps),
            specimens=(*specimens, *self.references.specimens),
            wear=tuple(self.wheels),
            replace_after_mm=recipe.wheel.replace_after,
            min_valid=min((condition.settings.min_valid for condition in self.conditions), default=1),
            prepare=self.prepare,
            metadata=metadata_of(recipe) | self.references.metadata,
            references=self.references.made,
        )

    def _replicate(
        self, specimen: Specimen, replicate: int, setpoints: list[Setpoint], costs: list[StepEstimate]
    ) -> None:
        """Add all conditions of one replicate, on as many wheels as they need; both lists are indexed by row."""
        turns = in_turns(self.conditions, self.belt_among)
        blocks = [
            block
            for turn in turns
            for block in ordered(turn, self.held, self.recipe.order, specimen.index, replicate)
        ]
        watch = self.references.on_wheels
        if watch is not None:
            blocks = self.references.inserted(blocks, specimen.index, replicate, self.belt)
            # Row 0 is the reference, the last entry of the list (index -1).
            reference = Setpoint(specimen.compound, watch.values, self.recipe.axes)
            costs = [*costs, self.estimator.costs.of(reference, watch.settings)]
        losses = [[costs[condition.row - 1].loss_mm for condition in block] for block in blocks]
        first = self.belt_among(blocks[0][0].values) if blocks else ""
        wheel = self._new_wheel(specimen, replicate, None, first)
        changes = change_points(losses, wheel.loss_mm, self.recipe.wheel.replace_after)
        for block, points in zip(blocks, changes, strict=True):
            belt = self.belt_among(block[0].values)
            if 0 in points:
                wheel = self._new_wheel(specimen, replicate, None, belt)
            elif belt != self.belt:
                self._other_belt(belt, wheel, specimen)
            self._add(self.every_temperature)
            warm = False
            for position, condition in enumerate(block):
                held_c = self.held(condition.values)
                if position and position in points:
                    wheel = self._new_wheel(specimen, replicate, held_c, belt)
                elif self.references.due_on_reserved():
                    self._exchanged(wheel, specimen, held_c)
                elif not warm or held_c != self.at_c:
                    self._add(self.references.heating(self.at_c, held_c))
                warm, self.at_c = True, held_c
                if not condition.row:
                    watched = Setpoint(specimen.compound, condition.values, self.recipe.axes)
                    self._measure(wheel, condition, watched, costs[-1], reference=True)
                    continue
                if self.every_condition:
                    self._add(self.every_condition)
                self._measure(wheel, condition, setpoints[condition.row - 1], costs[condition.row - 1])

    def _new_wheel(self, specimen: Specimen, replicate: int, heat_c: float | None, belt: str) -> WheelWear:
        reserved = self.references.reserved if self.conditions else None
        if reserved is not None:
            self._on_reserved(reserved, self.belt or belt)
            if belt != self.belt:
                self._reference_after_change(reserved, belt)
        return self._mount(specimen, replicate, heat_c, belt)

    def _mount(self, specimen: Specimen, replicate: int, heat_c: float | None, belt: str) -> WheelWear:
        number = len(self.wheels) + 1
        self.at_c = heat_c
        change = ChangeBelt(INSERTED, belt) if belt != self.belt else None
        self.belt = belt
        steps = prepare_wheel(
            self.prepare, specimen, replicate, number, cool=number > 1, heat_c=heat_c, belt=change
        )
        self._add(steps)
        grind = self.prepare.pre_grind
        ground = self.estimator.pre_grind(grind, specimen.compound) if grind else StepEstimate(0.0)
        wheel = WheelWear(number, specimen.index, replicate, 0, ground.loss_mm, ground.sliding_m)
        self.wheels.append(wheel)
        return wheel

    def _other_belt(self, belt: str, wheel: WheelWear, specimen: Specimen) -> None:
        """Change the belt under a wheel; a reserved wheel measures the reference before and after it."""
        reserved = self.references.reserved
        if reserved is None:
            self._put_on(belt)
            return
        self._on_reserved(reserved, self.belt)
        self._reference_after_change(reserved, belt)
        held_c = self.held(self.references.on(belt).values)
        self._add(step for step in self._mounting_again(wheel, specimen, held_c) if not isinstance(step, Heat))

    def _put_on(self, belt: str) -> None:
        """Ask for a belt; the wheel on it has cooled, and takes the hub's temperature."""
        self._add((Cool(INSERTED), ChangeBelt(INSERTED, belt)))
        self.belt, self.at_c = belt, None

    def _reference_after_change(self, reserved: ReservedWheel, belt: str) -> None:
        """Change the belt under the reserved wheel, and measure the reference on it."""
        self._put_on(belt)
        self._add((Heat(INSERTED, self.held(self.references.on(belt).values)),))
        self._measure_reserved(self.wheels[reserved.number - 1])

    def _on_reserved(self, reserved: ReservedWheel, belt: str) -> None:
        """Measure the reference condition on its reserved wheel; ``belt``: the one that is on, or the first."""
        specimen = self.references.specimens[0]
        held_c = self.held(self.references.on(belt).values)
        if not reserved.number:
            wheel = self._mount(specimen, 1, held_c, belt)
            reserved.number = wheel.wheel
        else:
            wheel = self.wheels[reserved.number - 1]
            self._remount(wheel, specimen, held_c)
        self._measure_reserved(wheel)

    def _measure_reserved(self, wheel: WheelWear) -> None:
        condition, specimen = self.references.on(self.belt), self.references.specimens[0]
        setpoint = Setpoint(specimen.compound, condition.values, self.recipe.axes)
        self._measure(wheel, condition, setpoint, self.estimator.costs.of(setpoint, condition.settings), reference=True)

    def _exchanged(self, wheel: WheelWear, specimen: Specimen, held_c: float) -> None:
        """Mount the reserved wheel for a reference, then the present wheel again."""
        assert self.references.reserved is not None
        self._on_reserved(self.references.reserved, self.belt)
        self._remount(wheel, specimen, held_c)

    def _remount(self, wheel: WheelWear, specimen: Specimen, held_c: float) -> None:
        self._add(self._mounting_again(wheel, specimen, held_c))

    def _mounting_again(self, wheel: WheelWear, specimen: Specimen, held_c: float) -> tuple[WheelStep, ...]:
        cool_c = self.references.hub_below_c(held_c)
        return mount_again(specimen, wheel.replicate, wheel.wheel, held_c, cool_c)

    def _measure(
        self,
        wheel: WheelWear,
        condition: Condition[WheelSettings],
        setpoint: Setpoint,
        cost: StepEstimate,
        *,
        reference: bool = False,
    ) -> None:
        _, row, grid, how = condition
        steps = self.steps
        wheel.conditions += 1
        wheel.loss_mm += cost.loss_mm
        wheel.sliding_m += cost.sliding_m
        self.count += 1
        if reference:
            row = self.references.next_row()
        else:
            row += (wheel.specimen - 1) * len(self.conditions)
            self.references.since += 1
        steps.append(
            WheelCondition(
                index=len(steps), condition=self.count, row=row, specimen=wheel.specimen, replicate=wheel.replicate,
                grid=grid, setpoint=setpoint, wheel=wheel.wheel, reference=reference, **vars(how),
            )
        )  # fmt: skip

    def _add(self, steps: Iterable[WheelStep]) -> None:
        """Add steps, numbered in order."""
        self.steps += [replace(step, index=place) for place, step in enumerate(steps, start=len(self.steps))]


def _prompts(recipe: WheelRecipe, every: str) -> list[PromptStep]:
    asked = [step for step in recipe.steps if step.every == every]
    return [(ToolPrompt if step.by_tool else PromptStep)(INSERTED, step.prompt) for step in asked]


def _prepare(recipe: WheelRecipe, rig: RigConfig) -> PreparePolicy:
    """Return the preparation of every new wheel."""
    grind, rest = recipe.pre_grind, recipe.rest
    return PreparePolicy(
        pre_grind=None
        if grind is None
        else PreGrind(INSERTED, grind.wheel_speed, grind.belt_speed, grind.load, grind.duration),
        rest=None if rest is None else Rest(INSERTED, rest.at_least, rest.until, rest.within, rest.at_most),
        person_steps=tuple(_prompts(recipe, "wheel")),
        ready_c=rig.ambient_c,
    )
