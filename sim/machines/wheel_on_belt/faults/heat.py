"""Faults of the jacket's sensor, heater, limiter, and line through the slip ring."""

from __future__ import annotations

from math import inf, pi
from typing import Final

from sim.faults.modbus import line_of, slave_of
from sim.faults.scene import Effect, Scene, switched
from sim.faults.sensors import SensorFault
from sim.faults.shares import Together
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.nodes.control_loop import JACKET_HOTTEST_C
from sim.wires.modbus_wire import Impairment

HALF_DEG: Final = 20.0
"""Reach of the worn place to either side of its centre, degrees of the wheel's turn [A]."""
DETACHED_S = 20.0
"""Time constant of a loose hub sensor, s [A]: a fixed one has 1 s."""
STICKS_EVERY_S: Final = 8.0
"""Period of a relay that sticks, s [A]."""


def hub_detached(percent: float) -> Effect:
    """The hub's sensor is loose: it shows ``percent`` of the excess above ambient, late by DETACHED_S."""
    return Together(SensorFault("jacket", "gain", percent), SensorFault("jacket", "lag", DETACHED_S))


@switched
def heater_element(scene: Scene, on: bool, now: float, percent: float) -> None:
    """The path from the controller's output to the heat is broken: a shorted relay (100 %) or an open line (0 %).

    The controller continues to show the output that it commands.
    """
    scene.machine(WheelRig).jacket.stuck_element = percent if on else None


class RelaySticks(Effect):
    """The heater's relay sticks: it stays closed for some seconds of every STICKS_EVERY_S, whatever the output is."""

    every_step = True

    def __init__(self, seconds: float) -> None:
        """Take the time for which it stays closed, s."""
        self._closed_s = seconds
        self._since_s = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Stick now for the first time."""
        self._since_s = now
        self.renew(scene, now)

    def end(self, scene: Scene, now: float) -> None:
        """Follow the output again."""
        scene.machine(WheelRig).jacket.stuck_element = None

    def renew(self, scene: Scene, now: float) -> None:
        """Stick, or follow the output, as at ``now`` s."""
        closed = (now - self._since_s) % STICKS_EVERY_S < self._closed_s
        scene.machine(WheelRig).jacket.stuck_element = 100.0 if closed else None


@switched
def limiter_dead(scene: Scene, on: bool, now: float) -> None:
    """The jacket controller's own limiter does nothing (a second fault, with a stuck output)."""
    scene.machine(WheelRig).jacket.hottest_c = inf if on else JACKET_HOTTEST_C


class WornSector(Effect):
    """A slip ring worn at one place: requests to the jacket fail while the wheel is within HALF_DEG of an angle.

    ``turns`` of the wheel count from the begin of the fault; the wheel's angle is 0 then.
    """

    every_step = True

    def __init__(self, degrees: float) -> None:
        """Take the angle of the worn place."""
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
        """Repair the line."""
        if self._impairment is not None:
            self._impairment.count = 0
            self._impairment = None

    def renew(self, scene: Scene, now: float) -> None:
        """Update the wheel's angle for ``now`` s."""
        self.turns += scene.machine(WheelRig).wheel_rad_s * (now - self._last_s) / (2.0 * pi)
        self._last_s = now
        if self._impairment is not None:
            away_rev = abs((self.turns - self._at_rev + 0.5) % 1.0 - 0.5)
            self._impairment.count = -1 if 360.0 * away_rev <= HALF_DEG else 0
