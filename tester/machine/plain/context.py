"""The context of a plain machine's steps, and its attendant, which does a person's work at the rig."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import ClassVar, Final, Protocol

from drivers.sensor import Sensor
from tester.base.quantities import Quantities
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.context import BaseContext
from tester.machine.plain.image import PlainDemand, PlainReadings
from tester.machine.prompts import Prompts
from tester.store.recorder import Recorder

SPEED_SHARE: Final = 0.02
"""Greatest deviation of a drive from its demanded speed while the gate stays open, as a share [A]."""


class PlainAttendant(Protocol):
    """A person's work at the rig. A simulated rig does it itself; on a real rig the calls do nothing. A kind adds its
    own.
    """

    def install(self, specimen: int, compound: str) -> None:
        """Mount a new specimen."""
        ...

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Mark the start of a repeat (keys of the simulator's random streams)."""
        ...


class PlainContext(BaseContext[PlainRig, PlainReadings, PlainDemand]):
    """The context of one run; only activities read and write it."""

    gate_bits: ClassVar[Mapping[str, int]] = {"speed": 1}

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
        """``sensors``: the names of the machine's own sensors."""
        super().__init__(rig, readings, PlainDemand(), prompts, journal)
        self.attendant = attendant
        self.quantities = quantities
        self.sensors = sensors

    def piece(self) -> tuple[int, float, float]:
        return self.mounted.number, nan, self.readings.slid_m

    def at_speed(self) -> bool:
        """Return whether every drive is at its demanded speed."""
        drives = self.readings.drives
        return all(abs(drives[name] - v) <= SPEED_SHARE * abs(v) for name, v in self.demand.speeds.items())

    def closed_gates(self) -> int:
        """Return the mask of closed gates: the gate is closed while a drive is not at its demanded speed."""
        return 0 if self.at_speed() else 1

    def touching(self) -> bool:
        """Return whether a motion is demanded; every scan is then recorded."""
        return bool(self.demand.speeds)
