"""A recipe to a plan: grids to conditions, in order, with a wheel under each of them.

A condition that several grids share is measured once. Temperatures ascend, because cooling a wheel takes far
longer than heating it. Wheels are changed only between conditions, before one whose predicted wear exceeds what is
left, and at a temperature boundary where that costs no further wheel.
"""

from __future__ import annotations

import random
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, count, product
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from tester.recipe.cost import StepEstimate
from tester.recipe.estimate import Estimator
from tester.recipe.plan import (
    ConditionStep,
    Heat,
    Plan,
    PreGrind,
    PreparePolicy,
    Prompt,
    Rest,
    Setpoint,
    Specimen,
    Step,
    WheelWear,
)
from tester.recipe.schema import OrderModel, Recipe
from tester.recipe.semantics import axis_values
from tester.recipe.settings import Settings, settings_of
from tester.recipe.wheel_change import INSERTED, prepare_wheel

if TYPE_CHECKING:
    from tester.rig import RigConfig

Key: TypeAlias = tuple[float, float, float, float, float, float]
"""What tells conditions of a specimen apart: values of ``semantics.AXES`` in that order."""

_TEMPERATURE = 5


class Condition(NamedTuple):
    """One condition of a specimen: its setpoints, its row in the recipe's order (from 1) and its first grid."""

    key: Key
    row: int
    grid: str
    settings: Settings


def expand(recipe: Recipe, rig: RigConfig, estimator: Estimator | None = None) -> Plan:
    """Return the plan of a valid recipe on a rig (its wear rate and geometry decide the wheel changes).

    ``estimator``: one for this rig, if the caller goes on to estimate the plan; it remembers every condition.
    """
    return _Expansion(recipe, rig, estimator or Estimator(rig)).plan()


def conditions_of(recipe: Recipe) -> list[Condition]:
    """Return a specimen's distinct conditions in the recipe's order: grid after grid, temperature innermost."""
    measure = recipe.measure
    if measure is None:
        return []
    found: dict[Key, tuple[str, Settings]] = {}
    for grid in recipe.grids:
        entry = (grid.name, settings_of(measure, grid))
        slips, loads, sideslips, cambers, wheels, temperatures = axis_values(measure, grid)
        for key in product(slips, loads, sideslips, cambers, wheels, temperatures):
            found.setdefault(key, entry)
    return [Condition(key, row, grid, settings) for row, (key, (grid, settings)) in enumerate(found.items(), start=1)]


def ordered(conditions: Sequence[Condition], order: OrderModel, specimen: int, replicate: int) -> list[list[Condition]]:
    """Return the conditions grouped by temperature, ascending, each group in the order that is asked for."""
    groups: dict[float, list[Condition]] = {}
    for condition in conditions:
        groups.setdefault(condition.key[_TEMPERATURE], []).append(condition)
    blocks = [groups[temperature] for temperature in sorted(groups)]
    if order.within == "snake":
        # Back and forth: a temperature begins with the setpoints at which the one before it ended.
        return [block[::-1] if number % 2 else block for number, block in enumerate(blocks)]
    if order.within == "shuffled":
        for block in blocks:
            # A stream of its own per block: another temperature in the recipe leaves this one's order alone.
            key = f"{order.seed}/{specimen}/{replicate}/{block[0].key[_TEMPERATURE]!r}"
            random.Random(key).shuffle(block)
    return blocks


def change_points(losses: Sequence[Sequence[float]], first_mm: float, limit_mm: float) -> list[set[int]]:
    """Return, for every block of conditions, the positions in it before which a new wheel goes on.

    ``losses``: predicted loss of diameter (mm) of the conditions, block by block; ``first_mm``: what preparing a
    wheel costs; ``limit_mm``: loss after which a wheel is replaced. A wheel always takes at least one condition.
    """
    sums = [0.0, *accumulate(loss for block in losses for loss in block)]
    fresh = limit_mm - first_mm
    room, used, start = fresh, False, 0
    changes: list[set[int]] = []
    for block in losses:
        points: set[int] = set()
        fits = sums[start + len(block)] - sums[start] <= room
        # A block that does not fit: change at its beginning, where that costs no more wheels in the end.
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
    """Return how many changes the conditions from ``start`` on need if each wheel is used up, mm left ``room``."""
    changes = 0
    while True:
        reached = bisect_right(sums, sums[start] + room, lo=start) - 1
        if reached >= len(sums) - 1:
            return changes
        if reached == start and room >= fresh:
            reached += 1  # a new wheel takes at least one condition
        start, room = reached, fresh
        changes += 1


def metadata_of(recipe: Recipe) -> dict[str, str]:
    """Return what the recipe says about the experiment, as text, in columns named with their units."""
    result: dict[str, str] = {}
    if recipe.abrasive is not None:
        result["abrasive"] = recipe.abrasive.name
        if recipe.abrasive.mesh is not None:
            result["abrasive_mesh"] = str(recipe.abrasive.mesh)
        if recipe.abrasive.id is not None:
            result["abrasive_id"] = recipe.abrasive.id
    if recipe.humidity is not None:
        result["humidity_percent"] = f"{recipe.humidity:g}"
    if recipe.ambient is not None:
        result["ambient_c"] = f"{recipe.ambient:g}"
    result.update({f"experiment.{key}": value for key, value in recipe.experiment.items()})
    return result


