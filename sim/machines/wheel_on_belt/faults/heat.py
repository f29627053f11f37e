"""Faults of the jacket's sensor, heater and limiter."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.faults.sensors import SensorFault
from sim.machines.wheel_on_belt.faults.place import wheel_rig

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
        wheel_rig(scene).jacket.stuck_element = self.percent

    def end(self, scene: Scene, now: float) -> None:
        """Be mended."""
        wheel_rig(scene).jacket.stuck_element = None


class LimiterDead(Effect):
    """The jacket controller's own limiter does nothing (a second fault, with a stuck output)."""

    __slots__ = ("_hottest_c",)

    def __init__(self) -> None:
        """Alive so far."""
        self._hottest_c = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Put its limit out of reach."""
        self._hottest_c = wheel_rig(scene).jacket.hottest_c
        wheel_rig(scene).jacket.hottest_c = 1e9

    def end(self, scene: Scene, now: float) -> None:
        """Put it back."""
        wheel_rig(scene).jacket.hottest_c = self._hottest_c
