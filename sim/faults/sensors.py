"""Faults of sensors and temperature controllers: wrong readings, or wrong behaviour.

A spoiled source replaces the sound one; while a sensor is well, a reading needs no extra look-up.
"""

from __future__ import annotations

from collections import deque
from math import expm1, nan
from typing import Final, cast

from sim.faults.scene import Effect, Scene, switched
from sim.nodes.controller_slave import ControllerSlave, TemperatureSource
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_node import SimulatedSensorNode
from sim.nodes.sensor_slave import FORCES, CellSlave, ForceSource, IrSlave, Quantity, SensorSlave, SurfaceSource
from sim.noise import NormalStream
from sim.rig import SimRig, title_of

SLOW: Final = ("lag", "delay")
CROSSED: Final = ("exchanged x z", "reversed x", "reversed y", "reversed z")
"""Kinds for a load cell alone: faults of wiring and sign between its channels."""
SEED: Final = 402
"""Key of the random numbers of noisy sensors: the same in every run."""
_OFF_SCALE_N: Final = 1e5
"""A force beyond the range of every load cell here, N: the transmitter shows the end of its range."""


class Shows(Effect):
    """One channel of a further sensor shows a fixed number in place of its reading."""

    def __init__(self, sensor: str, channel: str, value: float) -> None:
        """Take the sensor's name for people, the channel's in its profile, and the number in the channel's unit."""
        self._sensor, self._channel, self._value = sensor, channel, value
        self._sound: Quantity | float = nan

    def begin(self, scene: Scene, now: float) -> None:
        """Replace the channel's source."""
        self._sound = self._slave(scene).show(self._channel, self._value)

    def end(self, scene: Scene, now: float) -> None:
        """Put the source back."""
        self._slave(scene).show(self._channel, self._sound)

    def _slave(self, scene: Scene) -> SensorSlave:
        return cast("SensorSlave", scene.rig.slave(self._sensor))


class NodeShows(Effect):
    """One channel of a further CANopen node shows a fixed number in place of its own."""

    def __init__(self, node: str, channel: str, value: float) -> None:
        """Take the node's name for people, the channel's, and the number in the channel's unit."""
        self._node, self._channel, self._value = node, channel, value

    def begin(self, scene: Scene, now: float) -> None:
        """Replace the channel's value."""
        _node(scene, self._node).show({self._channel: self._value})

    def end(self, scene: Scene, now: float) -> None:
        """Show what is configured again."""
        _node(scene, self._node).show({})


@switched
def node_off(scene: Scene, on: bool, now: float, node: str) -> None:
    """A further CANopen node has no supply."""
    _node(scene, node).power(not on)


def _node(scene: Scene, title: str) -> SimulatedSensorNode:
    return next(node for node in scene.rig.nodes if title_of(node.config.name) == title)


class Slow:
    """Readings through a first-order filter ("lag"), or from some time ago ("delay")."""

    def __init__(self, kind: str, seconds: float) -> None:
        """Take the time constant, or the delay, s (at least 0)."""
        self._delays = kind == "delay"
        self._seconds = max(seconds, 1e-9)
        self._held: tuple[float, ...] = ()
        self._last_s = 0.0
        self._past: deque[tuple[float, tuple[float, ...]]] = deque()

    def shown(self, readings: tuple[float, ...], t: float) -> tuple[float, ...]:
        """Return the readings shown at ``t`` s; ``readings`` are the sensor's true ones at that time."""
        if self._delays:
            past = self._past
            past.append((t, readings))
            while len(past) > 1 and past[1][0] <= t - self._seconds:
                past.popleft()
            return past[0][1]
        if self._held:
            share = -expm1((self._last_s - t) / self._seconds)
            self._held = tuple(h + (r - h) * share for h, r in zip(self._held, readings, strict=True))
        else:
            self._held = readings
        self._last_s = t
        return self._held


