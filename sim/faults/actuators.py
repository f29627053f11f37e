"""Faults of what is switched: jacket, contactor, safety chain, guard."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.nodes.safety_io import SafetyIo

STOPPED_BY_THE_CHAIN = ("wheel", "belt", "press")
"""Drives whose torque an emergency stop takes away at once (stop category 0 [A])."""


def io_of(scene: Scene) -> SafetyIo:
    """Return the inputs and outputs at the press drive. Raises LookupError where there are none."""
    for drive in scene.rig.axes.values():
        if drive.io is not None:
            return drive.io
    raise LookupError("no drive of this rig has digital inputs")


class JacketOutput(Effect):
    """The jacket controller's output is stuck; its registers show it."""

    __slots__ = ("percent",)

    def __init__(self, percent: float) -> None:
        """At this output, 0 to 100 %."""
        self.percent = percent

    def begin(self, scene: Scene, now: float) -> None:
        """Stick."""
        scene.rig.jacket.stuck_output = self.percent

    def end(self, scene: Scene, now: float) -> None:
        """Come loose."""
        scene.rig.jacket.stuck_output = None


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
        scene.rig.jacket.stuck_element = self.percent

    def end(self, scene: Scene, now: float) -> None:
        """Be mended."""
        scene.rig.jacket.stuck_element = None


class LimiterDead(Effect):
    """The jacket controller's own limiter does nothing (a second fault, with a stuck output)."""

    __slots__ = ("_limit_c",)

    def __init__(self) -> None:
        """Alive so far."""
        self._limit_c = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Put its limit out of reach."""
        self._limit_c = scene.rig.jacket.limit_c
        scene.rig.jacket.limit_c = 1e9

    def end(self, scene: Scene, now: float) -> None:
        """Put it back."""
        scene.rig.jacket.limit_c = self._limit_c


class ContactorWelded(Effect):
    """The contactor's contacts are welded: once closed it stays closed."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Weld."""
        io_of(scene).welded = True

    def end(self, scene: Scene, now: float) -> None:
        """Break loose: it opens when nobody asks for it."""
        io_of(scene).release(now)
        _reschedule(scene)


class ContactorDead(Effect):
    """The contactor's coil is open: it drops out and does not pull in again."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Break the coil's circuit."""
        io_of(scene).break_coil(True, now)
        _reschedule(scene)

    def end(self, scene: Scene, now: float) -> None:
        """Mend it."""
        io_of(scene).break_coil(False, now)
        _reschedule(scene)


class ChainOpen(Effect):
    """The safety chain opens at its input: a broken wire, nobody has pressed anything."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Open it."""
        for drive in scene.rig.axes.values():
            drive.set_safety_chain(False)
        _reschedule(scene)

    def end(self, scene: Scene, now: float) -> None:
        """Close it."""
        for drive in scene.rig.axes.values():
            drive.set_safety_chain(True)
        _reschedule(scene)


class EmergencyStop(ChainOpen):
    """Somebody presses the emergency stop: the chain opens and the drives' torque goes by hardware."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Press it."""
        super().begin(scene, now)
        for name in STOPPED_BY_THE_CHAIN:
            scene.rig.axes[name].set_torque_off(True)

    def end(self, scene: Scene, now: float) -> None:
        """Release it."""
        super().end(scene, now)
        for name in STOPPED_BY_THE_CHAIN:
            scene.rig.axes[name].set_torque_off(False)


class GuardOpen(Effect):
    """Somebody opens the guard."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Open it."""
        for drive in scene.rig.axes.values():
            drive.set_guard(False)

    def end(self, scene: Scene, now: float) -> None:
        """Close it."""
        for drive in scene.rig.axes.values():
            drive.set_guard(True)


def _reschedule(scene: Scene) -> None:
    """Have the drives look at the contactor's new time."""
    for drive in scene.rig.axes.values():
        if drive.io is not None:
            drive.reschedule()
