"""Faults of the sensors: what they show instead of what is. Sensors are wrapped; nothing is looked up per reading
while they are well."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from math import expm1, nan
from typing import cast

from sim.faults.scene import Effect, Scene
from sim.nodes.cell_slave import ForceSource
from sim.nodes.ir_slave import SurfaceSource
from sim.nodes.jacket_slave import HubSource
from sim.noise import NormalStream

Forces = tuple[float, float, float, float]
KINDS = ("offset", "drift", "noise", "low", "gain", "lag", "delay", "open", "saturated", "frozen")
CROSSED = ("exchanged x z", "reversed x", "reversed y", "reversed z")
"""Kinds of a load cell alone: its channels as they should not be."""
_SLOW = ("lag", "delay")
_SEED = 402
"""Key of the random numbers of noisy sensors: the same in every run."""
DETACHED_S = 20.0
"""Time constant of a hub sensor that has come loose, s [A]: the fixed one's is 1 s."""
_OFF_SCALE_N = 1e5
"""More than any load cell here can show, N: the transmitter shows the end of its range."""


class Slow:
    """Readings that come through a filter of first order ("lag"), or as they were some time ago ("delay")."""

    __slots__ = ("_delays", "_held", "_last_s", "_past", "_seconds")

    def __init__(self, kind: str, seconds: float) -> None:
        """With this time constant, or this late, s (at least 0)."""
        self._delays = kind == "delay"
        self._seconds = max(seconds, 1e-9)
        self._held: tuple[float, ...] = ()
        self._last_s = 0.0
        self._past: deque[tuple[float, tuple[float, ...]]] = deque()

    def shown(self, readings: tuple[float, ...], t: float) -> tuple[float, ...]:
        """Return what is shown at ``t`` s where the sensor has these readings now."""
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


@dataclass(slots=True)
class SpoiledForces:
    """A load cell with something wrong with its normal force, or all channels: what it measures and makes of it."""

    source: ForceSource
    kind: str
    value: float
    since_s: float
    noise: NormalStream
    slow: Slow | None = None
    active: bool = True

    def forces_measured(self, t: float) -> Forces:
        """Return Fx, Fy, Fz in N and the moment in N m as they appear at ``t`` s."""
        x, y, z, m = self.source.forces_measured(t)
        if not self.active:
            return x, y, z, m
        if self.slow is not None:
            x, y, z, m = self.slow.shown((x, y, z, m), t)
            return x, y, z, m
        if self.kind in CROSSED:
            return _crossed(self.kind, x, y, z, m)
        return x, y, spoiled(self.kind, z, self.value, t - self.since_s, self.noise, 0.0), m

    def shown_n(self, true_n: float, t: float) -> float:
        """Return what it makes of a normal force of ``true_n`` at ``t`` s, noise left out, N; NaN: nothing."""
        if not self.active or self.kind == "noise" or self.slow is not None or self.kind in CROSSED:
            return true_n
        return spoiled(self.kind, true_n, self.value, t - self.since_s, self.noise, 0.0)


@dataclass(slots=True)
class SpoiledTemperature:
    """A temperature sensor with something wrong; it stands in for the plant where a device asks for it."""

    source: SurfaceSource | HubSource
    kind: str
    value: float
    since_s: float
    ambient_c: float
    noise: NormalStream
    held_c: float = nan
    slow: Slow | None = None
    active: bool = True

    def surface_measured_c(self, t: float) -> float:
        """Return the surface temperature in degC as it appears."""
        return self._spoil(cast("SurfaceSource", self.source).surface_measured_c(t), t)

    def hub_measured_c(self, t: float) -> float:
        """Return the hub temperature in degC as it appears."""
        return self._spoil(cast("HubSource", self.source).hub_measured_c(t), t)

    def off_k(self, true_c: float, t: float) -> float:
        """Return how far from ``true_c`` degC the sensor shows at ``t`` s, its noise left out, K; NaN: nothing."""
        if not self.active or self.kind == "noise" or self.slow is not None:
            return 0.0
        return self._spoil(true_c, t) - true_c

    def _spoil(self, true_c: float, t: float) -> float:
        if not self.active:
            return true_c
        if self.slow is not None:
            return self.slow.shown((true_c,), t)[0]
        if self.kind == "frozen":
            self.held_c = self.held_c if self.held_c == self.held_c else true_c
            return self.held_c
        return spoiled(self.kind, true_c, self.value, t - self.since_s, self.noise, self.ambient_c)


