"""The rig of a wheel on a belt, with the actions of the person at it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from sim.machines.wheel_on_belt.mechanics import WheelMechanics
from sim.machines.wheel_on_belt.rubbing import WheelSetting
from sim.physics.slip import slip_velocity

_NO_ANGLES: Final = frozenset({"wheel_speed", "slip_velocity", "load", "temperature"})
"""Axes of a condition that are no angle; all others are angles."""


class WheelRig(WheelMechanics):
    """A rubber friction tester with a wheel on a belt. ``install``, ``remount`` and ``begin_repeat`` are actions of the
    person at the rig.
    """

    __slots__ = ()

    def ruler(self, axis: str) -> float:
        """Return the true position of an axis: the wheel's shaft in deg, belt and press in mm, others in deg;
        "diameter" of the cold wheel, mm, and force of the "spring" that lifts the press, N."""
        if axis == "wheel":
            return math.degrees(self._turned_rad)
        if axis == "belt":
            return 1e3 * self._travelled_m
        if axis == "diameter":
            return self.plant.cold_mm
        if axis == "spring":
            return self._screw.lifts_n(self._press.axis.position)
        place = self.axes[axis].axis.position if axis in self.axes else 0.0
        return -place if axis in self.turned else place

    def hang(self, fx: float, fy: float, fz: float) -> None:
        """Hang a weight on the load cell: forces in N besides those of the contact; zeros remove it."""
        self.plant.hung = (fx, fy, fz) if fx or fy or fz else None

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Mount a new wheel."""
        self.mounted = specimen, wheel, compound
        self.plant_s = self.now_s
        self.plant.install(specimen, wheel, compound, new_specimen)

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount a worn wheel: diameter in mm, sliding distance in m; the rig is at ambient temperature."""
        self.mounted = specimen, wheel, compound
        self.plant.install(specimen, wheel, compound, True, diameter_mm, sliding_m)

    def keep(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount the wheel of an interrupted run as ``remount`` does, unless this rig has lived on with it."""
        if self.mounted != (specimen, wheel, compound):
            self.remount(specimen, wheel, compound, diameter_mm, sliding_m)

    def mount_again(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount a wheel again that was on before: diameter in mm, sliding distance in m; the rig stays warm."""
        self.mounted = specimen, wheel, compound
        self.plant_s = self.now_s
        self.plant.install(specimen, wheel, compound, False, diameter_mm, sliding_m)

    def cover(self, surface: str) -> None:
        """Put a belt of this name on, clean."""
        self.plant_s = self.now_s
        self.plant.cover(surface)

    def belt_travelled(self, travel_m: float) -> None:
        """Wear a fresh belt by the travel of an interrupted run under load, m; a rig that has lived on has that belt.
        """
        if self.plant.belt_grip == 1.0:
            self.plant.travel(travel_m, self.ambient_c)

    def truth(self, held: Mapping[str, float]) -> dict[str, float]:
        """Return the plant's truth about the repeat that has begun, at setpoints by axis (speeds m/s, N, deg, degC)."""
        belt_m_s = held["wheel_speed"] - held["slip_velocity"]
        slip_m_s = slip_velocity(held["wheel_speed"], belt_m_s, held["sideslip"])[2]
        return self.plant.truth(held["temperature"], held["load"], slip_m_s, held["sideslip"])

    def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
        """Begin a repeat at setpoints by axis: restart the random streams and the sensors' dither."""
        angles = tuple(value for axis, value in held.items() if axis not in _NO_ANGLES)
        setting = WheelSetting(held["slip_velocity"], held["load"], angles, held["temperature"])
        self.plant.begin_repeat(condition, repeat, attempt, setting)
        self.restart_dither()
