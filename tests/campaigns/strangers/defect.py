"""A defect: a place of the machine, its size, and the course of that size in time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any

from sim.faults.scene import Effect, Scene

Apply = Callable[[Scene, float], None]


@dataclass(frozen=True, slots=True)
class Place:
    """A quantity of a machine that can fail. ``low`` to ``high`` are the sizes that are drawn, in ``unit``; 0 is sound.
    ``make`` returns the function that sets the place's size. ``slow``: temperatures follow, so a case is watched for
    longer. ``whole``: the defect is either present or absent. ``rises_s``: the place cannot change faster than this, s.
    """

    name: str
    unit: str
    low: float
    high: float
    make: Callable[[Scene], Apply]
    slow: bool = False
    whole: bool = False
    rises_s: float = 0.0


@dataclass(frozen=True, slots=True)
class Course:
    """Size over time as a share of the drawn one: full after ``rises_s``, then present for ``duty`` of each
    ``every_s``. The defect ends permanently after ``lasts_s``.
    """

    rises_s: float = 0.0
    every_s: float = inf
    duty: float = 1.0
    lasts_s: float = inf

    def share(self, age_s: float) -> float:
        """Return the share at an age, 0 to 1."""
        if age_s >= self.lasts_s or (self.every_s < inf and age_s % self.every_s >= self.duty * self.every_s):
            return 0.0
        return min(age_s / self.rises_s, 1.0) if self.rises_s > 0.0 else 1.0

    def __str__(self) -> str:
        """Return the course as text."""
        words: list[str] = []
        if self.rises_s > 0.0:
            words.append(f"within {self.rises_s:.3g} s")
        if self.every_s < inf:
            words.append(f"for {self.duty:.0%} of every {self.every_s:.3g} s")
        if self.lasts_s < inf:
            words.append(f"for {self.lasts_s:.3g} s")
        return ", ".join(words) or "at once"


class Defect(Effect):
    """An active defect."""

    every_step = True

    def __init__(self, place: Place, size: float, course: Course) -> None:
        self._place, self._size, self._course = place, size, course
        self._begun_s = self._shown = 0.0
        self._apply: Apply | None = None

    def begin(self, scene: Scene, now: float) -> None:
        """Begin with the course at ``now`` s."""
        self._begun_s, self._apply = now, self._place.make(scene)
        self.renew(scene, now)

    def renew(self, scene: Scene, now: float) -> None:
        """Give the place its size at ``now`` s."""
        share = self._course.share(now - self._begun_s)
        size = self._size * (1.0 if self._place.whole and share > 0.0 else share)
        if self._apply is not None and (size != 0.0 or self._shown != 0.0):
            self._apply(scene, size)
        self._shown = size

    def end(self, scene: Scene, now: float) -> None:
        """Make the place sound."""
        if self._apply is not None:
            self._apply(scene, 0.0)


class Reading:
    """A sensor between its source and its device, with a gain, an offset, noise, or a frozen reading."""

    def __init__(self, source: Any, channel: int, floor: float) -> None:
        """Replace ``source``; a gain counts from ``floor``. ``channel``: of a load cell's forces."""
        self._source, self._channel, self._floor = source, channel, floor
        self.gain, self.offset, self.holds = 0.0, 0.0, False
        self._held: Any = None

    def _spoilt(self, true: float) -> float:
        return self._floor + (true - self._floor) * (1.0 + self.gain) + self.offset

    def forces_measured(self, t: float) -> tuple[float, float, float, float]:
        """Return the four channels of a load cell at ``t`` s."""
        forces: Any = list(self._source.forces_measured(t))
        forces[self._channel] = self._spoilt(forces[self._channel])
        if self.holds:
            self._held = forces if self._held is None else self._held
            forces = self._held
        else:
            self._held = None
        return tuple(forces)

    def _temperature(self, true_c: float) -> float:
        if not self.holds:
            self._held = None
            return self._spoilt(true_c)
        self._held = self._spoilt(true_c) if self._held is None else self._held
        return self._held

    def surface_measured_c(self, t: float) -> float:
        """Return a thermometer's reading at ``t`` s, degC."""
        return self._temperature(self._source.surface_measured_c(t))

    def controller_measured_c(self, t: float) -> float:
        """Return the reading of a controller's sensor at ``t`` s, degC."""
        return self._temperature(self._source.controller_measured_c(t))
