"""Faults of load cell, thermometer and hub sensor: what they show instead of what is.

Sensors are wrapped; nothing is looked up per reading while they are well.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import cast

from sim.faults.scene import Effect, Scene
from sim.faults.sensors import SEED, SLOW, Slow, spoiled
from sim.machines.wheel_on_belt.faults.place import wheel_rig
from sim.nodes.cell_slave import ForceSource
from sim.nodes.ir_slave import SurfaceSource
from sim.nodes.jacket_slave import HubSource
from sim.noise import NormalStream

Forces = tuple[float, float, float, float]
CROSSED = ("exchanged x z", "reversed x", "reversed y", "reversed z")
"""Kinds of a load cell alone: its channels as they should not be."""
DETACHED_S = 20.0
"""Time constant of a hub sensor that has come loose, s [A]: the fixed one's is 1 s."""


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
        ambient_c, noise = wheel_rig(scene).plant.parameters.ambient, NormalStream(SEED, f"faulty {name}")
        self._wrapped = wrapped = SpoiledTemperature(
            source, self.kind, self.value, now, ambient_c, noise, slow=self._slow()
        )
        return wrapped

    def _slow(self) -> Slow | None:
        return Slow(self.kind, self.value) if self.kind in SLOW else None

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        if self._wrapped is not None:
            self._wrapped.active = False


class CellFault(SensorFault):
    """Something is wrong with the normal force of the load cell (N, N/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        cell = wheel_rig(scene).cell
        if self.kind == "frozen":
            cell.frozen = True
            return
        # A broken bridge drives the amplifier to the end of its range.
        kind = "saturated" if self.kind == "open" else self.kind
        noise = NormalStream(SEED, "faulty cell")
        self._wrapped = cell.source = SpoiledForces(cell.source, kind, self.value, now, noise, self._slow())

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        super().end(scene, now)
        if self.kind == "frozen":
            wheel_rig(scene).cell.frozen = False


class SurfaceFault(SensorFault):
    """Something is wrong with the infrared thermometer (K, K/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        ir = wheel_rig(scene).ir
        if self.kind == "frozen":
            ir.frozen = True
        else:
            ir.source = self._spoiled(ir.source, "thermometer", scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """Show what is."""
        super().end(scene, now)
        if self.kind == "frozen":
            wheel_rig(scene).ir.frozen = False


class HubFault(SensorFault):
    """Something is wrong with the jacket's sensor, or with its line through the slip ring (K, K/s or percent)."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Let it show something else from now on."""
        jacket = wheel_rig(scene).jacket
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
