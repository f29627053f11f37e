"""Torque at the drives' shafts: what load and friction ask of them, and what a limit of torque leaves them.

A drive shows its torque (0x6077) as its current says, hence with an error of gain.

The belt's drive brakes what the wheel pushes on, or pulls what the wheel holds back, as long as its roller grips the
belt. Under a belt that something holds back the roller slips, and pulls with all that its wrap can, whatever the wheel
does (``capstan_n``).
"""

from __future__ import annotations

from math import exp, pi, radians
from typing import Final

from sim.noise import uniforms
from sim.physics.parameters import DriveParameters

FRICTION_RAD_S: Final = 0.05
"""The friction of a shaft is there in full from this speed on, rad/s [A]: below it bearings and seals only creep."""


def capstan_n(parameters: DriveParameters) -> float:
    """Return the force of a roller on a belt that slips on it, along the roller's way, N: Euler-Eytelwein.

    The strands differ by the factor q = exp(coefficient x wrap), and keep the sum of their pretensions T (a belt of
    fixed length): the force is 2 T (q - 1) / (q + 1).
    """
    ratio = exp(parameters.belt_grip * radians(parameters.belt_wrap))
    return 2.0 * parameters.belt_pretension * (ratio - 1.0) / (ratio + 1.0)


class ShaftTorque:
    """A shaft with the friction of its bearings and seals, and the error of its drive's torque reading.

    ``way`` is 1 where the load's positive torque is the drive's, -1 where the shaft turns the other way round than its
    drive believes.
    """

    def __init__(self, friction_nm: float, gain: float) -> None:
        """Take the friction (N m, at least 0) and shown over true torque."""
        self._friction_nm = friction_nm
        self._gain = gain
        self.way = 1.0

    def shown_nm(self, load_nm: float, rad_s: float) -> float:
        """Return what the drive shows where the load takes ``load_nm`` of a shaft that turns at ``rad_s`` (its own)."""
        turning = rad_s / FRICTION_RAD_S
        turning = 1.0 if turning > 1.0 else -1.0 if turning < -1.0 else turning
        return self._gain * (self.way * load_nm + self._friction_nm * turning)


class PressScrew:
    """The press's screw between the drive's torque and the force on the wheel.

    Pressing takes K (F + spring) / efficiency + drag, with K = lead / 2 pi; going back, friction is on the other side:
    K (F + spring) (2 - 1 / efficiency) - drag. On its way from the one to the other the screw moves by ``presliding``
    without sliding in its nut, and standing it keeps the friction it came to rest with.
    """

    def __init__(self, parameters: DriveParameters, efficiency: float, spring_n: float) -> None:
        """Take the session's ``efficiency`` (above 0.5: it can be driven back) and the force of the lifting spring."""
        self._m = 1e-3 * parameters.screw_lead / (2.0 * pi)
        self._excess = 1.0 / efficiency - 1.0
        self._drag_nm = parameters.screw_drag
        self._per_mm = 2.0 / parameters.screw_presliding
        self.spring_n = spring_n
        self._way = 0.0
        self._place_mm = 0.0

    def torque_nm(self, force_n: float, press_mm: float) -> float:
        """Return the torque that the drive gives with the press at ``press_mm`` under a force; called once a step."""
        way = self._way + (press_mm - self._place_mm) * self._per_mm
        self._way = way = 1.0 if way > 1.0 else -1.0 if way < -1.0 else way
        self._place_mm = press_mm
        return self._m * (force_n + self.spring_n) * (1.0 + way * self._excess) + way * self._drag_nm

    def pushed_n(self, torque_nm: float) -> float:
        """Return the greatest force on the wheel that a torque brings about by pressing, N."""
        return (torque_nm - self._drag_nm) / (self._m * (1.0 + self._excess)) - self.spring_n

    def held_n(self, torque_nm: float) -> float:
        """Return the greatest force that does not drive the press back against a torque, N."""
        return (torque_nm + self._drag_nm) / (self._m * (1.0 - self._excess)) - self.spring_n


def shafts(parameters: DriveParameters, noise: float, seed: int) -> tuple[ShaftTorque, ShaftTorque, float]:
    """Return wheel's and belt's shaft and the screw's efficiency, each with what a session (``seed``) has of it."""
    wheel, belt, screw = uniforms(3, seed, "session drives")
    gain = noise * parameters.torque_gain
    return (
        ShaftTorque(parameters.wheel_friction, 1.0 + gain * wheel),
        ShaftTorque(parameters.belt_friction, 1.0 + gain * belt),
        parameters.screw_efficiency + noise * parameters.screw_efficiency_spread * screw,
    )