def spoiled(kind: str, value: float, size: float, age_s: float, noise: NormalStream, floor: float) -> float:
    """Return the spoiled reading of ``value``: off by ``size``, drifting by ``size`` a second, noisy (rms ``size``),
    low (the share of ``size`` percent above ``floor`` is missing), with a gain of ``size`` percent above ``floor``, off
    scale, or nothing (not a number)."""
    if kind == "offset":
        return value + size
    if kind == "drift":
        return value + size * age_s
    if kind == "noise":
        return value + size * noise.next()
    if kind == "low":
        return floor + (value - floor) * (1.0 - 0.01 * size)
    if kind == "gain":
        return floor + (value - floor) * 0.01 * size
    return _OFF_SCALE_N if kind == "saturated" else nan


class _Spoiled:
    """A faulty source of a sensor; when ``active`` is false, its readings are right again."""

    def __init__(self, kind: str, size: float, since_s: float, middle: float, name: str) -> None:
        """Take kind and size; shares count from ``middle`` (0 N, or degC); ``name`` keys the noise."""
        self.kind, self.active = kind, True
        self._size, self._since_s, self._middle = size, since_s, middle
        self._noise = NormalStream(SEED, f"faulty {name}")
        self._slow = Slow(kind, size) if kind in SLOW else None

    def spoil(self, true: float, t: float) -> float:
        """Return the spoiled reading of a true value at ``t`` s."""
        return spoiled(self.kind, true, self._size, t - self._since_s, self._noise, self._middle)

    @property
    def _steady(self) -> bool:
        """Whether a value at rest is shown unchanged, except for noise."""
        return not self.active or self.kind == "noise" or self._slow is not None or self.kind in CROSSED


class SpoiledForces(_Spoiled):
    """A load cell with a fault of one force, or of all channels."""

    def __init__(self, source: ForceSource, kind: str, size: float = 0.0, since_s: float = 0.0, force: str = "fz",
                 name: str = "load cell") -> None:  # fmt: skip
        """Replace ``source``; ``force``: the faulty force, "" for all three."""
        super().__init__(kind, size, since_s, 0.0, name)
        self.source = source
        self._places = (FORCES.index(force),) if force else (0, 1, 2)

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return Fx, Fy, Fz in N and the moment in N m as shown at ``t`` s."""
        forces = x, y, z, m = self.source.forces_measured(t)
        if not self.active:
            return forces
        if self._slow is not None:
            x, y, z, m = self._slow.shown(forces, t)
        elif self.kind in CROSSED:
            x, y, z, m = _crossed(self.kind, x, y, z, m)
        else:
            shown = list(forces)
            for place in self._places:
                shown[place] = self.spoil(shown[place], t)
            x, y, z, m = shown
        return x, y, z, m

    def shown_n(self, true_n: float, t: float) -> float:
        """Return the shown value of a force of ``true_n`` at ``t`` s, without noise, N; NaN: nothing."""
        return true_n if self._steady else self.spoil(true_n, t)


class SpoiledTemperature(_Spoiled):
    """A temperature sensor with a fault; it replaces the plant as the source of a device."""

    def __init__(self, source: SurfaceSource | TemperatureSource, kind: str, size: float, since_s: float,
                 ambient_c: float, name: str) -> None:  # fmt: skip
        """Replace ``source``; shares count from ``ambient_c``."""
        super().__init__(kind, size, since_s, ambient_c, name)
        self.source = source
        self._held_c: float = nan

    def surface_measured_c(self, t: float) -> float:
        """Return the surface temperature in degC as shown."""
        return self._appears(cast("SurfaceSource", self.source).surface_measured_c(t), t)

    def controller_measured_c(self, t: float) -> float:
        """Return the controlled temperature in degC as shown."""
        return self._appears(cast("TemperatureSource", self.source).controller_measured_c(t), t)

    def off_k(self, true_c: float, t: float) -> float:
        """Return the error of the reading for ``true_c`` degC at ``t`` s, without noise, K; NaN: no reading."""
        return 0.0 if self._steady else self._appears(true_c, t) - true_c

    def _appears(self, true_c: float, t: float) -> float:
        if not self.active:
            return true_c
        if self._slow is not None:
            return self._slow.shown((true_c,), t)[0]
        if self.kind == "frozen":
            self._held_c = self._held_c if self._held_c == self._held_c else true_c
            return self._held_c
        return self.spoil(true_c, t)


class SpoiledQuantity(_Spoiled):
    """The faulty source of a further sensor's channel: ``source`` is the sound one."""

    def __init__(self, kind: str, size: float, since_s: float, rig: SimRig, name: str) -> None:
        """``rig``: the machine, for its time; shares count from 0."""
        super().__init__(kind, size, since_s, 0.0, name)
        self.source: Quantity | float = nan
        self._rig = rig

    def __call__(self) -> float:
        """Return the reading in the channel's unit."""
        true = self.source if isinstance(self.source, float | int) else self.source()
        return self.spoil(true, self._rig.now_s) if self.active else true


