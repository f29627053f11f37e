"""The reference condition of this machine: its setpoint, checks of it, and when it is due in a plan.

It is due at the start, after every ``every`` conditions, and at the end. On the present wheel it counts as a
condition, with its wear. A reserved wheel must be mounted each time. It is therefore also due at
every change of the wheel, which costs one more change instead of two; the count then restarts. Each belt has its own
references: it is due first and last on every one."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, cast

from tester.analysis.left_out import CLOSEST_OF
from tester.analysis.reference import RESERVED
from tester.base.axes import Setpoint
from tester.base.source import Location, Problem, Tree
from tester.base.units import shown
from tester.inputs.recipe.conditions import Condition
from tester.inputs.recipe.plan import Specimen
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, grid_model
from tester.inputs.recipe.reference_section import REFERENCE, reference_metadata
from tester.inputs.recipe.semantics import axis_values
from tester.inputs.recipe.specimen_section import checks_of
from tester.inputs.recipe.surface_turns import surface_among
from tester.kinds.wheel_on_belt.image.axes import on_belt
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, WheelStep
from tester.kinds.wheel_on_belt.recipe.schema import (
    REFERENCE_HELD,
    ReferenceModel,
    WheelGrid,
    WheelRecipe,
    WheelSettings,
    wheel_settings,
)
from tester.kinds.wheel_on_belt.recipe.wheel_change import INSERTED

AT: Final[Location] = (REFERENCE,)
"""Position of the reference in a recipe."""


def as_grid(reference: ReferenceModel, recipe: WheelRecipe) -> WheelGrid:
    """Return a reference condition as a grid of one condition."""
    values = {name: [getattr(reference, name)] for name in REFERENCE_HELD}
    speed = None if reference.wheel_speed is None else [reference.wheel_speed]
    others: dict[str, Any] = {"name": REFERENCE, "wheel_speed": speed, "repeats": reference.repeats}
    return cast("WheelGrid", grid_model(recipe.axes, WheelGrid).model_construct(**values, **others))


def reference_condition(recipe: WheelRecipe) -> Condition[WheelSettings] | None:
    """Return a recipe's reference condition, None without one; the plan sets its row."""
    if recipe.reference is None or recipe.measure is None or not recipe.grids:
        return None
    grid = as_grid(recipe.reference, recipe)
    (values,) = zip(*axis_values(recipe.measure, grid).values(), strict=True)
    how = wheel_settings(recipe.measure, grid)
    # References are compared with each other: few repeats cause no flag, and each has the same number.
    how = replace(how, min_valid=min(how.min_valid, how.repeats), until_percent=None)
    return Condition(values, 0, REFERENCE, how)


def reference_problems(
    recipe: WheelRecipe, tree: Tree, sense: Callable[[MeasureModel, GridModel, Location, Tree], Iterator[Problem]]
) -> Iterator[Problem]:
    """Yield faults of a recipe's reference condition that do not depend on the rig; ``sense``: those of any grid."""
    reference, measure = recipe.reference, recipe.measure
    if reference is None:
        return
    if not recipe.grids or measure is None:
        yield tree.problem(AT, "reference: there is nothing to measure between references (expected grids)")
        return
    for index, grid in enumerate(recipe.grids):
        if grid.name == REFERENCE:
            message = f"a grid {shown(REFERENCE)} would be taken for the reference condition (expected another name)"
            yield tree.problem(("grids", index, "name"), message)
    if reference.compound is not None and reference.wheel is None:
        message = "compound: a reference on whichever wheel is on has that wheel's compound (expected wheel with it)"
        yield tree.problem((*AT, "compound"), message)
    if measure.combine == "paper" and reference.repeats is not None and reference.repeats.at_least != CLOSEST_OF:
        message = f"repeats: combine: paper takes the closest two of {CLOSEST_OF} (expected {CLOSEST_OF})"
        yield tree.problem((*AT, "repeats"), message)
    yield from sense(measure, as_grid(reference, recipe), AT, tree)


ABOVE_AMBIENT_K = 2.0
"""A turning hub cools to within this of ambient in a reasonable time [A]."""