def spoiled(kind: str, value: float, size: float, age_s: float, noise: NormalStream, floor: float) -> float:
    """Return what a sensor shows of ``value``: off by ``size``, drifting by ``size`` a second, noisy (rms ``size``),
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


def _crossed(kind: str, x: float, y: float, z: float, m: float) -> Forces:
    """Return the channels of a load cell whose wires are crossed."""
    if kind == "reversed x":
        return -x, y, z, m
    if kind == "reversed y":
        return x, -y, z, m
    return (x, y, -z, m) if kind == "reversed z" else (z, y, x, m)


class SensorFault(Effect):
    """Something is wrong with a sensor: what asks for it is given a spoiled one instead, until the fault ends."""

    __slots__ = ("_wrapped", "kind", "value")

    def __init__(self, kind: str, value: float = 0.0) -> None:
        """``kind`` of KINDS (or CROSSED), of this size (unit of the sensor, or that a second, or percent, or s)."""
        self.kind = kind
        self.value = value
        self._wrapped: SpoiledForces | SpoiledTemperature | None = None

    def _spoiled(self, source: SurfaceSource | HubSource, name: str, scene: Scene, now: float) -> SpoiledTemperature:
        """Put a thermometer's source into wrapping; ``name`` keys its noise."""
        ambient_c, noise = scene.rig.plant.parameters.ambient, NormalStream(_SEED, f"faulty {name}")
        self._wrapped = wrapped = SpoiledTemperature(
            source, self.kind, self.value, now, ambient_c, noise, slow=self._slow()
        )
        return wrapped

    def _slow(self) -> Slow | None:
        return Slow(self.kind, self.value) if self.kind in _SLOW else None

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        if self._wrapped is not None:
            self._wrapped.active = False


class CellFault(SensorFault):
    """Something is wrong with the normal force of the load cell (N, N/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        cell = scene.rig.cell
        if self.kind == "frozen":
            cell.frozen = True
            return
        # A broken bridge drives the amplifier to the end of its range.
        kind = "saturated" if self.kind == "open" else self.kind
        noise = NormalStream(_SEED, "faulty cell")
        self._wrapped = cell.source = SpoiledForces(cell.source, kind, self.value, now, noise, self._slow())

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        super().end(scene, now)
        if self.kind == "frozen":
            scene.rig.cell.frozen = False


class SurfaceFault(SensorFault):
    """Something is wrong with the infrared thermometer (K, K/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        ir = scene.rig.ir
        if self.kind == "frozen":
            ir.frozen = True
        else:
            ir.source = self._spoiled(ir.source, "thermometer", scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        super().end(scene, now)
        if self.kind == "frozen":
            scene.rig.ir.frozen = False


class HubFault(SensorFault):
    """Something is wrong with the jacket's sensor, or with its line through the slip ring (K, K/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        jacket = scene.rig.jacket
        jacket.source = self._spoiled(jacket.source, "hub sensor", scene, now)


class _Together(Effect):
    """Faults that come and go as one."""

    __slots__ = ("_all",)

    def __init__(self, *all_of_them: Effect) -> None:
        """Of these."""
        self._all = all_of_them

    def begin(self, scene: Scene, now: float) -> None:
        """Begin all of them."""
        for one in self._all:
            one.begin(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """End all of them."""
        for one in self._all:
            one.end(scene, now)


class CommonSupplyFault(_Together):
    """The supply that hub sensor and thermometer share is off: both show another share of what they should."""

    __slots__ = ()

    def __init__(self, percent: float) -> None:
        """Show ``percent`` of what is above ambient temperature."""
        super().__init__(HubFault("gain", percent), SurfaceFault("gain", percent))


class HubDetached(_Together):
    """The hub's sensor sits loose: it takes part in the air's temperature, and follows the hub slowly."""

    __slots__ = ()

    def __init__(self, percent: float) -> None:
        """Show ``percent`` of what is above ambient temperature, late by DETACHED_S."""
        super().__init__(HubFault("gain", percent), HubFault("lag", DETACHED_S))
