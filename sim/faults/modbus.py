"""Faults of the Modbus lines and devices: silence, spoiled frames, exceptions, restarts."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene, switched
from sim.nodes.modbus_slave import ENDURANCE, ModbusSlave
from sim.wires.modbus_wire import Impairment, Kind, ModbusWire

REBOOT_S = 2.0
"""Silence of a transmitter or controller after a dip in its supply, s [A]."""


def slave_of(scene: Scene, device: str) -> ModbusSlave:
    """Return the simulated device of this name."""
    return scene.rig.slave(device)


def line_of(scene: Scene, device: str) -> ModbusWire:
    """Return the line that a device is on."""
    slave = slave_of(scene, device)
    return next(line for line in scene.rig.lines.values() if line.has(slave))


class Impaired(Effect):
    """Transactions of one device are spoiled; other impairments of its line stay in force."""

    def __init__(self, device: str, kind: Kind, *, count: int = -1, delay_s: float = 0.05, code: int = 4) -> None:
        """Spoil the next ``count`` transactions (-1: all until the end)."""
        self.device = device
        self.kind: Kind = kind
        self.count = count
        self.delay_s = delay_s
        self.code = code
        self._impairment: Impairment | None = None

    def begin(self, scene: Scene, now: float) -> None:
        """Put the impairment on the line."""
        line = line_of(scene, self.device)
        unit_id = slave_of(scene, self.device).unit_id
        self._impairment = Impairment(
            self.kind, self.count, unit_id, delay_s=self.delay_s, code=self.code, besides=line.impair
        )
        line.impair = self._impairment

    def end(self, scene: Scene, now: float) -> None:
        """Leave it on the line, without effect."""
        if self._impairment is not None:
            self._impairment.count = 0


def late_reply(device: str, seconds: float) -> Impaired:
    """Every reply of a device comes later by this time, s."""
    return Impaired(device, "late", delay_s=seconds)


def exception_reply(device: str, code: float) -> Impaired:
    """A device answers every request with the exception ``code`` (a whole number)."""
    return Impaired(device, "exception", code=round(code))


@switched
def line_gone(scene: Scene, on: bool, now: float, device: str) -> None:
    """The computer's serial adapter of a device's line is unplugged: every call fails."""
    line = line_of(scene, device)
    if on:
        line.disconnect()
    else:
        line.reconnect()


@switched
def device_off(scene: Scene, on: bool, now: float, device: str) -> None:
    """A device has lost its supply."""
    slave_of(scene, device).power(not on)


@switched
def memory_worn(scene: Scene, on: bool, now: float, device: str) -> None:
    """A device's non-volatile memory is worn out: the values in it cannot be changed."""
    slave_of(scene, device).endurance = 0 if on else ENDURANCE


class DeviceReset(Effect):
    """A device restarts: it is silent for a while, then in its power-on state (a controller in standby)."""

    every_step = True

    def __init__(self, device: str) -> None:
        """Take the name of the device."""
        self.device = device
        self._until_s = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Switch the device off for its restart."""
        self._until_s = now + REBOOT_S
        slave_of(scene, self.device).power(False)

    def renew(self, scene: Scene, now: float) -> None:
        """Switch the device on when its off time is over."""
        if now >= self._until_s and not slave_of(scene, self.device).powered:
            slave_of(scene, self.device).power(True)
