"""Faults of how the machine was put together: directions, scales, sizes, the rubber on its hub."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.sensors import SpeedSensor
from sim.torque import ShaftTorque

LEAST_SHARE = 0.01
"""A scale or a size is never less than this share of what it should be: nothing is divided by 0."""


class _OnShaft(Effect):
    """A fault of the wheel's or the belt's shaft."""

    __slots__ = ("axis",)

    def __init__(self, axis: str) -> None:
        """Of "wheel" or "belt"."""
        self.axis = axis

    def sensor(self, scene: Scene) -> SpeedSensor:
        """Return what stands between the shaft and its drive's speed."""
        plant = scene.rig.plant
        return plant.wheel_speed if self.axis == "wheel" else plant.belt_speed

    def shaft(self, scene: Scene) -> ShaftTorque:
        """Return what stands between the shaft and its drive's torque."""
        return scene.rig.wheel_shaft if self.axis == "wheel" else scene.rig.belt_shaft


class Reversed(_OnShaft):
    """The shaft turns the wrong way round: the drive's direction was never set, and its encoder turns with it."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Turn round."""
        self._turn(scene)

    def end(self, scene: Scene, now: float) -> None:
        """Turn round again."""
        self._turn(scene)

    def _turn(self, scene: Scene) -> None:
        self.sensor(scene).factor *= -1.0
        self.shaft(scene).way *= -1.0


class SpeedScale(_OnShaft):
    """The shaft turns at another share of the speed that its drive shows: a wrong gear ratio or increment."""

    __slots__ = ("share",)

    def __init__(self, axis: str, percent: float) -> None:
        """At ``percent`` of the speed shown."""
        super().__init__(axis)
        self.share = max(0.01 * percent, LEAST_SHARE)

    def begin(self, scene: Scene, now: float) -> None:
        """Turn at this speed."""
        self.sensor(scene).factor /= self.share

    def end(self, scene: Scene, now: float) -> None:
        """Turn as shown."""
        self.sensor(scene).factor *= self.share


class DrivesSwapped(Effect):
    """The motors of wheel and belt are connected to each other's drives."""

    __slots__ = ()

    def begin(self, scene: Scene, now: float) -> None:
        """Swap them."""
        scene.rig.swapped = True

    def end(self, scene: Scene, now: float) -> None:
        """Connect them as they should be."""
        scene.rig.swapped = False


class DiameterOff(Effect):
    """The wheels have another diameter than they should: from the next time on that the wheel is out of contact."""

    __slots__ = ("share",)

    every_step = True

    def __init__(self, percent: float) -> None:
        """Of ``percent`` of the diameter."""
        self.share = max(0.01 * percent, LEAST_SHARE)

    def renew(self, scene: Scene, now: float) -> None:
        """Put it on once nothing is in its way."""
        plant = scene.rig.plant
        if plant.size != self.share and plant.force_z_n == 0.0:
            plant.set_size(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Have a wheel of the right size on, if it is free."""
        if scene.rig.plant.force_z_n == 0.0:
            scene.rig.plant.set_size(1.0)


class RubberDetached(Effect):
    """A part of the rubber has come off its hub: the tread swings once a turn, and the force with it."""

    __slots__ = ("swing_mm",)

    def __init__(self, swing_mm: float) -> None:
        """By this much more than it does anyway, peak to peak, mm."""
        self.swing_mm = swing_mm

    def begin(self, scene: Scene, now: float) -> None:
        """Come off."""
        plant = scene.rig.plant
        plant.set_runout(plant.parameters.contact.runout + self.swing_mm)

    def end(self, scene: Scene, now: float) -> None:
        """Be bonded again."""
        plant = scene.rig.plant
        plant.set_runout(plant.parameters.contact.runout)


class RubberRelaxes(Effect):
    """The rubber gives way more than it should: overheated, or not cured."""

    __slots__ = ("share",)

    def __init__(self, percent: float) -> None:
        """By this much of the load in a decade of time, up to 15 %."""
        self.share = min(0.01 * percent, 0.15)

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to give way."""
        scene.rig.plant.set_relaxation(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Behave as sound rubber does."""
        p = scene.rig.plant.parameters
        scene.rig.plant.set_relaxation(p.relaxation * p.contact.relaxation)
