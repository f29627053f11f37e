"""Settings of a grid's conditions on this machine: number of slip pulses, and whether wear is checked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

from tester.inputs.recipe.schema import GridModel, MeasureModel
from tester.inputs.recipe.settings import Settings, settings_of
from tester.kinds.wheel_on_belt.recipe.schema import WheelGrid, WheelMeasure
from tester.kinds.wheel_on_belt.recipe.steps import WearCheck

Said = TypeVar("Said", bool, float)


@dataclass(frozen=True, slots=True)
class WheelSettings(Settings):
    """Settings of every condition of a grid."""

    max_bursts: int
    wear_check: WearCheck
    run_in_m: float = 0.0
    """Sliding after a reversal of the slip that does not count, m [A]: how far rubber takes to turn its abrasion
    pattern round is not published for these compounds."""


def wheel_settings(measure: MeasureModel, grid: GridModel) -> WheelSettings:
    """Return a grid's settings; raises TypeError for one of another kind."""
    if not isinstance(measure, WheelMeasure) or not isinstance(grid, WheelGrid):
        raise TypeError(f"grid {grid.name} is for a rig of another kind")
    common = settings_of(measure, grid)
    return WheelSettings(
        common.repeats,
        common.at_most,
        common.until_percent,
        common.min_valid,
        common.window,
        common.temperature_band_k,
        common.soak,
        grid.max_bursts or measure.max_bursts,
        grid.wear_check or measure.wear_check,
        _said(grid.run_in_after_reversal, measure.run_in_after_reversal),
        both_directions=_said(grid.both_directions, measure.both_directions),
    )


def _said(own: Said | None, common: Said) -> Said:
    return common if own is None else own