@dataclass(slots=True)
class ReservedWheel:
    """The wheel that is reserved for references; its number in the plan, 0 before it is mounted."""

    name: str
    number: int = 0


class ReferenceRounds:
    """The references of one plan, in order."""

    def __init__(self, recipe: WheelRecipe, ambient_c: float, conditions: int) -> None:
        """``conditions``: of one replicate; ``ambient_c``: at the rig, degC."""
        asked = recipe.reference
        self.condition: Condition[WheelSettings] | None = reference_condition(recipe)
        """The reference condition; None if the recipe has no references. Its row is 0."""
        self.reserved = ReservedWheel(asked.wheel) if self.condition and asked and asked.wheel else None
        self.every = asked.every if asked is not None else 0
        self.since = 0
        """Conditions since the last reference."""
        self.made = 0
        self._ambient_c = ambient_c
        self._axes = recipe.axes
        self._first_row = conditions * len(recipe.specimens) + 1
        self._last = (len(recipe.specimens), recipe.replicates)
        self.specimens: tuple[Specimen, ...] = ()
        """Specimens of the reserved wheel, after the recipe's own."""
        self.metadata = dict(reference_metadata(asked if self.condition else None))
        if self.reserved is not None and asked is not None:
            compound = asked.compound or recipe.specimens[0].compound
            number, note = len(recipe.specimens) + 1, f"reserved: {self.reserved.name}"
            self.specimens = (Specimen(number, compound, note, checks_of(recipe)),)
            self.metadata[RESERVED] = self.reserved.name

    @property
    def on_wheels(self) -> Condition[WheelSettings] | None:
        """Return the reference condition if it uses the present wheel, else None."""
        return self.condition if self.reserved is None else None

    def due_on_reserved(self) -> bool:
        """Return whether to mount the reserved wheel before the next condition."""
        return self.reserved is not None and self.since >= self.every

    def on(self, belt: str) -> Condition[WheelSettings]:
        """Return the reference condition on a belt that the grids name; "": on the recipe's only belt."""
        assert self.condition is not None
        if not belt:
            return self.condition
        setpoint = on_belt(Setpoint("", self.condition.values, self._axes), belt)
        return self.condition._replace(values=setpoint.values)

    def inserted(
        self, blocks: Sequence[Sequence[Condition[WheelSettings]]], specimen: int, replicate: int, belt: str
    ) -> list[list[Condition[WheelSettings]]]:
        """Return the blocks of a replicate with the reference before every condition at which it is due.

        It is due first and last on every belt; ``belt``: the one that is on before.
        """
        count, begun = self.since, bool(self.made)
        belt_among = surface_among(self._axes)
        belts = {belt_among(block[0].values) for block in blocks}
        filled_blocks: list[list[Condition[WheelSettings]]] = []
        for block in blocks:
            own = belt_among(block[0].values)
            if own != belt:
                if filled_blocks:
                    filled_blocks[-1].append(self.on(belt))
                belt, begun = own, False
            filled: list[Condition[WheelSettings]] = []
            for condition in block:
                if not begun or count >= self.every:
                    filled.append(self.on(own))
                    begun, count = True, 0
                filled.append(condition)
                count += 1
            filled_blocks.append(filled)
        if filled_blocks and (len(belts) > 1 or (specimen, replicate) == self._last):
            filled_blocks[-1].append(self.on(belt))
        return filled_blocks

    def next_row(self) -> int:
        """Return the row of the next reference, after all rows of the recipe's own conditions."""
        self.since = 0
        self.made += 1
        return self._first_row + self.made - 1

    def heating(self, from_c: float | None, to_c: float) -> list[WheelStep]:
        """Return the steps to the temperature of a condition, degC; ``from_c`` None: on a new wheel.

        To a lower temperature the hub cools first: a surface does not stay colder than its hub.
        """
        if from_c is not None and to_c < from_c:
            return [Cool(INSERTED, self.hub_below_c(to_c)), Heat(INSERTED, to_c)]
        return [Heat(INSERTED, to_c)]

    def hub_below_c(self, to_c: float) -> float:
        """Return the hub temperature, degC, below which a surface can be held at ``to_c``."""
        return max(to_c, self._ambient_c + ABOVE_AMBIENT_K)
