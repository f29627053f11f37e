"""Faults of the sensors: what they show instead of what is. Sensors are wrapped; nothing is looked up per reading
while they are well."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from typing import cast

from sim.faults.scene import Effect, Scene
from sim.nodes.cell_slave import ForceSource
from sim.nodes.ir_slave import SurfaceSource
from sim.nodes.jacket_slave import HubSource
from sim.noise import NormalStream

Forces = tuple[float, float, float, float]
KINDS = ("offset", "drift", "noise", "low", "open", "saturated", "frozen")
_SEED = 402
"""Key of the random numbers of noisy sensors: the same in every run."""
_OFF_SCALE_N = 1e5
"""More than any load cell here can show, N: the transmitter shows the end of its range."""


@dataclass(slots=True)
class SpoiledForces:
    """A load cell with something wrong with its normal force: what it measures and what it makes of it."""

    source: ForceSource
    kind: str
    value: float
    since_s: float
    noise: NormalStream
    active: bool = True

    def forces_measured(self, t: float) -> Forces:
        """Return Fx, Fy, Fz in N and the moment in N m as they appear at ``t`` s."""
        x, y, z, m = self.source.forces_measured(t)
        if not self.active:
            return x, y, z, m
        return x, y, spoiled(self.kind, z, self.value, t - self.since_s, self.noise, 0.0), m

    def shown_n(self, true_n: float, t: float) -> float:
        """Return what it makes of a normal force of ``true_n`` at ``t`` s, noise left out, N; NaN: nothing."""
        if not self.active or self.kind == "noise":
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
    active: bool = True

    def surface_measured_c(self, t: float) -> float:
        """Return the surface temperature in degC as it appears."""
        return self._spoil(cast("SurfaceSource", self.source).surface_measured_c(t), t)

    def hub_measured_c(self, t: float) -> float:
        """Return the hub temperature in degC as it appears."""
        return self._spoil(cast("HubSource", self.source).hub_measured_c(t), t)

    def off_k(self, true_c: float, t: float) -> float:
        """Return how far from ``true_c`` degC the sensor shows at ``t`` s, its noise left out, K; NaN: nothing."""
        if not self.active or self.kind == "noise":
            return 0.0
        return self._spoil(true_c, t) - true_c

    def _spoil(self, true_c: float, t: float) -> float:
        if not self.active:
            return true_c
        if self.kind == "frozen":
            self.held_c = self.held_c if self.held_c == self.held_c else true_c
            return self.held_c
        return spoiled(self.kind, true_c, self.value, t - self.since_s, self.noise, self.ambient_c)


def spoiled(kind: str, value: float, size: float, age_s: float, noise: NormalStream, floor: float) -> float:
    """Return what a sensor shows of ``value``: off by ``size``, drifting by ``size`` a second, noisy (rms ``size``),
    low (the share of ``size`` percent above ``floor`` is missing), off scale, or nothing (not a number)."""
    if kind == "offset":
        return value + size
    if kind == "drift":
        return value + size * age_s
    if kind == "noise":
        return value + size * noise.next()
    if kind == "low":
        return floor + (value - floor) * (1.0 - 0.01 * size)
    return _OFF_SCALE_N if kind == "saturated" else nan


class SensorFault(Effect):
    """Something is wrong with a sensor: what asks for it is given a spoiled one instead, until the fault ends."""

    __slots__ = ("_wrapped", "kind", "value")

    def __init__(self, kind: str, value: float = 0.0) -> None:
        """``kind`` of KINDS, of this size (unit of the sensor, or that a second, or percent)."""
        self.kind = kind
        self.value = value
        self._wrapped: SpoiledForces | SpoiledTemperature | None = None

    def _spoiled(self, source: SurfaceSource | HubSource, name: str, scene: Scene, now: float) -> SpoiledTemperature:
        """Put a thermometer's source into wrapping; ``name`` keys its noise."""
        ambient_c, noise = scene.rig.plant.parameters.ambient, NormalStream(_SEED, f"faulty {name}")
        self._wrapped = wrapped = SpoiledTemperature(source, self.kind, self.value, now, ambient_c, noise)
        return wrapped

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
        self._wrapped = cell.source = SpoiledForces(cell.source, kind, self.value, now, noise)

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
