"""The contact of wheel and belt: its place, its stiffness, and the force predicted from the press's position."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from math import nan
from typing import Final

from tester.kinds.wheel_on_belt.image.process_image import Readings

UNLOADED_N: Final = 20.0
"""Force below which the contact counts as unloaded, N [A]: noise, zero drift, runout of a wheel that just touches.

It is no key of the rig file: rigs differ in the zero of their cells, which has its own keys (``zero_stop``,
``arming.unloaded``). These may not exceed 30 N because they depend on this value. With more than 20 N a rig would
turn its angles, and end its stops, under a load; with less, a drifting zero would prevent stops from ending.
"""
STIFFNESS_EXPONENT: Final = 0.23
"""Exponent of load in the tangent stiffness of the line contact: 125 to 172 N/mm from 100 to 400 N [A]."""
_DEPTH_SHARE: Final = 1.0 / (1.0 - STIFFNESS_EXPONENT)


@dataclass(slots=True)
class Contact:
    """The contact as the load loop tracks it."""

    contact_mm: float = nan
    """Press position at the last first touch; NaN until the wheel has been touched since its installation."""
    in_contact: bool = False
    loaded: bool = False
    """Half of the wanted load has been reached since touching: losing the load is now a fault."""
    highest_n: float = 0.0
    lowest_n: float = 0.0
    """The wanted load, followed slowly downwards (highest) and upwards (lowest): the limits of the load while the press
    changes it."""


def depth_mm(force_n: float, stiffness_n_per_mm: float) -> float:
    """Return the depth of the press beyond the first touch under ``force_n``, mm; 0 without force.

    It is the integral of dF over the tangent stiffness, which is ``stiffness_n_per_mm`` at 200 N.
    """
    if not force_n > 0.0:
        return 0.0
    return _DEPTH_SHARE * force_n / (stiffness_n_per_mm * math.pow(force_n / 200.0, STIFFNESS_EXPONENT))


WINDOW_S: Final = 0.1
"""Age of the readings that new readings are compared with, s [A]: a step shows in the comparison for this time."""
PLACES: Final = 64
"""Number of readings kept: at the scan rate of sliding a window takes a quarter of them."""
LEARNED_N: Final = 15.0
"""Least expected change of force that shows the contact's stiffness, N [A]: twice the runout's part."""
SEEN_S: Final = 0.2
"""Duration of such changes after which the stiffness counts as measured, s [A]."""
LEARNING_S: Final = 1.0
"""Averaging time of the stiffness, s [A]: ten times ``WINDOW_S``."""
SOFTEST: Final = 0.5
STIFFEST: Final = 2.0
"""Bounds of a measured stiffness, as shares of ``loops.load.stiffness`` [A]: rubbers differ by 30 %."""
_POWER: Final = 1.0 / (1.0 - STIFFNESS_EXPONENT)
_AT_200_N: Final = math.pow(200.0, STIFFNESS_EXPONENT)


def force_n(depth: float, stiffness_n_per_mm: float) -> float:
    """Return the force at a depth in mm: the inverse of ``depth_mm``; 0 without contact."""
    if not depth > 0.0:
        return 0.0
    return math.pow(depth * stiffness_n_per_mm / (_POWER * _AT_200_N), _POWER)


@dataclass(slots=True)
class ForceObserver:
    """Predicts the change of force over the last window from the press's motion."""

    stiffness_n_per_mm: float
    """``loops.load.stiffness``, used until a stiffness is measured."""
    unseen_share: float
    """Tolerance of an unmeasured stiffness, a share."""
    seen_share: float
    """Tolerance of a measured stiffness, a share."""
    cross_share: float
    """Share of a friction change that may show in the normal force: cross-talk and misalignment of the cell."""
    share: float = 1.0
    """Measured stiffness over ``stiffness_n_per_mm``."""
    off_n: float = 0.0
    """Change of force, of either sign, that press and friction do not explain, N."""
    stamp_s: float = -math.inf
    seen_s: float = 0.0
    """Duration of stiffness measurement since the contact was closed, s."""
    _at: int = 0
    kept: int = 0
    """Number of readings in the window."""
    _times: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _forces: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _frictions: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _places: list[float] = field(default_factory=lambda: [nan] * PLACES)

    def forget(self) -> None:
        """Drop all earlier readings: the contact is open, or not wanted."""
        self.kept = 0
        self.off_n = self.seen_s = 0.0

    def update(self, r: Readings) -> None:
        """Process a new reading of the load cell and the press's position."""
        now, force, place = r.cell_at_s, r.force_z_n, r.press_mm
        elapsed_s, self.stamp_s = now - self.stamp_s, now
        times = self._times
        at, kept = self._at, self.kept
        # Drop readings older than the window; the new reading is compared with the oldest that stays.
        while kept > 1 and now - times[(at - kept + 1) % PLACES] >= WINDOW_S:
            kept -= 1
        if kept:
            first = (at - kept) % PLACES
            self._compare(r, first, elapsed_s if elapsed_s < WINDOW_S else WINDOW_S)
        times[at], self._forces[at], self._frictions[at], self._places[at] = now, force, r.force_x_n, place
        self._at = (at + 1) % PLACES
        self.kept = kept + 1 if kept < PLACES - 1 else kept

    def _compare(self, r: Readings, first: int, elapsed_s: float) -> None:
        before = self._forces[first]
        if before < UNLOADED_N:
            self.off_n = self.seen_s = 0.0
            return
        stiffness = self.share * self.stiffness_n_per_mm
        predicted = force_n(depth_mm(before, stiffness) + r.press_mm - self._places[first], stiffness)
        change, expected = r.force_z_n - before, predicted - before
        cross = self.cross_share * abs(r.force_x_n - self._frictions[first])
        share = self.seen_share if self.seen_s >= SEEN_S else self.unseen_share
        self.off_n = abs(change - expected) - cross - share * abs(expected)
        if expected > LEARNED_N and r.force_z_n > UNLOADED_N:
            self.seen_s += elapsed_s
            gain = elapsed_s / min(self.seen_s, LEARNING_S)
            seen = self.share * (1.0 + (change / expected - 1.0) * gain)
            self.share = min(max(seen, SOFTEST), STIFFEST)
