"""The recipe's sections for this machine beyond the common ones: grinding, resting, wheels, slip pulses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Final, Literal, TypeAlias, TypeVar

from pydantic import Field, model_validator

from tester.base.units import Quantity
from tester.inputs.recipe.grid_settings import settings_of
from tester.inputs.recipe.recipe_schema import (
    Band,
    GridModel,
    Load,
    MeasureModel,
    Recipe,
    Seconds,
    Section,
    Temperature,
    Text,
)
from tester.inputs.recipe.reference_section import ReferenceSection
from tester.kinds.wheel_on_belt.image.axes import AXES, LEAST_SPEED_M_S
from tester.kinds.wheel_on_belt.recipe.plan_steps import WearCheck, WheelSettings

Speed: TypeAlias = Annotated[float, Quantity("m/s", ge=LEAST_SPEED_M_S)]
MaxBursts: TypeAlias = Annotated[int, Field(ge=1, le=10_000)]
RunIn: TypeAlias = Annotated[float, Quantity("m", ge=0, le=1000)]


class PreGrindModel(Section, frozen=True):
    """Grinding of a new wheel before it measures."""

    wheel_speed: Speed
    belt_speed: Speed
    load: Load
    duration: Annotated[float, Quantity("s", gt=0, le=24 * 3600)]


class RestModel(Section, frozen=True):
    """Standing lifted after pre-grinding, until the surface is at a temperature again."""

    at_least: Seconds = 0.0
    until: Temperature | None = None
    within: Band = 2.0
    at_most: Annotated[float, Quantity("s", gt=0)] = 5400.0
    """longest wait (default 90 min), then a prompt on hardware and "not reached" otherwise"""

    @model_validator(mode="after")
    def _long_enough(self) -> RestModel:
        if self.at_most < self.at_least:
            raise ValueError(f"at_most, {self.at_most:g} s, is shorter than at_least, {self.at_least:g} s")
        return self


class WheelModel(Section, frozen=True):
    """When a wheel is worn."""

    replace_after: Annotated[float, Quantity("mm", gt=0, le=20)] = 2.0
    """loss of diameter after which a wheel is replaced"""


class PersonStepModel(Section, frozen=True):
    """A recurring task for a person."""

    prompt: Text
    """what to do; it is shown and waits to be acknowledged"""
    every: Literal["condition", "temperature", "wheel"]
    """before every condition, before every temperature, or after every installed wheel"""
    by_tool: bool = False
    """done with a tool that keeps hands off the wheel: the hub may then be as warm as limits.tool_hub of the rig"""


class WheelMeasure(MeasureModel, frozen=True):
    """How a condition is measured; the defaults of every grid."""

    wheel_speed: Speed
    max_bursts: MaxBursts = 40
    """slip pulses in which a repeat may collect its window"""
    wear_check: WearCheck = "never"
    both_directions: bool = False
    """repeats alternate between the slip and its reverse (+ - - +); repeats, at_most and min_valid count pairs"""
    run_in_after_reversal: RunIn = 0.0
    """sliding that does not count after the slip has turned round, such as 5 m (default none)"""


class WheelGrid(GridModel, frozen=True):
    """All combinations of its axes; missing keys are as in ``measure``."""

    max_bursts: MaxBursts | None = None
    wear_check: WearCheck | None = None
    both_directions: bool | None = None
    run_in_after_reversal: RunIn | None = None


REFERENCE_HELD: Final = {"slip_velocity": 0.3, "load": 200.0, "temperature": 40.0}
"""Setpoints of a reference condition that the recipe leaves out, m/s, N, degC: slip and load of the paper's
middle condition, and a temperature that a hot wheel falls to within the hour and a cold one rises to within minutes
[A]."""
_WARMTH = AXES["temperature"]


class ReferenceModel(ReferenceSection, frozen=True):
    """A reference condition: without angles; missing keys are as in ``measure``."""

    wheel: Text | None = None
    """name of a wheel that is reserved for it; without one it is measured on whichever wheel is on"""
    slip_velocity: Annotated[float, Quantity("m/s")] = REFERENCE_HELD["slip_velocity"]
    """default 300 mm/s"""
    load: Load = REFERENCE_HELD["load"]
    """default 200 N"""
    temperature: Annotated[float, Quantity("degC", ge=_WARMTH.ge, le=_WARMTH.le)] = REFERENCE_HELD["temperature"]
    """default 40 degC"""
    wheel_speed: Speed | None = None
    """default: that of ``measure``"""


class WheelRecipe(Recipe, frozen=True):
    """A recipe for this machine."""

    pre_grind: PreGrindModel | None = None
    rest: RestModel | None = None
    measure: WheelMeasure | None = None
    grids: Sequence[WheelGrid] = ()
    steps: Annotated[Sequence[PersonStepModel], Field(max_length=100)] = ()
    wheel: WheelModel = WheelModel()
    reference: ReferenceModel | None = None
    """a condition measured again and again, to see what the belt does meanwhile"""


def for_wheels(recipe: Recipe) -> WheelRecipe:
    """Return a recipe as one for this machine; raises TypeError."""
    if not isinstance(recipe, WheelRecipe):
        raise TypeError(f"{recipe.recipe}: the recipe is for a rig of kind {recipe.kind}")
    return recipe


Setting = TypeVar("Setting", bool, float)


def wheel_settings(measure: MeasureModel, grid: GridModel) -> WheelSettings:
    """Return a grid's settings; raises TypeError for one of another kind."""
    if not isinstance(measure, WheelMeasure) or not isinstance(grid, WheelGrid):
        raise TypeError(f"grid {grid.name} is for a rig of another kind")
    both_directions = _of_grid(grid.both_directions, measure.both_directions)
    return WheelSettings(
        **vars(replace(settings_of(measure, grid), both_directions=both_directions)),
        max_bursts=grid.max_bursts or measure.max_bursts,
        wear_check=grid.wear_check or measure.wear_check,
        run_in_m=_of_grid(grid.run_in_after_reversal, measure.run_in_after_reversal),
    )


def _of_grid(setting: Setting | None, common: Setting) -> Setting:
    return common if setting is None else setting
