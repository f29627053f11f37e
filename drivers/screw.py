"""A screw between a drive's torque and a force, with bounds of its friction."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, pi
from typing import Annotated


@dataclass(frozen=True, slots=True)
class Screw:
    """A lead screw's conversion of torque to force, with bounds of its friction; raises ValueError if wrong.

    Pressing with a force F takes K (F + spring) / efficiency + drag, with K = lead / 2 pi. If the force drives the
    screw back, friction acts the other way: K (F + spring) (2 - 1 / efficiency) - drag (machine elements: a screw's
    efficiency as a drive and driven back). The ranges hold for every temperature and lubrication, and for the error of
    the drive's torque reading: they are measured against the load cell when the machine is put into operation.
    """

    lead_mm: Annotated[float, "mm"]                  # travel per turn
    efficiency_least: Annotated[float, "1"]
    efficiency_most: Annotated[float, "1"]
    drag_least_nm: Annotated[float, "N.m"]           # of nut and seals, whatever the force
    drag_most_nm: Annotated[float, "N.m"]
    spring_n: Annotated[float, "N"] = 0.0            # force that lifts the press when its drive has no power, at 0 mm
    spring_rate_n_per_mm: Annotated[float, "N/mm"] = 0.0  # more of it per mm of travel

    def __post_init__(self) -> None:
        for name in ("lead_mm", "efficiency_least", "efficiency_most", "drag_least_nm", "drag_most_nm", "spring_n",
                     "spring_rate_n_per_mm"):
            value: float = getattr(self, name)
            if not (isfinite(value) and value >= 0.0):
                raise ValueError(f"screw: {name} is {value}, it must be finite and at least 0")
        if not self.lead_mm > 0.0:
            raise ValueError("screw: lead must be above 0 mm")
        if not 0.5 < self.efficiency_least <= self.efficiency_most <= 1.0:
            raise ValueError(f"screw: efficiency {self.efficiency_least:g} to {self.efficiency_most:g}: expected 0.5 < "
                             "least <= most <= 1 (a press whose load cannot drive it back is not lifted by its spring)")
        if self.spring_rate_n_per_mm and not self.spring_n:
            raise ValueError("screw: spring_rate without spring")
        if not self.drag_least_nm <= self.drag_most_nm:
            raise ValueError("screw: drag_least is above drag_most")

    @property
    def nm_per_n(self) -> float:
        """Torque of a force without friction, N m per N: lead / 2 pi."""
        return 1e-3 * self.lead_mm / (2.0 * pi)

    def lifts_n(self, press_mm: float) -> float:
        """Return the spring's force with the press at ``press_mm``, N."""
        return self.spring_n + self.spring_rate_n_per_mm * press_mm

    @property
    def spring_nm(self) -> float:
        """Torque that the spring takes at 0 mm without friction: half the sum of both ways of unloaded travel, N m."""
        return self.nm_per_n * self.spring_n

    def torque_nm(self, force_n: float, press_mm: float = 0.0) -> float:
        """Return the torque that reaches a force (N, at least 0) at any friction within the bounds, N m."""
        return self.nm_per_n * (force_n + self.lifts_n(press_mm)) / self.efficiency_least + self.drag_most_nm

    def pushed_n(self, torque_nm: float, press_mm: float = 0.0) -> float:
        """Return the greatest force that a torque can reach by pressing, N; at least 0."""
        pushed = (torque_nm - self.drag_least_nm) * self.efficiency_most / self.nm_per_n
        return max(0.0, pushed - self.lifts_n(press_mm))

    def reached_n(self, torque_nm: float, press_mm: float = 0.0) -> float:
        """Return the force that a torque reaches at any friction within the bounds, N; at least 0."""
        reached = (torque_nm - self.drag_most_nm) * self.efficiency_least / self.nm_per_n
        return max(0.0, reached - self.lifts_n(press_mm))

    def held_n(self, torque_nm: float, press_mm: float = 0.0) -> float:
        """Return the greatest force on a press at rest or driven back, at a torque that the drive shows, N."""
        return max(0.0, (torque_nm + self.drag_most_nm) * self.held_n_per_nm - self.lifts_n(press_mm))

    @property
    def reached_n_per_nm(self) -> float:
        """Least force that a torque reaches by pressing, N per N m beyond ``drag_most_nm``."""
        return self.efficiency_least / self.nm_per_n

    @property
    def held_n_per_nm(self) -> float:
        """Greatest force that a torque holds when driven back, N per N m, with ``drag_most_nm`` added to the torque."""
        return 1.0 / (self.nm_per_n * (2.0 - 1.0 / self.efficiency_least))
