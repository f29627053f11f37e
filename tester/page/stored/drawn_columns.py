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


class ColumnValues:
    """Makes the columns of a run from its samples, in the units for people; NaN for no value."""

    def __init__(
        self, columns: Sequence[DrawnColumn], quantities: Quantities, conditions: Sequence[StoredCondition]
    ) -> None:
        """``conditions``: those of the run, whose set points are drawn."""
        self.columns = columns
        self._quantities = quantities
        self._spans = {column.axis: _spans(column.axis, conditions) for column in columns if column.axis}

    def values(self, samples: Samples) -> NDArray[np.float64]:
        """Return the columns of some samples, shape (columns, samples)."""
        table = np.empty((len(self.columns), len(samples[TIME])))
        for place, column in enumerate(self.columns):
            recorded = column.recorded
            table[place] = samples[recorded] * column.channel.scale if recorded else self.computed(column, samples)
        return table

    def computed(self, column: DrawnColumn, samples: Samples) -> NDArray[np.float64]:
        """Return a column that is not recorded."""
        if column.axis:
            return _axis_values(self._spans[column.axis], samples[TIME])
        if not column.channel.source:
            return _friction(self._quantities, samples)
        return np.full(len(samples[TIME]), np.nan)


def _friction(quantities: Quantities, samples: Samples) -> NDArray[np.float64]:
    """Return the momentary coefficient, as ``tester.service.values.friction`` does for one sample."""
    roles = quantities.roles
    normal = samples[roles.normal]
    touching = normal > (CONTACT_N if len(roles.friction) > 1 else 0.0)
    force = np.hypot.reduce([samples[name] for name in roles.friction])
    return np.divide(force, normal, out=np.full(len(normal), np.nan), where=touching)


def _spans(axis: str, conditions: Sequence[StoredCondition]) -> NDArray[np.float64]:
    """Return begin, end (rig seconds) and set point of the conditions that have this axis, shape (conditions, 3)."""
    found = [
        (one.started_s, one.ended_s if np.isfinite(one.ended_s) else np.inf, held.axes[axis].number(held))
        for one in conditions
        if axis in (held := one.info.setpoint).axes.places and not held.axes[axis].textual
    ]
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def _axis_values(spans: NDArray[np.float64], at_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the set point of the condition under way at each moment; NaN between conditions."""
    found = np.full(len(at_s), np.nan)
    if len(at_s):
        near = (spans[:, 0] <= np.max(at_s)) & (spans[:, 1] > np.min(at_s))  # of 165 conditions, one or two
        for begin_s, end_s, value in spans[near]:
            found[(at_s >= begin_s) & (at_s < end_s)] = value
    return found
