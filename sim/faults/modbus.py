"""Faults of the Modbus lines and devices: silence, spoiled frames, exceptions, restarts."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.nodes.modbus_slave import ENDURANCE, ModbusSlave
from sim.wires.modbus_wire import Impairment, Kind, ModbusWire

REBOOT_S = 2.0
"""A transmitter or controller is silent this long after a dip in its supply, s [A]."""


def slave_of(scene: Scene, device: str) -> ModbusSlave:
    """Return the simulated device of this name."""
    return scene.rig.devices[device]


def line_of(scene: Scene, device: str) -> ModbusWire:
    """Return the line that a device is on."""
    slave = slave_of(scene, device)
    return next(line for line in scene.rig.lines.values() if line.has(slave))


class Impaired(Effect):
    """Transactions of one device are spoiled; other impairments of its line stay in force."""

    __slots__ = ("_impairment", "code", "count", "delay_s", "device", "kind")

    def __init__(self, device: str, kind: Kind, *, count: int = -1, delay_s: float = 0.05, code: int = 4) -> None:
        """Spoil the next ``count`` transactions (-1: all until the end)."""
        self.device = device
        self.kind: Kind = kind
        self.count = count
        self.delay_s = delay_s
        self.code = code
        self._impairment: Impairment | None = None

    def begin(self, scene: Scene, now: float) -> None:
        """Begin."""
        line = line_of(scene, self.device)
        unit_id = slave_of(scene, self.device).unit_id
        self._impairment = Impairment(
            self.kind, self.count, unit_id, delay_s=self.delay_s, code=self.code, besides=line.impair
        )
        line.impair = self._impairment

    def end(self, scene: Scene, now: float) -> None:
        """Leave it in its place and let it strike no more."""
        if self._impairment is not None:
            self._impairment.count = 0


class LateReply(Impaired):
    """Every reply of a device comes late."""

    __slots__ = ()

    def __init__(self, device: str, seconds: float) -> None:
        """By this much."""
        super().__init__(device, "late", delay_s=seconds)


class ExceptionReply(Impaired):
    """A device answers every request with an exception."""

    __slots__ = ()

    def __init__(self, device: str, code: int) -> None:
        """With this code."""
        super().__init__(device, "exception", code=code)


class LineGone(Effect):
    """The computer's serial adapter of a device's line is unplugged: every call fails."""

    __slots__ = ("device",)

    def __init__(self, device: str) -> None:
        """Of the line that this device is on."""
        self.device = device

    def begin(self, scene: Scene, now: float) -> None:
        """Unplug it."""
        line_of(scene, self.device).disconnect()

    def end(self, scene: Scene, now: float) -> None:
        """Plug it in again."""
        line_of(scene, self.device).reconnect()


class DeviceOff(Effect):
    """A device has lost its supply."""

    __slots__ = ("device",)

    def __init__(self, device: str) -> None:
        """This device."""
        self.device = device

    def begin(self, scene: Scene, now: float) -> None:
        """Switch it off."""
        slave_of(scene, self.device).power(False)

    def end(self, scene: Scene, now: float) -> None:
        """Switch it on."""
        slave_of(scene, self.device).power(True)


class DeviceReset(Effect):
    """A device restarts: silent for a while, then with the state of its power-on (a controller in standby)."""

    __slots__ = ("_until_s", "device")

    every_step = True

    def __init__(self, device: str) -> None:
        """This device."""
        self.device = device
        self._until_s = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Switch it off for its restart."""
        self._until_s = now + REBOOT_S
        slave_of(scene, self.device).power(False)

    def renew(self, scene: Scene, now: float) -> None:
        """Have it start when it is time."""
        if now >= self._until_s and not slave_of(scene, self.device).powered:
            slave_of(scene, self.device).power(True)


class MemoryWorn(Effect):
    """A device's non-volatile memory has been written too often: what it keeps cannot be changed any more."""

    __slots__ = ("device",)

    def __init__(self, device: str) -> None:
        """This device."""
        self.device = device

    def begin(self, scene: Scene, now: float) -> None:
        """Wear it out."""
        slave_of(scene, self.device).endurance = 0

    def end(self, scene: Scene, now: float) -> None:
        """Put in a new one."""
        slave_of(scene, self.device).endurance = ENDURANCE
