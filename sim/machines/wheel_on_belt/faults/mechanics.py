"""Faults of wheel, belt and press: how they were put together, the rubber on its hub, what slips or tears."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.machines.wheel_on_belt.torque import ShaftTorque
from sim.sensors import SpeedSensor

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
        plant = scene.machine(WheelRig).plant
        return plant.wheel_speed if self.axis == "wheel" else plant.belt_speed

    def shaft(self, scene: Scene) -> ShaftTorque:
        """Return what stands between the shaft and its drive's torque."""
        return scene.machine(WheelRig).wheel_shaft if self.axis == "wheel" else scene.machine(WheelRig).belt_shaft


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
        scene.machine(WheelRig).swapped = True

    def end(self, scene: Scene, now: float) -> None:
        """Connect them as they should be."""
        scene.machine(WheelRig).swapped = False


class DiameterOff(Effect):
    """The wheels have another diameter than they should: from the next time on that the wheel is out of contact."""

    __slots__ = ("share",)

    every_step = True

    def __init__(self, percent: float) -> None:
        """Of ``percent`` of the diameter."""
        self.share = max(0.01 * percent, LEAST_SHARE)

    def renew(self, scene: Scene, now: float) -> None:
        """Put it on once nothing is in its way."""
        plant = scene.machine(WheelRig).plant
        if plant.size != self.share and plant.force_z_n == 0.0:
            plant.set_size(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Have a wheel of the right size on, if it is free."""
        if scene.machine(WheelRig).plant.force_z_n == 0.0:
            scene.machine(WheelRig).plant.set_size(1.0)


class RubberDetached(Effect):
    """A part of the rubber has come off its hub: the tread swings once a turn, and the force with it."""

    __slots__ = ("swing_mm",)

    def __init__(self, swing_mm: float) -> None:
        """By this much more than it does anyway, peak to peak, mm."""
        self.swing_mm = swing_mm

    def begin(self, scene: Scene, now: float) -> None:
        """Come off."""
        plant = scene.machine(WheelRig).plant
        plant.set_runout(plant.parameters.contact.runout + self.swing_mm)

    def end(self, scene: Scene, now: float) -> None:
        """Be bonded again."""
        plant = scene.machine(WheelRig).plant
        plant.set_runout(plant.parameters.contact.runout)


class RubberRelaxes(Effect):
    """The rubber gives way more than it should: overheated, or not cured."""

    __slots__ = ("share",)

    def __init__(self, percent: float) -> None:
        """By this much of the load in a decade of time, up to 15 %."""
        self.share = min(0.01 * percent, 0.15)

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to give way."""
        scene.machine(WheelRig).plant.set_relaxation(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Behave as sound rubber does."""
        p = scene.machine(WheelRig).plant.parameters
        scene.machine(WheelRig).plant.set_relaxation(p.relaxation * p.contact.relaxation)


class BeltSlips(Effect):
    """Something holds the belt back (caught, pressed on its support): it is slower than its roller, and its encoder.

    Beyond elastic creep the roller slips under it, and pulls with all that its wrap can instead of braking the wheel.
    """

    __slots__ = ("_factor", "share")

    def __init__(self, percent: float) -> None:
        """By this much, percent of the speed."""
        self.share = 0.01 * percent
        self._factor = 1.0

    def begin(self, scene: Scene, now: float) -> None:
        """Begin to slip."""
        rig = scene.machine(WheelRig)
        rig.belt_slip = self.share
        sensor = rig.plant.belt_speed
        self._factor = sensor.factor
        sensor.factor = self._factor / max(1.0 - self.share, 1e-6)

    def end(self, scene: Scene, now: float) -> None:
        """Grip again."""
        scene.machine(WheelRig).belt_slip = 0.0
        scene.machine(WheelRig).plant.belt_speed.factor = self._factor


class BeltTorn(Effect):
    """The belt is torn: its roller turns on, the belt itself goes with whatever touches it and stands otherwise.

    Nothing holds the belt against the wheel any more: no friction, and no torque at either drive.
    """

    __slots__ = ("_factor",)

    every_step = True

    def __init__(self) -> None:
        """In one piece so far."""
        self._factor = 1.0

    def begin(self, scene: Scene, now: float) -> None:
        """Tear."""
        plant = scene.machine(WheelRig).plant
        self._factor = plant.belt_speed.factor
        plant.set_grip(0.0)

    def end(self, scene: Scene, now: float) -> None:
        """Have a new belt."""
        plant = scene.machine(WheelRig).plant
        plant.belt_speed.factor = self._factor
        plant.set_grip(1.0)

    def renew(self, scene: Scene, now: float) -> None:
        """Let the belt go with the wheel where it is touched, through the encoder's scale: no other place is needed."""
        rig = scene.machine(WheelRig)
        plant, roller_m_s = rig.plant, rig.axes["belt"].axis.value
        rim_m_s = 0.0005 * plant.diameter_mm * rig.axes["wheel"].axis.value / plant.wheel_speed.factor
        carried_m_s = rim_m_s if plant.force_z_n > 0.0 else 0.0
        plant.belt_speed.factor = roller_m_s / carried_m_s if carried_m_s and roller_m_s else 1e9


class WheelSlipsOnShaft(Effect):
    """The wheel's clamping has come loose: in contact it rolls with the belt, whatever its shaft does."""

    __slots__ = ("_factor",)

    every_step = True

    def __init__(self) -> None:
        """Clamped so far."""
        self._factor = 1.0

    def begin(self, scene: Scene, now: float) -> None:
        """Come loose."""
        self._factor = scene.machine(WheelRig).plant.wheel_speed.factor

    def end(self, scene: Scene, now: float) -> None:
        """Be clamped again."""
        scene.machine(WheelRig).plant.wheel_speed.factor = self._factor

    def renew(self, scene: Scene, now: float) -> None:
        """Let the wheel roll on the belt in contact, and go with its shaft out of it."""
        rig = scene.machine(WheelRig)
        plant, shaft = rig.plant, rig.axes["wheel"].axis.value
        belt_m_s = rig.axes["belt"].axis.value / plant.belt_speed.factor
        rolling = belt_m_s / (0.0005 * plant.diameter_mm)
        loose = plant.force_z_n > 0.0 and shaft != 0.0 and rolling != 0.0
        plant.wheel_speed.factor = shaft / rolling if loose else self._factor


class BeltRubsOtherwise(Effect):
    """The belt rubs otherwise than at first: another lot, a joint, dust."""

    __slots__ = ("share",)

    def __init__(self, percent: float) -> None:
        """With ``percent`` of the friction."""
        self.share = max(0.01 * percent, 0.0)

    def begin(self, scene: Scene, now: float) -> None:
        """Change."""
        scene.machine(WheelRig).plant.set_grip(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Rub as at first."""
        scene.machine(WheelRig).plant.set_grip(1.0)
