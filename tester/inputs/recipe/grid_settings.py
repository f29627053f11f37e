"""How the conditions of a grid are measured: the recipe's ``measure`` with the grid's own values."""

from __future__ import annotations

from collections.abc import Sequence

from tester.analysis.stability import Window
from tester.base.axes import Axis, AxisValue
from tester.inputs.recipe.plan import Settings, Soak
from tester.inputs.recipe.recipe_schema import Extent, GridModel, MeasureModel, RepeatsModel, SoakModel

DEFAULT_MIN_VALID = 3
"""Least valid repeats for a value without a flag [A]."""

DEFAULT_AT_MOST = 2
"""Repeats made in all, as a multiple of those that must count, unless the recipe has ``at_most``."""

LEAST_REPEATS = 4
"""Least repeats of a condition before ``until`` counts as reached: three would have a coverage of 71 %, not 95 %."""

DEFAULT_EXTENSION = 3.0
"""Most that a repeat collects as a multiple of its window, unless the recipe has ``extend_to``."""


def settings_of(measure: MeasureModel, grid: GridModel) -> Settings:
    """Return a grid's settings."""
    repeats = grid.repeats or measure.repeats
    return Settings(
        repeats=repeats.at_least,
        at_most=at_most_of(repeats),
        until_percent=grid.until or measure.until,
        min_valid=grid.min_valid or measure.min_valid or DEFAULT_MIN_VALID,
        window=_window(measure, grid),
        temperature_band_k=grid.temperature_band or measure.temperature_band,
        soak=_soak(grid.soak or measure.soak),
    )


def at_most_of(repeats: RepeatsModel) -> int:
    """Return how many repeats are made at most."""
    return repeats.at_most or DEFAULT_AT_MOST * repeats.at_least


def values_of(axis: Axis, measure: MeasureModel, grid: GridModel) -> tuple[AxisValue, ...]:
    """Return a grid's values of an axis, each once: its own list, or the value of ``measure``."""
    listed: Sequence[AxisValue] | None = getattr(grid, axis.name)
    if listed is None:
        value: AxisValue = getattr(measure, axis.name)
        return (value,)
    return tuple(dict.fromkeys(listed))


def extents_of(measure: MeasureModel, grid: GridModel | None) -> tuple[Extent, Extent | None]:
    """Return (window, extend_to) of a grid, or of the defaults; a grid with its own window has its own extension."""
    if grid is None or grid.window is None:
        return measure.window, (grid.extend_to if grid else None) or measure.extend_to
    return grid.window, grid.extend_to


def _window(measure: MeasureModel, grid: GridModel) -> Window:
    window, extend_to = extents_of(measure, grid)
    until = extend_to.value if extend_to else DEFAULT_EXTENSION * window.value
    if window.unit == "rev":
        return Window(revolutions=window.value, seconds=None, extend_to=until)
    return Window(revolutions=None, seconds=window.value, extend_to=until)


def _soak(soak: SoakModel) -> Soak:
    return Soak(within_k=soak.within, for_s=soak.for_, at_most_s=soak.at_most)
