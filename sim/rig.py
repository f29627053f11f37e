"""A simulated machine: wires, drives and Modbus devices, advanced together with its mechanics.

Order within one advance: drives move (and send frames that are due), devices with a control loop run it, the machine
follows. Its reactions (torque, forces, temperatures) are ready when the next request arrives on a wire. This module
does not know the kind of machine: see ``sim.machines``.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass, field
from math import floor, inf
from typing import TYPE_CHECKING, Final

from drivers.axis import AxisConfig
from drivers.canopen.node_config import NodeConfig
from drivers.profiles import DeviceProfile
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_node import SimulatedSensorNode
from sim.nodes.sensor_slave import PlantQuantity, Quantity, SensorSlave
from sim.wires.can_wire import CanWire
from sim.wires.modbus_wire import ModbusWire

if TYPE_CHECKING:
    from sim.physics.laws import LawSetting

SHORTEST_STEP_S: Final = 1e-3
LONGEST_STEP_S: Final = 0.1
"""Least and greatest step of the machine, s."""
_SHORTEST_S: Final = SHORTEST_STEP_S - 1e-9
LEAP_STEP_S: Final = 0.125
"""Step of the machine in a leap, s [A]: only heat flows, and a controller's loop has the same cycle."""


@dataclass(frozen=True, slots=True)
class LineSpec:
    """One Modbus line: the data that its wire times depend on."""

    baud: int
    byte_bits: int = 10
    """Bits of a frame's byte on the line: 8 data bits, no parity, 1 stop bit."""
    held_s: float = 0.0
    """Time for which the computer's adapter holds received bytes back, s."""


@dataclass(frozen=True, slots=True)
class DeviceSpec:
    """One Modbus device: profile, line and address."""

    profile: DeviceProfile
    line: str
    unit_id: int
    shows: Mapping[str, str | float] = field(default_factory=dict[str, str | float])
    """For a further sensor, by channel: a quantity of the plant, or a number in the channel's unit."""
    part_of: str = ""
    """For a transmitter of a load cell with several: the machine's device that it is a part of."""
    channels: Mapping[str, str] = field(default_factory=dict[str, str])
    """For such a transmitter: the machine's names of the profile's channels, if they differ."""


@dataclass(frozen=True, slots=True)
class ShareSpec:
    """What some devices and axes have in common, such as a supply, and their names in the wiring."""

    shared: str
    members: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RigSpec:
    """The connections of a rig: its wiring, without any software's settings."""

    bitrate: int
    axes: Mapping[str, AxisConfig]
    lines: Mapping[str, LineSpec]
    devices: Mapping[str, DeviceSpec]
    """Devices by the names in the rig file's section ``devices``."""
    nodes: tuple[NodeConfig, ...] = ()
    """Further nodes on the CAN bus, which measure."""
    inputs: frozenset[str] = frozenset()
    """Channels of sensors and nodes that are safety inputs, by their names in the record."""
    further: tuple[str, ...] = ()
    """Sensors besides the machine's own devices, by the same names."""
    shares: Mapping[str, ShareSpec] = field(default_factory=dict[str, ShareSpec])
    """What fails together, by the names in the rig file's section ``shares``."""