@dataclass(slots=True)
class _Wheel:
    """What the wheel in hand has been given so far."""

    number: int
    specimen: int
    replicate: int
    loss_mm: float
    sliding_m: float
    conditions: int = 0

    def wear(self) -> WheelWear:
        return WheelWear(self.number, self.specimen, self.replicate, self.conditions, self.loss_mm, self.sliding_m)


class _Expansion:
    """Builds the steps of one plan."""

    def __init__(self, recipe: Recipe, rig: RigConfig, estimator: Estimator) -> None:
        self.recipe = recipe
        self.estimator = estimator
        self.prepare = _prepare(recipe, rig)
        self.conditions = conditions_of(recipe)
        self.steps: list[Step] = []
        self.wheels: list[_Wheel] = []
        self.count = 0
        self.every_condition = [one.prompt for one in recipe.steps if one.every == "condition"]
        self.every_temperature = [one.prompt for one in recipe.steps if one.every == "temperature"]

    def plan(self) -> Plan:
        """Return the whole plan."""
        recipe = self.recipe
        specimens = tuple(
            Specimen(index, one.compound, one.note) for index, one in enumerate(recipe.specimens, start=1)
        )
        for specimen in specimens:
            setpoints = [setpoint_of(specimen.compound, one.key) for one in self.conditions]
            cost = self.estimator.costs.of
            costs = [cost(setpoint, one.settings) for setpoint, one in zip(setpoints, self.conditions, strict=True)]
            for replicate in range(1, recipe.replicates + 1):
                self._replicate(specimen, replicate, setpoints, costs)
        return Plan(
            name=recipe.recipe,
            steps=tuple(self.steps),
            specimens=specimens,
            wear=tuple(wheel.wear() for wheel in self.wheels),
            replace_after_mm=recipe.wheel.replace_after,
            min_valid=min((one.settings.min_valid for one in self.conditions), default=1),
            prepare=self.prepare,
            metadata=metadata_of(recipe),
        )

    def _replicate(
        self, specimen: Specimen, replicate: int, setpoints: list[Setpoint], costs: list[StepEstimate]
    ) -> None:
        """Add all conditions of one replicate, on as many wheels as they wear; both lists go by row."""
        blocks = ordered(self.conditions, self.recipe.order, specimen.index, replicate)
        losses = [[costs[one.row - 1].loss_mm for one in block] for block in blocks]
        self._new_wheel(specimen, replicate, None)
        changes = change_points(losses, self.wheels[-1].loss_mm, self.recipe.wheel.replace_after)
        for block, points in zip(blocks, changes, strict=True):
            if 0 in points:
                self._new_wheel(specimen, replicate, None)
            temperature = block[0].key[_TEMPERATURE]
            self._prompts(self.every_temperature)
            self.steps.append(Heat(len(self.steps), temperature))
            for position, one in enumerate(block):
                if position and position in points:
                    self._new_wheel(specimen, replicate, temperature)
                if self.every_condition:
                    self._prompts(self.every_condition)
                self._measure(one, setpoints[one.row - 1], costs[one.row - 1])

    def _new_wheel(self, specimen: Specimen, replicate: int, heat_c: float | None) -> None:
        number = len(self.wheels) + 1
        self.steps += prepare_wheel(
            self.prepare,
            specimen,
            replicate,
            number,
            cool=number > 1,
            heat_c=heat_c,
            numbers=count(len(self.steps)),
        )
        grind = self.prepare.pre_grind
        ground = self.estimator.pre_grind(grind, specimen.compound) if grind else StepEstimate(0.0)
        self.wheels.append(_Wheel(number, specimen.index, replicate, ground.loss_mm, ground.sliding_m))

    def _measure(self, one: Condition, setpoint: Setpoint, cost: StepEstimate) -> None:
        _, row, grid, how = one
        wheel, steps = self.wheels[-1], self.steps
        wheel.conditions += 1
        wheel.loss_mm += cost.loss_mm
        wheel.sliding_m += cost.sliding_m
        self.count += 1
        # By position: with names the call costs twice as much, and there may be 250,000 of them.
        steps.append(
            ConditionStep(
                len(steps),
                self.count,
                (wheel.specimen - 1) * len(self.conditions) + row,
                wheel.specimen,
                wheel.replicate,
                wheel.number,
                grid,
                setpoint,
                how.repeats,
                how.min_valid,
                how.window,
                how.temperature_band_k,
                how.soak,
                how.max_bursts,
                how.wear_check,
                how.at_most,
                how.until_percent,
            )
        )

    def _prompts(self, texts: list[str]) -> None:
        for text in texts:
            self.steps.append(Prompt(len(self.steps), text))


def setpoint_of(compound: str, key: Key) -> Setpoint:
    """Return what is held in a condition of a compound."""
    slip, load, sideslip, camber, wheel_speed, temperature = key
    return Setpoint(compound, slip, load, sideslip, camber, temperature, wheel_speed)


def _prepare(recipe: Recipe, rig: RigConfig) -> PreparePolicy:
    """Return what every new wheel goes through."""
    grind, rest = recipe.pre_grind, recipe.rest
    return PreparePolicy(
        pre_grind=None
        if grind is None
        else PreGrind(INSERTED, grind.wheel_speed, grind.belt_speed, grind.load, grind.duration),
        rest=None if rest is None else Rest(INSERTED, rest.at_least, rest.until, rest.within, rest.at_most),
        person_steps=tuple(one.prompt for one in recipe.steps if one.every == "wheel"),
        ready_c=rig.ambient_c,
    )
