"""A recorded sample as the values of a screen: what was measured, beside the set point as it was then."""

from __future__ import annotations

from collections.abc import Mapping

from tester.base.quantities import Channel, Quantities
from tester.machine.panel import Wanted
from tester.service.values import NOTHING_WANTED, friction, screen_of
from tester.store.records import ConditionInfo


def recorded_value(quantities: Quantities, channel: Channel, row: Mapping[str, float]) -> float | None:
    """Return a channel's value in a sample, in the unit for people; None if it was not recorded."""
    if channel.source:
        return channel.scaled(row.get(channel.name))
    return friction(quantities, row.__getitem__)


def recorded_setpoint(
    quantities: Quantities, channel: Channel, row: Mapping[str, float], info: ConditionInfo | None
) -> Wanted:
    """Return a channel's set point: the recorded one, else that of the condition under way (``info``)."""
    screen = screen_of(channel)
    if screen.setpoint:
        return Wanted(channel.scaled(row.get(screen.setpoint)))
    if not screen.axis or info is None:
        return NOTHING_WANTED
    warm = channel.name == quantities.roles.temperature
    setpoint = info.setpoint
    return Wanted(setpoint.axes[screen.axis].number(setpoint), info.temperature_band_k if warm else None)
