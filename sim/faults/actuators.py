"""Faults of what is switched: contactor, safety chain, guard."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.nodes.safety_io import SafetyIo


def io_of(scene: Scene) -> SafetyIo:
    """Return the inputs and outputs at the drive that has them. Raises LookupError where there are none."""
    for drive in scene.rig.axes.values():
        if drive.io is not None:
            return drive.io
    raise LookupError("no drive of this rig has digital inputs")


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

    __slots__ = ("stopped",)

    def __init__(self, stopped: tuple[str, ...]) -> None:
        """Take the torque of these drives away at once (stop category 0)."""
        self.stopped = stopped

    def begin(self, scene: Scene, now: float) -> None:
        """Press it."""
        super().begin(scene, now)
        for name in self.stopped:
            scene.rig.axes[name].set_torque_off(True)

    def end(self, scene: Scene, now: float) -> None:
        """Release it."""
        super().end(scene, now)
        for name in self.stopped:
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
