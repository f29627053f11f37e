"""Faults of the jacket's sensor, heater, limiter, and line through the slip ring."""

from __future__ import annotations

from math import pi
from typing import Final

from sim.faults.modbus import line_of, slave_of
from sim.faults.scene import Effect, Scene
from sim.faults.sensors import SensorFault
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.wires.modbus_wire import Impairment

HALF_DEG: Final = 20.0
"""The worn place reaches this far to either side of its centre, degrees of the wheel's turn [A]."""
DETACHED_S = 20.0
"""Time constant of a hub sensor that has come loose, s [A]: the fixed one's is 1 s."""


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
        super().__init__(SensorFault("jacket", "gain", percent), SensorFault("thermometer", "gain", percent))


class HubDetached(_Together):
    """The hub's sensor sits loose: it takes part in the air's temperature, and follows the hub slowly."""

    __slots__ = ()

    def __init__(self, percent: float) -> None:
        """Show ``percent`` of what is above ambient temperature, late by DETACHED_S."""
        super().__init__(SensorFault("jacket", "gain", percent), SensorFault("jacket", "lag", DETACHED_S))


class HeaterElement(Effect):
    """The way from the controller's output to the heat is broken: a shorted relay (100 %) or an open line (0 %).

    The controller goes on showing the output that it commands.
    """

    __slots__ = ("percent",)

    def __init__(self, percent: float) -> None:
        """Heat whatever the output, in percent of full power."""
        self.percent = percent

    def begin(self, scene: Scene, now: float) -> None:
        """Break."""
        scene.machine(WheelRig).jacket.stuck_element = self.percent

    def end(self, scene: Scene, now: float) -> None:
        """Be mended."""
        scene.machine(WheelRig).jacket.stuck_element = None


class LimiterDead(Effect):
    """The jacket controller's own limiter does nothing (a second fault, with a stuck output)."""

    __slots__ = ("_hottest_c",)

    def __init__(self) -> None:
        """Alive so far."""
        self._hottest_c = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Put its limit out of reach."""
        self._hottest_c = scene.machine(WheelRig).jacket.hottest_c
        scene.machine(WheelRig).jacket.hottest_c = 1e9

    def end(self, scene: Scene, now: float) -> None:
        """Put it back."""
        scene.machine(WheelRig).jacket.hottest_c = self._hottest_c


class WornSector(Effect):
    """A slip ring worn at one place: requests to the jacket fail while the wheel stands within HALF_DEG of an angle.

    ``turns`` of the wheel count from when it begins; at the angle 0 it stands then.
    """

    __slots__ = ("_at_rev", "_impairment", "_last_s", "turns")

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
