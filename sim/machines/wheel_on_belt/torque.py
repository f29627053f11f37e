"""Torque at the drives' shafts: the demand of load and friction, and the effect of a torque limit.

A drive derives the torque that it shows (0x6077) from its current, so it has an error of gain.

The belt's drive brakes against a wheel that pushes the belt, or pulls against a wheel that holds it back, as long as
its roller grips the belt. If something else holds the belt back, the roller slips and
pulls with the full force of its wrap (``capstan_n``); this force does not depend on the wheel.
"""

from __future__ import annotations

from math import exp, pi, radians
from typing import Final

from sim.noise import uniforms
from sim.physics.parameters import DriveParameters

FRICTION_RAD_S: Final = 0.05
"""Speed from which the friction of a shaft is complete, rad/s [A]: below it bearings and seals only creep."""


def capstan_n(parameters: DriveParameters) -> float:
    """Return the force of a roller on a belt that slips on it, in the roller's direction, N: Euler-Eytelwein.

    The strands differ by the factor q = exp(coefficient x wrap), and keep the sum of their pretensions T (a belt of
    fixed length): the force is 2 T (q - 1) / (q + 1).
    """
    ratio = exp(parameters.belt_grip * radians(parameters.belt_wrap))
    return 2.0 * parameters.belt_pretension * (ratio - 1.0) / (ratio + 1.0)


class ShaftTorque:
    """A shaft with the friction of its bearings and seals, and the error of its drive's torque reading.

    ``way`` is 1 if positive torque of the load is positive at the drive, -1 if the shaft turns against the drive's
    direction.
    """

    def __init__(self, friction_nm: float, gain: float) -> None:
        """Take the friction (N m, at least 0) and the ratio of shown to true torque."""
        self._friction_nm = friction_nm
        self._gain = gain
        self.way = 1.0

    def shown_nm(self, load_nm: float, rad_s: float) -> float:
        """Return the torque shown when the load takes ``load_nm`` from a shaft that turns at ``rad_s`` (its own)."""
        turning = rad_s / FRICTION_RAD_S
        turning = 1.0 if turning > 1.0 else -1.0 if turning < -1.0 else turning
        return self._gain * (self.way * load_nm + self._friction_nm * turning)


class PressScrew:
    """The press's screw between the drive's torque and the force on the wheel.

    Pressing takes K (F + spring) / efficiency + drag, with K = lead / 2 pi; going back, friction acts the other way:
    K (F + spring) (2 - 1 / efficiency) - drag. Between the two the screw moves by ``presliding``
    without sliding in its nut, and at rest it keeps the friction with which it stopped.
    """

    def __init__(self, parameters: DriveParameters, efficiency: float, spring_n: float, rate_n_per_mm: float = 0.0
                 ) -> None:  # fmt: skip
        """Take the session's ``efficiency`` (above 0.5: it can be driven back), and the force of the lifting spring
        with the press at 0 mm, N, with its growth per mm of travel.
        """
        self._m = 1e-3 * parameters.screw_lead / (2.0 * pi)
        self._excess = 1.0 / efficiency - 1.0
        self._drag_nm = parameters.screw_drag
        self._per_mm = 2.0 / parameters.screw_presliding
        self.spring_n, self.rate_n_per_mm = spring_n, rate_n_per_mm
        self._way = 0.0
        self._place_mm = 0.0

    def torque_nm(self, force_n: float, press_mm: float) -> float:
        """Return the drive's torque with the press at ``press_mm`` under a force; called once a step."""
        way = self._way + (press_mm - self._place_mm) * self._per_mm
        self._way = way = 1.0 if way > 1.0 else -1.0 if way < -1.0 else way
        self._place_mm = press_mm
        spring_n = self.spring_n + self.rate_n_per_mm * press_mm  # lifts_n, without a call
        return self._m * (force_n + spring_n) * (1.0 + way * self._excess) + way * self._drag_nm

    def lifts_n(self, press_mm: float) -> float:
        """Return the force of the lifting spring with the press at ``press_mm``, N."""
        return self.spring_n + self.rate_n_per_mm * press_mm

    def pushed_n(self, torque_nm: float, press_mm: float = 0.0) -> float:
        """Return the greatest force on the wheel that a torque can reach by pressing, N."""
        return (torque_nm - self._drag_nm) / (self._m * (1.0 + self._excess)) - self.lifts_n(press_mm)

    def held_n(self, torque_nm: float, press_mm: float = 0.0) -> float:
        """Return the greatest force against which a torque can hold the press, N."""
        return (torque_nm + self._drag_nm) / (self._m * (1.0 - self._excess)) - self.lifts_n(press_mm)


def shafts(parameters: DriveParameters, noise: float, seed: int) -> tuple[ShaftTorque, ShaftTorque, float]:
    """Return wheel's and belt's shaft and the screw's efficiency, each with its deviation in a session (``seed``)."""
    wheel, belt, screw = uniforms(3, seed, "session drives")
    gain = noise * parameters.torque_gain
    return (
        ShaftTorque(parameters.wheel_friction, 1.0 + gain * wheel),
        ShaftTorque(parameters.belt_friction, 1.0 + gain * belt),
        parameters.screw_efficiency + noise * parameters.screw_efficiency_spread * screw,
    )
