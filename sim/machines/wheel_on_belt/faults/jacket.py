"""Faults of the heating jacket: its output, its heater, its limiter."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.machines.wheel_on_belt.faults.place import wheel_rig


class JacketOutput(Effect):
    """The jacket controller's output is stuck; its registers show it."""

    __slots__ = ("percent",)

    def __init__(self, percent: float) -> None:
        """At this output, 0 to 100 %."""
        self.percent = percent

    def begin(self, scene: Scene, now: float) -> None:
        """Stick."""
        wheel_rig(scene).jacket.stuck_output = self.percent

    def end(self, scene: Scene, now: float) -> None:
        """Come loose."""
        wheel_rig(scene).jacket.stuck_output = None


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

    __slots__ = ("_limit_c",)

    def __init__(self) -> None:
        """Alive so far."""
        self._limit_c = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Put its limit out of reach."""
        self._limit_c = wheel_rig(scene).jacket.limit_c
        wheel_rig(scene).jacket.limit_c = 1e9

    def end(self, scene: Scene, now: float) -> None:
        """Put it back."""
        wheel_rig(scene).jacket.limit_c = self._limit_c
