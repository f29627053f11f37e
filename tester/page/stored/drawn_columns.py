"""The columns that the page draws: a run's channels by the names of the trend, in the units for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from tester.base.quantities import LAST, TIME, Channel, Quantities
from tester.service.values import CONTACT_N, screen_of
from tester.store.records import StoredCondition

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Samples = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class DrawnColumn:
    """A column. ``key``: its name in the trend where it has one; ``channel``: whose scale it has; ``recorded``: the
    recorded channel, "" for one that is computed. ``value``: key of its value on a screen; ``axis``: axis of the
    conditions that holds a set point that is not recorded.
    """

    key: str
    title: str
    unit: str
    channel: Channel
    recorded: str = ""
    value: str = ""
    axis: str = ""

    def as_json(self) -> dict[str, str]:
        """Return what a page needs to draw it."""
        found = {"key": self.key, "title": self.title, "unit": self.unit}
        return {**found, "value": self.value} if self.value else found


def drawn_columns(quantities: Quantities) -> tuple[DrawnColumn, ...]:
    """Return the columns of a run: those of the trend first, each value before its set point, then all others."""
    found: list[DrawnColumn] = []
    for channel in quantities.shown:
        screen = screen_of(channel)
        if screen.trend:
            found.append(DrawnColumn(screen.trend, channel.label, channel.read_as, channel,
                                     channel.name if channel.source else "", screen.key))  # fmt: skip
        if screen.setpoint_trend:
            found.append(DrawnColumn(screen.setpoint_trend, f"{channel.label}, set point", channel.read_as, channel,
                                     screen.setpoint, axis="" if screen.setpoint else screen.axis))  # fmt: skip
    drawn = {column.recorded for column in found}
    for channel in quantities.recorded:
        if channel.name not in (TIME, *LAST, *drawn):
            key = channel.column or channel.name
            value = channel.screen.key if channel.screen is not None else ""
            found.append(DrawnColumn(key, channel.label or key, channel.read_as, channel, channel.name, value))
    return tuple({column.key: column for column in reversed(found)}.values())[::-1]


def drawn(
    columns: Sequence[DrawnColumn], samples: Samples, quantities: Quantities, conditions: Sequence[StoredCondition]
) -> NDArray[np.float64]:
    """Return the columns of some samples, shape (columns, samples), in the units for people; NaN for no value."""
    count = len(samples[TIME])
    table = np.full((len(columns), count), np.nan)
    for place, column in enumerate(columns):
        if column.recorded:
            table[place] = samples[column.recorded] * column.channel.scale
        elif column.axis:
            table[place] = _axis_values(column.axis, samples[TIME], conditions)
        elif not column.channel.source:
            table[place] = _friction(quantities, samples)
    return table


def _friction(quantities: Quantities, samples: Samples) -> NDArray[np.float64]:
    """Return the momentary coefficient, as ``tester.service.values.friction`` does for one sample."""
    roles = quantities.roles
    normal = samples[roles.normal]
    touching = normal > (CONTACT_N if len(roles.friction) > 1 else 0.0)
    force = np.hypot.reduce([samples[name] for name in roles.friction])
    return np.divide(force, normal, out=np.full(len(normal), np.nan), where=touching)


def _axis_values(
    axis: str, at_s: NDArray[np.float64], conditions: Sequence[StoredCondition]
) -> NDArray[np.float64]:
    """Return the set point of the condition under way at each moment; NaN between conditions."""
    found = np.full(len(at_s), np.nan)
    for condition in conditions:
        end_s = condition.ended_s if np.isfinite(condition.ended_s) else np.inf
        setpoint = condition.info.setpoint
        if axis in setpoint.axes.places and not setpoint.axes[axis].textual:
            found[(at_s >= condition.started_s) & (at_s < end_s)] = setpoint.axes[axis].number(setpoint)
    return found
