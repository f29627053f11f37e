"""The twin of a plain machine on the wires of any rig: turning drives, and sensors for quantities of its plant."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from sim.faults.common import plain_language, with_sensors
from sim.faults.kinds import FaultKind
from sim.faults.language import FaultLanguage
from sim.hands import REPEAT, SPECIMEN, Verb
from sim.machines import SimulatedMachine
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_slave import PlantQuantity, SensorSlave
from sim.rig import RigSpec, SimRig, title_of
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
        self._shows = shows
        super().__init__(spec, plant, can_wire)

    def own_devices(self, spec: RigSpec) -> dict[str, ModbusSlave]:
        sensors: dict[str, ModbusSlave] = {}
        for name, channels in self._shows.items():
            device = spec.devices.get(name)
            if device is not None:
                shown = {channel: PlantQuantity(self.plant, quantity) for channel, quantity in channels.items()}
                sensors[name] = SensorSlave(device.profile, device.unit_id, shown)
        return sensors

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        return self.plant.ambient_c

    def follow(self, t1: float, still: bool) -> None:
        """Advance the plant with its drives to ``t1`` s."""
        elapsed, self.plant_s = t1 - self.plant_s, t1
        self.plant.advance(elapsed, {name: drive.axis.value for name, drive in self.axes.items()})

    def install(self, specimen: int, compound: str) -> None:
        """Mount a new specimen."""
        self.plant.install(specimen, compound)

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Restart the random streams and the sensors' dither for a repeat."""
        self.plant.begin_repeat(condition, repeat, attempt)
        self.restart_dither()


def plain_machine(
    plant: Callable[[Any, int], PlainPlant],
    shows: Mapping[str, Mapping[str, str]],
    faults: tuple[FaultKind, ...],
    log_columns: tuple[str, ...],
    log_row: Callable[..., tuple[float, ...]],
    log_decimals: tuple[int, ...],
    verbs: tuple[Verb, ...] = (SPECIMEN, REPEAT),
) -> SimulatedMachine:
    """Return a plain machine's simulation: its twin, and the language of the faults of its parts.

    ``plant``: makes the plant from the section ``sim`` and a seed; ``shows``: as for ``PlainTwin``; ``faults``: those
    beside the faults of any drive, sensor, bus and computer; the others: as for ``SimulatedMachine``.
    """

    def world(spec: RigSpec, parameters: Any, seed: int, can_wire: type[CanWire] = CanWire) -> PlainTwin:
        return PlainTwin(spec, plant(parameters, seed), shows, can_wire)

    def language(spec: RigSpec) -> FaultLanguage:
        sensors = [title_of(name) for name in shows if name in spec.devices]
        return with_sensors(plain_language(spec.axes, sensors, *faults), spec)

    return SimulatedMachine(world, language, log_columns, log_row, log_decimals, verbs)
