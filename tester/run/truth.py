"""What a simulated rig knows beside what is measured on it, put on record for tests that judge results.

Asked for by ``sim.record_truth`` of a rig file. The table ``truth`` has no reader in the program: nothing that reduces
or exports a run can look at it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from tester.inputs.recipe.plan import Plan
from tester.store.recorder import Recorder

Truth = Callable[[Mapping[str, float]], Mapping[str, float]]
"""What a simulated rig answers: figures of the repeat that has begun, at setpoints by axis."""


def truth_of(world: Any, plant: Any) -> Truth | None:
    """Return what tells the truth of a simulated rig; None where none is asked for, or the rig has none."""
    return getattr(world, "truth", None) if getattr(plant, "record_truth", False) else None


class Witnessed:
    """The hands at a simulated rig, with a note of what it knows whenever a repeat begins."""

    def __init__(self, attendant: Any, truth: Truth, plan: Plan, recorder: Recorder) -> None:
        """``plan``: of this part of the run, in which a row of the table is one condition."""
        self._attendant = attendant
        self._truth = truth
        self._recorder = recorder
        self._steps = {step.row: step for step in plan.conditions()}

    def __getattr__(self, name: str) -> Any:
        """Return what else hands do."""
        return getattr(self._attendant, name)

    def begin_repeat(self, row: int, repeat: int, attempt: int, *more: Mapping[str, float]) -> None:
        """Begin a repeat at the rig, and put on record what that is; ``more``: what a kind tells its rig of it."""
        self._attendant.begin_repeat(row, repeat, attempt, *more)
        step = self._steps.get(row)
        if step is not None:
            self._recorder.truth(step.condition, repeat, attempt, self._truth(step.setpoint.numbers()))
