"""Faults of the jacket's sensor, heater, limiter, and line through the slip ring."""

from __future__ import annotations

from math import inf, pi
from typing import Final

from sim.faults.modbus import line_of, slave_of
from sim.faults.scene import Effect, Scene, switched
from sim.faults.sensors import SensorFault
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.controller_slave import JACKET_HOTTEST_C
from sim.wires.modbus_wire import Impairment

HALF_DEG: Final = 20.0
"""The worn place reaches this far to either side of its centre, degrees of the wheel's turn [A]."""
DETACHED_S = 20.0
"""Time constant of a hub sensor that has come loose, s [A]: the fixed one's is 1 s."""


class _Together(Effect):
    """Faults that come and go together."""

    def __init__(self, *effects: Effect) -> None:
        self._effects = effects

    def begin(self, scene: Scene, now: float) -> None:
        """Begin all of them."""
        for effect in self._effects:
            effect.begin(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """End all of them."""
        for effect in self._effects:
            effect.end(scene, now)


def common_supply_off(percent: float) -> Effect:
    """The supply that hub sensor and thermometer share is off: both show ``percent`` of what is above ambient."""
    return _Together(SensorFault("jacket", "gain", percent), SensorFault("thermometer", "gain", percent))


def hub_detached(percent: float) -> Effect:
    """The hub's sensor sits loose: it shows ``percent`` of what is above ambient, late by DETACHED_S."""
    return _Together(SensorFault("jacket", "gain", percent), SensorFault("jacket", "lag", DETACHED_S))


@switched
def heater_element(scene: Scene, on: bool, now: float, percent: float) -> None:
    """The way from the controller's output to the heat is broken: a shorted relay (100 %) or an open line (0 %).

    The controller continues to show the output that it commands.
    """
    scene.machine(WheelRig).jacket.stuck_element = percent if on else None


@switched
def limiter_dead(scene: Scene, on: bool, now: float) -> None:
    """The jacket controller's own limiter does nothing (a second fault, with a stuck output)."""
    scene.machine(WheelRig).jacket.hottest_c = inf if on else JACKET_HOTTEST_C


class WornSector(Effect):
    """A slip ring worn at one place: requests to the jacket fail while the wheel stands within HALF_DEG of an angle.

    ``turns`` of the wheel count from when it begins; at the angle 0 it stands then.
    """

    every_step = True

    def __init__(self, degrees: float) -> None:
        """At this angle."""
        self._at_rev = degrees / 360.0
        self._impairment: Impairment | None = None
        self._last_s = 0.0
        self.turns = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Begin with a sound line."""
        line = line_of(scene, "jacket")
        self._last_s = now
        self._impairment = Impairment("corrupt", 0, slave_of(scene, "jacket").unit_id, besides=line.impair)
        line.impair = self._impairment

    def end(self, scene: Scene, now: float) -> None:
        """Let the line be sound again."""
        if self._impairment is not None:
            self._impairment.count = 0
            self._impairment = None

    def renew(self, scene: Scene, now: float) -> None:
        """Follow the wheel to ``now`` s."""
        self.turns += scene.machine(WheelRig).wheel_rad_s * (now - self._last_s) / (2.0 * pi)
        self._last_s = now
        if self._impairment is not None:
            away_rev = abs((self.turns - self._at_rev + 0.5) % 1.0 - 0.5)
            self._impairment.count = -1 if 360.0 * away_rev <= HALF_DEG else 0