def _crossed(kind: str, x: float, y: float, z: float, m: float) -> tuple[float, float, float, float]:
    """Return the channels of a load cell whose wires are crossed."""
    if kind == "reversed x":
        return -x, y, z, m
    if kind == "reversed y":
        return x, -y, z, m
    return (x, y, -z, m) if kind == "reversed z" else (z, y, x, m)


class SensorFault(Effect):
    """A fault of a device's sensor, or of one force of a load cell, until the fault ends.

    On a rig without the device it has no effect.
    """

    def __init__(self, device: str, kind: str, size: float = 0.0, force: str = "fz") -> None:
        """``kind``: of ``spoiled``, SLOW or CROSSED, or "frozen"; ``size``: unit of the sensor, or a second, %, s."""
        self.device, self.kind, self.size, self.force = device, kind, size, force
        self._wrapped: SpoiledForces | SpoiledTemperature | None = None

    def slave(self, scene: Scene) -> ModbusSlave | None:
        """Return the device, or None."""
        return scene.rig.devices.get(self.device)

    def begin(self, scene: Scene, now: float) -> None:
        """Replace the sensor's source from now on."""
        slave = self.slave(scene)
        if isinstance(slave, SensorSlave) and self.kind == "frozen":
            slave.frozen = True
        elif isinstance(slave, CellSlave):
            # A broken bridge drives the amplifier to the end of its range.
            kind = "saturated" if self.kind == "open" else self.kind
            self._wrapped = slave.source = SpoiledForces(slave.source, kind, self.size, now, self.force, self.device)
        elif isinstance(slave, IrSlave | ControllerSlave):
            self._wrapped = slave.source = SpoiledTemperature(
                slave.source, self.kind, self.size, now, scene.rig.ambient_c, self.device
            )

    def end(self, scene: Scene, now: float) -> None:
        """Show the true values again."""
        slave = self.slave(scene)
        if self._wrapped is not None:
            self._wrapped.active = False
        elif isinstance(slave, SensorSlave):
            slave.frozen = False


class QuantityFault(Effect):
    """A fault of one channel of a machine's sensor that is neither a load cell nor a thermometer.

    On a rig without the device it has no effect.
    """

    def __init__(self, device: str, channel: str, kind: str, size: float = 0.0) -> None:
        """``kind``: of ``spoiled``; ``size``: in the channel's unit, or a second of it."""
        self._device, self._channel, self._kind, self._size = device, channel, kind, size
        self._wrong: SpoiledQuantity | None = None

    def begin(self, scene: Scene, now: float) -> None:
        """Replace the channel's source from now on."""
        slave = scene.rig.devices.get(self._device)
        if isinstance(slave, SensorSlave):
            wrong = SpoiledQuantity(self._kind, self._size, now, scene.rig, f"{self._device} {self._channel}")
            wrong.source = slave.show(self._channel, wrong)
            self._wrong = wrong

    def end(self, scene: Scene, now: float) -> None:
        """Show the true values again."""
        if self._wrong is not None:
            self._wrong.active = False


@switched
def controller_output(scene: Scene, on: bool, now: float, device: str, percent: float) -> None:
    """A temperature controller's output is stuck at ``percent`` (below 0 cooling), whatever its loop computes.

    Its registers show this output. On a rig without the device the fault has no effect.
    """
    slave = scene.rig.devices.get(device)
    if isinstance(slave, ControllerSlave):
        slave.stuck_output = percent if on else None
