"""Faults of wheel, belt and press: errors of assembly, the rubber on its hub, slipping or torn parts."""

from __future__ import annotations

from sim.faults.scene import Effect, Scene, switched
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.sensors import SpeedSensor

LEAST_SHARE = 0.01
"""Least share of its right value that a scale or a size may have: nothing is divided by 0."""


def _sensor(scene: Scene, axis: str) -> SpeedSensor:
    """Return the sensor between the shaft of "wheel" or "belt" and its drive's speed reading."""
    plant = scene.machine(WheelRig).plant
    return plant.wheel_speed if axis == "wheel" else plant.belt_speed


@switched
def reversed_shaft(scene: Scene, on: bool, now: float, axis: str) -> None:
    """The shaft turns the wrong way round: the drive's direction was never set, and its encoder turns with it."""
    rig = scene.machine(WheelRig)
    _sensor(scene, axis).factor *= -1.0
    (rig.wheel_shaft if axis == "wheel" else rig.belt_shaft).way *= -1.0


@switched
def speed_scale(scene: Scene, on: bool, now: float, axis: str, percent: float) -> None:
    """The shaft turns at ``percent`` of the speed that its drive shows: a wrong gear ratio or increment."""
    share = max(0.01 * percent, LEAST_SHARE)
    sensor = _sensor(scene, axis)
    sensor.factor = sensor.factor / share if on else sensor.factor * share


@switched
def drives_swapped(scene: Scene, on: bool, now: float) -> None:
    """The motors of wheel and belt are connected to each other's drives."""
    scene.machine(WheelRig).swapped = on


class DiameterOff(Effect):
    """The wheels have a wrong diameter: from the next time on that the wheel is out of contact."""

    every_step = True

    def __init__(self, percent: float) -> None:
        """Take the share of the right diameter, percent."""
        self.share = max(0.01 * percent, LEAST_SHARE)

    def renew(self, scene: Scene, now: float) -> None:
        """Mount the wrong wheel once the wheel is out of contact."""
        plant = scene.machine(WheelRig).plant
        if plant.size != self.share and plant.force_z_n == 0.0:
            plant.set_size(self.share)

    def end(self, scene: Scene, now: float) -> None:
        """Mount a wheel of the right size if the wheel is out of contact."""
        if scene.machine(WheelRig).plant.force_z_n == 0.0:
            scene.machine(WheelRig).plant.set_size(1.0)


@switched
def rubber_detached(scene: Scene, on: bool, now: float, swing_mm: float) -> None:
    """A part of the rubber has come off its hub: the runout of the tread grows by ``swing_mm``, peak to peak."""
    plant = scene.machine(WheelRig).plant
    plant.set_runout(plant.parameters.contact.runout + (swing_mm if on else 0.0))


@switched
def rubber_relaxes(scene: Scene, on: bool, now: float, percent: float) -> None:
    """The rubber (overheated, or not cured) relaxes by ``percent`` of the load in each decade of time, up to 15 %."""
    plant = scene.machine(WheelRig).plant
    sound = plant.parameters.relaxation * plant.parameters.contact.relaxation
    plant.set_relaxation(min(0.01 * percent, 0.15) if on else sound)


@switched
def belt_rubs_otherwise(scene: Scene, on: bool, now: float, percent: float) -> None:
    """The belt has ``percent`` of its original friction: another lot, a joint, dust."""
    scene.machine(WheelRig).plant.set_grip(max(0.01 * percent, 0.0) if on else 1.0)


class BeltSlips(Effect):
    """Something holds the belt back (caught, pressed on its support): it is slower than its roller and its encoder.

    Beyond elastic creep the roller slips under it: it then pulls with the full force of its wrap instead of braking the
    wheel.
    """

    def __init__(self, percent: float) -> None:
        """Take the speed lost, percent."""
        self.share = 0.01 * percent

    def begin(self, scene: Scene, now: float) -> None:
        """Let the belt slip on its roller."""
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
    """The belt is torn: its roller turns on; the belt itself moves with the wheel that touches it, or is at rest.

    Nothing holds the belt against the wheel any more: no friction, and no torque at either drive.
    """

    every_step = True

    def begin(self, scene: Scene, now: float) -> None:
        """Tear the belt: the contact loses its grip."""
        plant = scene.machine(WheelRig).plant
        self._factor = plant.belt_speed.factor
        plant.set_grip(0.0)

    def end(self, scene: Scene, now: float) -> None:
        """Mount a new belt."""
        plant = scene.machine(WheelRig).plant
        plant.belt_speed.factor = self._factor
        plant.set_grip(1.0)

    def renew(self, scene: Scene, now: float) -> None:
        """Move the belt with the wheel in contact, through its encoder's scale: no other change is needed."""
        rig = scene.machine(WheelRig)
        plant, roller_m_s = rig.plant, rig.axes["belt"].axis.value
        rim_m_s = 0.0005 * plant.diameter_mm * rig.axes["wheel"].axis.value / plant.wheel_speed.factor
        carried_m_s = rim_m_s if plant.force_z_n > 0.0 else 0.0
        plant.belt_speed.factor = roller_m_s / carried_m_s if carried_m_s and roller_m_s else 1e9


class WheelSlipsOnShaft(Effect):
    """The wheel's clamping is loose: in contact the wheel rolls with the belt, whatever its shaft does."""

    every_step = True

    def begin(self, scene: Scene, now: float) -> None:
        """Loosen the clamping."""
        self._factor = scene.machine(WheelRig).plant.wheel_speed.factor

    def end(self, scene: Scene, now: float) -> None:
        """Clamp the wheel again."""
        scene.machine(WheelRig).plant.wheel_speed.factor = self._factor

    def renew(self, scene: Scene, now: float) -> None:
        """Make the wheel roll on the belt in contact, and turn with its shaft out of contact."""
        rig = scene.machine(WheelRig)
        plant, shaft = rig.plant, rig.axes["wheel"].axis.value
        belt_m_s = rig.axes["belt"].axis.value / plant.belt_speed.factor
        rolling = belt_m_s / (0.0005 * plant.diameter_mm)
        loose = plant.force_z_n > 0.0 and shaft != 0.0 and rolling != 0.0
        plant.wheel_speed.factor = shaft / rolling if loose else self._factor
