"""Interlocks of the safety inputs that a rig file names: each is a row of its own, beside those of the kind."""

from __future__ import annotations

from math import nan
from typing import Any

from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import further_channels
from tester.inputs.rig.safety_input import CLOSED, SafetyInput, title_of_input
from tester.machine.interlock_table import InterlockTable
from tester.machine.row import ACK, CONTROLLED, FAST, Interlock
from tester.machine.watches import condition
from tester.machine.wires import SAFETY_CHAIN


def table_on(rig: Rig, table: InterlockTable) -> InterlockTable:
    """Return the interlock table of a rig: its kind's, and after the safety chain a row for each safety input."""
    if not rig.safety_inputs:
        return table
    place = next((i + 1 for i, row in enumerate(table.rows) if row.name == SAFETY_CHAIN.name), 0)
    rows = [_row(name, one) for name, one in rig.safety_inputs.items()]
    return InterlockTable((*table.rows[:place], *rows, *table.rows[place:]), table.operation)


def _row(name: str, one: SafetyInput) -> Interlock[Any]:
    title, channel = title_of_input(name), one.channel

    def is_open(v: Any) -> bool:
        return bool(v.further(v.readings.channels, channel) != CLOSED)  # also where it is not known (NaN)

    return Interlock(
        name=title,
        cause="its contact is open, or its input is not known",
        watch=condition(f"channel {channel} is not 1", is_open),
        reaction=CONTROLLED if one.reaction == "controlled" else FAST,
        reset=ACK,
        applies=_driven if one.open_at_rest else None,
        unseen=True,
        channels=(channel,),
    )


def _driven(v: Any) -> bool:
    return bool(v.demand.enabled)


class InputStates:
    """The state of a rig's safety inputs, from the readings of its further channels."""

    def __init__(self, rig: Rig) -> None:
        """Find the channels of the inputs. Raises ProfileError."""
        names = [channel.name for channel in further_channels(rig)] if rig.safety_inputs else []
        self.size = len(names)
        """Number of the rig's further channels; 0 without safety inputs."""
        self._places = {title_of_input(name): names.index(one.channel) for name, one in rig.safety_inputs.items()}
        self._doors = {title_of_input(name) for name, one in rig.safety_inputs.items() if one.open_at_rest}

    def closed(self, channels: list[float]) -> dict[str, bool]:
        """Return whether each input is closed, by its name, in ``Readings.channels``."""
        known = [*channels, *[nan] * (self.size - len(channels))]
        return {name: known[place] == CLOSED for name, place in self._places.items()}

    def open_door(self, channels: list[float]) -> str:
        """Return the first input that is open and may be so at rest, as a second door may; "" for none."""
        return next((name for name, shut in self.closed(channels).items() if not shut and name in self._doors), "")
