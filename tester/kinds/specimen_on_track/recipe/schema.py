"""The keys of this machine's recipes beyond the common sections: the way that a condition slides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, TypeAlias

from pydantic import Field

from tester.analysis.stability import Window
from tester.base.units import Quantity
from tester.inputs.recipe.grid_settings import DEFAULT_EXTENSION, settings_of
from tester.inputs.recipe.plan import Settings
from tester.inputs.recipe.recipe_schema import GridModel, MeasureModel, Recipe
from tester.kinds.specimen_on_track.recipe.plan_steps import STRETCHES, TrackSettings

Distance: TypeAlias = Annotated[float, Quantity("mm", ge=0.1, le=1e6)]
Coefficient: TypeAlias = Annotated[float, Field(gt=0.0, le=1.0)]
AtLeast: TypeAlias = Annotated[float, Quantity("s", ge=1.0, le=3600.0)]


class TrackMeasure(MeasureModel, frozen=True):
    """How a condition is measured; the defaults of every grid."""

    distance: Distance = 0.5
    """way over which friction has to be stationary; a repeat collects 1.5 times that"""
    at_least: AtLeast = 5.0
    """... and at least as long as this takes at the condition's speed"""
    least_friction: Coefficient | None = None
    """the least coefficient expected; below interlocks.lost_share only of a wet or powdered track, on a rig with a
    height sensor"""


class TrackGrid(GridModel, frozen=True):
    """All combinations of its axes; missing keys are as in ``measure``."""

    distance: Distance | None = None
    at_least: AtLeast | None = None
    least_friction: Coefficient | None = None


class TrackRecipe(Recipe, frozen=True):
    """A recipe for this machine."""

    measure: TrackMeasure | None = None
    grids: Sequence[TrackGrid] = ()


def track_settings_of(settings: Settings) -> TrackSettings:
    """Return a condition's settings as this machine's; raises TypeError for those of another kind."""
    if not isinstance(settings, TrackSettings):
        raise TypeError(f"{type(settings).__name__} are no settings of this machine")
    return settings


def track_settings(measure: MeasureModel, grid: GridModel) -> TrackSettings:
    """Return a grid's settings; raises TypeError for one of another kind."""
    if not isinstance(measure, TrackMeasure) or not isinstance(grid, TrackGrid):
        raise TypeError(f"grid {grid.name} is for a rig of another kind")
    common = replace(settings_of(measure, grid), window=Window(float(STRETCHES), None, DEFAULT_EXTENSION * STRETCHES))
    return TrackSettings(
        **vars(common),
        distance_m=1e-3 * (grid.distance or measure.distance),
        at_least_s=grid.at_least or measure.at_least,
        least_mu=grid.least_friction or measure.least_friction or 0.0,
    )