class SimRig:
    """A simulated machine on its wires: drives, Modbus devices and nodes, advanced together. Each kind derives its own.

    ``can`` and ``lines`` are the ports that a program opens. ``axes`` and ``devices`` have names for people as keys,
    ``sensors`` (beyond the machine's own) those of the wiring. ``now_s``: time to which everything has been advanced,
    s; ``plant_s``: time of the plant, which a kind advances. Both are times on the wires, which stand still in a leap.
    """

    __slots__ = (
        "_dithered", "_drives", "_served", "_timed", "axes", "can", "devices", "leapt_s", "lines", "nodes", "now_s",
        "plant_s", "sensors", "wired",
    )  # fmt: skip

    def __init__(self, spec: RigSpec, plant: object, can_wire: type[CanWire]) -> None:
        """Switch everything on at time 0; ``can_wire``: the class of the bus, another one for faults.

        ``plant`` has the quantities of further sensors; raises UnknownQuantityError for a quantity that it does not
        have.
        """
        self.can = can_wire(spec.bitrate)
        self.axes = {name: self.drive(name, config) for name, config in spec.axes.items()}
        wired = self.own_devices(spec)
        self.devices = {title_of(name): slave for name, slave in wired.items()}
        self.sensors = further_sensors(spec, wired, plant)
        self.nodes = [SimulatedSensorNode(config, self.can) for config in spec.nodes]
        self.wired = every = {**wired, **self.sensors}
        """Every Modbus device, by the names of the wiring."""
        self.lines = lines_of(spec, every)
        self.now_s = self.plant_s = 0.0
        self.leapt_s = 0.0
        """Rig time that has passed without the wires; ``now_s`` and ``plant_s`` are times on the wires."""
        self._served: dict[str, dict[int, int]] = {}
        self._drives = tuple(self.axes.values())
        self._timed = tuple(slave for slave in every.values() if slave.due_s < inf)
        self._dithered = tuple(
            slave for slave in every.values() if isinstance(slave, SensorSlave)
        )

    def drive(self, name: str, config: AxisConfig) -> Cia402Slave:
        """Return the drive of an axis; by default it turns without a load."""
        return Cia402Slave(config, self.can, serial_number=config.node_id)

    def slave(self, title: str) -> ModbusSlave:
        """Return a device by its name for people; raises KeyError."""
        if title in self.devices:
            return self.devices[title]
        return {title_of(name): slave for name, slave in self.wired.items()}[title]

    def own_devices(self, spec: RigSpec) -> dict[str, ModbusSlave]:
        """Return the machine's own devices by their keys in the wiring."""
        raise NotImplementedError

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        raise NotImplementedError

    @property
    def by_surface(self) -> bool:
        """Whether friction asks for the surface or for files of materials; ``take`` gives both."""
        return False

    def take(self, setting: LawSetting) -> None:
        """Set the source of the materials, before a specimen is mounted."""

    @property
    def urgent_s(self) -> float:
        """Arrival of the next frame that a scan should not wait for, rig s."""
        return self.can.urgent_s + self.leapt_s

    def advance(self, now: float) -> None:
        """Advance everything to ``now`` (rig s); a step shorter than a millisecond waits for the next one."""
        now -= self.leapt_s
        t0 = self.now_s
        elapsed = now - t0
        if elapsed < _SHORTEST_S:
            return
        ends: tuple[float, ...] = (now,) if elapsed <= LONGEST_STEP_S else _cut(t0, now)
        for t1 in ends:
            self.now_s = t1
            still = True
            for drive in self._drives:
                axis = drive.axis
                if drive.due_s <= t1:
                    drive.advance(t0, t1)
                elif drive.watching:
                    drive.move(t0, t1)
                else:
                    drive.now_s = t1
                    if axis.still:
                        continue
                    if axis.settled and not axis.bounded:  # as nearly always: what its step does then, without the call
                        axis.position += axis.value * (t1 - t0)
                    else:
                        axis.step(t1 - t0)
                    drive.pdos.stale = True
                if not axis.still:
                    still = False
            for node in self.nodes:
                node.advance(t0, t1)
            for device in self._timed:
                if device.due_s <= t1:
                    device.advance(t0, t1)
            self.follow(t1, still)
            t0 = t1

    # leaps -----------------------------------------------------------------------------------------------------

    def count_readings(self) -> None:
        """Begin to count how often each device is read."""
        self._served = {name: slave.served() for name, slave in self.wired.items()}

    def readings_since(self) -> dict[str, dict[int, int]]:
        """Return how often each block of each device was read since ``count_readings``."""
        return {
            name: {block: count - self._served[name].get(block, 0) for block, count in slave.served().items()}
            for name, slave in self.wired.items()
        }

    def leap(self, seconds: float, each: Mapping[str, Mapping[int, int]]) -> None:
        """Let time pass in which drives and wires do not change: heat flows, and controllers run their loops.

        ``seconds``: a multiple of the controllers' cycles and of the plant's step. ``each``: how often each block of
        each device would have been read in this time; the noise of these readings is drawn.
        """
        steps = round(seconds / LEAP_STEP_S)
        still = all(drive.axis.still for drive in self._drives)
        begin = self.now_s
        for i in range(1, steps + 1):
            t1 = begin + i * LEAP_STEP_S
            for device in self._timed:
                if device.due_s <= t1:
                    device.leap(t1, begin)
            self.follow(t1, still)
        for name, blocks in each.items():
            for block, count in blocks.items():
                self.wired[name].draw(block, count, begin)
        for device in self._timed:
            device.due_s -= seconds
        self.put_back(seconds)
        self.leapt_s += seconds

    def put_back(self, seconds: float) -> None:
        """Put the plant's clock back to that of the wires, after a leap of ``seconds``."""
        self.plant_s -= seconds

    def follow(self, t1: float, still: bool) -> None:
        """Advance the plant to ``t1`` s with the drives as they are then, and load their shafts; ``still``: no drive
        moves."""
        raise NotImplementedError

    def restart_dither(self) -> None:
        """Begin every sensor's dither anew: a repeat must not depend on readings before it."""
        for sensor in self._dithered:
            sensor.dither = 0


def _cut(start: float, now: float) -> tuple[float, ...]:
    """Return the ends of equal steps from ``start`` to ``now`` s, none longer than the longest."""
    elapsed = now - start
    steps = 1 + floor(elapsed / LONGEST_STEP_S)
    return (*(start + elapsed * i / steps for i in range(1, steps)), now)


def title_of(device: str) -> str:
    """Return a device's name for people from its key in the wiring."""
    return device.replace("_", " ")


def further_sensors(spec: RigSpec, own: Container[str], plant: object) -> dict[str, SensorSlave]:
    """Return the sensors of a wiring besides the machine's ``own`` devices, by the wiring's names.

    Raises UnknownQuantityError for a quantity that the plant does not have.
    """
    found: dict[str, SensorSlave] = {}
    for name, device in spec.devices.items():
        if name not in own and not device.part_of:
            quantities: dict[str, Quantity | float] = {}
            for channel, shown in device.shows.items():
                quantities[channel] = PlantQuantity(plant, shown) if isinstance(shown, str) else shown
            found[name] = SensorSlave(device.profile, device.unit_id, quantities)
    return found


def lines_of(spec: RigSpec, devices: Mapping[str, ModbusSlave]) -> dict[str, ModbusWire]:
    """Return the Modbus lines of a wiring, each with its devices; ``devices`` by the wiring's names."""
    return {
        name: ModbusWire(
            line.baud,
            slaves=[slave for key, slave in devices.items() if spec.devices[key].line == name],
            held_s=line.held_s,
            byte_bits=line.byte_bits,
        )
        for name, line in spec.lines.items()
    }
