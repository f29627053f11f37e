"""The context of a plain machine's steps, and the hands at the rig."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import Final, Protocol

from drivers.sensor import Sensor
from tester.base.quantities import Quantities
from tester.inputs.recipe.plain_recipe import Mount
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.context import BaseContext
from tester.machine.plain.image import PlainDemand, PlainReadings
from tester.machine.prompts import Prompts
from tester.store.recorder import Recorder

SPEED_SHARE: Final = 0.02
"""Greatest deviation of a drive from its demanded speed with an open gate, as a share [A]."""
GATE_SPEED: Final = 1
"""Bit of that gate."""


class PlainAttendant(Protocol):
    """The hands at the rig: a person's work. A simulated rig does it itself; on a real one the calls do nothing."""

    def install(self, specimen: int, compound: str) -> None:
        """Put a new specimen on."""
        ...

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Mark the start of a repeat (keys of the simulator's random streams)."""
        ...


class PlainContext(BaseContext[PlainRig, PlainReadings, PlainDemand]):
    """One per run; only activities read and write it."""

    def __init__(
        self,
        rig: PlainRig,
        readings: PlainReadings,
        prompts: Prompts,
        journal: Recorder,
        attendant: PlainAttendant,
        quantities: Quantities,
        sensors: Mapping[str, Sensor],
    ) -> None:
        """``sensors``: the machine's own."""
        super().__init__(rig, readings, PlainDemand(), prompts, journal)
        self.attendant = attendant
        self.quantities = quantities
        self.sensors = sensors
        self.mounted: Mount | None = None

    def piece(self) -> tuple[int, float, float]:
        return (self.mounted.piece if self.mounted is not None else 0), nan, self.readings.slid_m

    def at_speed(self) -> bool:
        """Return whether every drive has its demanded speed."""
        drives = self.readings.drives
        return all(abs(drives[name] - v) <= SPEED_SHARE * abs(v) for name, v in self.demand.speeds.items())

    def closed_gates(self) -> int:
        """Return the mask: the gate is closed while a drive does not have its speed."""
        return 0 if self.at_speed() else GATE_SPEED

    def touching(self) -> bool:
        """Return whether a motion is demanded: then every scan is recorded."""
        return bool(self.demand.speeds)
