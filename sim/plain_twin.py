"""The twin of a plain machine on the wires of any rig: turning drives, and sensors for quantities of its plant."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.sensor_slave import PlantQuantity, SensorSlave
from sim.rig import RigSpec, SimRig
from sim.wires.can_wire import CanWire


class PlainPlant(Protocol):
    """The physics between the drives' shafts and the sensors: each kind has its own."""

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the plant, degC."""
        ...

    def advance(self, dt: float, speeds: Mapping[str, float]) -> None:
        """Advance by ``dt`` s; ``speeds``: each drive's speed at the end, in the unit of its axis."""
        ...

    def install(self, specimen: int, compound: str) -> None:
        """Mount a new specimen; ``specimen`` keys its scatter. Raises ValueError for an unknown compound."""
        ...

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Start the random streams of a repeat."""
        ...


class PlainTwin(SimRig):
    """A plain machine on simulated wires, with the actions of its attendant."""

    def __init__(
        self,
        spec: RigSpec,
        plant: PlainPlant,
        shows: Mapping[str, Mapping[str, str]],
        can_wire: type[CanWire] = CanWire,
    ) -> None:
        """Switch everything on at time 0.

        ``shows``: quantities of the plant by channel, for each of the machine's own sensors by its name in the wiring.
        Raises UnknownQuantityError for a quantity that the plant does not have.
        """
        self.plant = plant
        self._plant_s = 0.0
        can = can_wire(spec.bitrate)
        axes = {name: Cia402Slave(axis, can, serial_number=axis.node_id) for name, axis in spec.axes.items()}
        wired = {name: _sensor(spec, name, plant, channels) for name, channels in shows.items() if name in spec.devices}
        devices = {name.replace("_", " "): slave for name, slave in wired.items()}
        super().__init__(spec, can, axes, wired, devices, plant)

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        return self.plant.ambient_c

    def follow(self, t1: float, still: bool) -> None:
        """Advance the plant with its drives to ``t1`` s."""
        elapsed, self._plant_s = t1 - self._plant_s, t1
        self.plant.advance(elapsed, {name: drive.axis.value for name, drive in self.axes.items()})

    def install(self, specimen: int, compound: str) -> None:
        """Mount a new specimen."""
        self.plant.install(specimen, compound)

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Restart the random streams and the sensors' dither for a repeat."""
        self.plant.begin_repeat(condition, repeat, attempt)
        self.restart_dither()


def _sensor(spec: RigSpec, name: str, plant: PlainPlant, channels: Mapping[str, str]) -> SensorSlave:
    device = spec.devices[name]
    shown = {channel: PlantQuantity(plant, quantity) for channel, quantity in channels.items()}
    return SensorSlave(device.profile, device.unit_id, shown)
