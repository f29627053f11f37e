"""When the reference condition is due in a plan: at the start, after every so many conditions, and at the end.

On the present wheel it is one of the conditions, and its wear counts with theirs. A wheel that is reserved for
it has to be put on each time: it comes round at every change of the wheel as well, where that costs one change more
instead of two, and the count begins anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tester.analysis.reference import RESERVED
from tester.inputs.recipe.conditions import Condition
from tester.inputs.recipe.plan import Specimen
from tester.inputs.recipe.reference_section import reference_metadata
from tester.kinds.wheel_on_belt.recipe.plan_steps import Cool, Heat, WheelStep
from tester.kinds.wheel_on_belt.recipe.references import reference_condition
from tester.kinds.wheel_on_belt.recipe.schema import WheelRecipe, WheelSettings

ABOVE_AMBIENT_K = 2.0
"""A hub turning in the air comes this near to ambient in a time worth waiting for [A]."""


@dataclass(slots=True)
class ReservedWheel:
    """The wheel that is reserved for references; its number in the plan, 0 before it is mounted."""

    name: str
    number: int = 0


class ReferenceRounds:
    """The references of one plan, as they are given out."""

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
        self._first_row = conditions * len(recipe.specimens) + 1
        self._last = (len(recipe.specimens), recipe.replicates)
        self.specimens: tuple[Specimen, ...] = ()
        """Specimens of the reserved wheel, after the recipe's own."""
        self.metadata = dict(reference_metadata(asked if self.condition else None))
        if self.reserved is not None and asked is not None:
            compound = asked.compound or recipe.specimens[0].compound
            self.specimens = (Specimen(len(recipe.specimens) + 1, compound, f"reserved: {self.reserved.name}"),)
            self.metadata[RESERVED] = self.reserved.name

    @property
    def on_wheels(self) -> Condition[WheelSettings] | None:
        """Return the reference condition where it is measured on whichever wheel is on."""
        return self.condition if self.reserved is None else None

    def due_on_reserved(self) -> bool:
        """Return whether the reserved wheel is to come on before the next condition."""
        return self.reserved is not None and self.since >= self.every

    def inserted(
        self, blocks: Sequence[Sequence[Condition[WheelSettings]]], specimen: int, replicate: int
    ) -> list[list[Condition[WheelSettings]]]:
        """Return the blocks of a replicate with the reference before every condition at which it is due."""
        assert self.condition is not None
        count, begun = self.since, bool(self.made)
        filled_blocks: list[list[Condition[WheelSettings]]] = []
        for block in blocks:
            filled: list[Condition[WheelSettings]] = []
            for condition in block:
                if not begun or count >= self.every:
                    filled.append(self.condition)
                    begun, count = True, 0
                filled.append(condition)
                count += 1
            filled_blocks.append(filled)
        if filled_blocks and (specimen, replicate) == self._last:
            filled_blocks[-1].append(self.condition)
        return filled_blocks

    def next_row(self) -> int:
        """Return the row of the next reference, behind all of the recipe's own."""
        self.since = 0
        self.made += 1
        return self._first_row + self.made - 1

    def heating(self, index: int, from_c: float | None, to_c: float) -> list[WheelStep]:
        """Return the steps to the temperature of a condition, degC; ``from_c`` None: on a new wheel.

        Down, the hub cools first: a surface does not stay colder than the hub below it.
        """
        if from_c is not None and to_c < from_c:
            return [Cool(index, self.hub_below_c(to_c)), Heat(index + 1, to_c)]
        return [Heat(index, to_c)]

    def hub_below_c(self, to_c: float) -> float:
        """Return what the hub has to come down to before a surface can be held at a temperature, degC."""
        return max(to_c, self._ambient_c + ABOVE_AMBIENT_K)
