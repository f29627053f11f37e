"""The contact of wheel and belt: where it begins, how firm it may be, and the force that the press's place predicts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from math import nan
from typing import Final

from tester.kinds.wheel_on_belt.image.process_image import Readings

UNLOADED_N: Final = 20.0
"""Below this the contact counts as unloaded, N [A]: noise, zero drift and the runout of a wheel that just touches.

No key of the rig file: what a rig may differ in, the zero of its cell, has keys of its own (``zero_stop``,
``arming.unloaded``), which may not be looser than 30 N because they lean on this. Were 20 N set higher, a rig would
turn its angles, and end its stops, under a load; set lower, a drifting zero would keep stops from ending.
"""
STIFFNESS_EXPONENT: Final = 0.23
"""Tangent stiffness of the line contact grows with load to this power: 125 to 172 N/mm from 100 to 400 N [A]."""
_DEPTH_SHARE: Final = 1.0 / (1.0 - STIFFNESS_EXPONENT)


@dataclass(slots=True)
class Contact:
    """The contact as the load loop tracks it."""

    contact_mm: float = nan
    """Press position at the last first touch; NaN until the wheel has been touched since its installation."""
    in_contact: bool = False
    loaded: bool = False
    """Half of the wanted load has been reached since touching: from then on losing it is a fault."""
    highest_n: float = 0.0
    lowest_n: float = 0.0
    """The wanted load, followed slowly downwards (highest) and upwards (lowest): what the load is watched against
    while the press brings it to another value."""


def depth_mm(force_n: float, stiffness_n_per_mm: float) -> float:
    """Return how far beyond the first touch the press stands under ``force_n``, mm: the integral of dF over the tangent
    stiffness, which is ``stiffness_n_per_mm`` at 200 N; 0 where there is no force."""
    if not force_n > 0.0:
        return 0.0
    return _DEPTH_SHARE * force_n / (stiffness_n_per_mm * math.pow(force_n / 200.0, STIFFNESS_EXPONENT))


WINDOW_S: Final = 0.1
"""Readings are compared with those of this long before, s [A]: a step stands in the comparison for that time."""
PLACES: Final = 64
"""Readings kept: at the sliding rate of the scan a window takes a quarter of them."""
LEARNED_N: Final = 15.0
"""A change of force by this much shows how stiff the contact is, N [A]: twice the runout's part."""
SEEN_S: Final = 0.2
"""How long such changes must last until the stiffness counts as seen, s [A]."""
LEARNING_S: Final = 1.0
"""Over this long it is averaged, s [A]: ten times what a step is in the comparison."""
SOFTEST: Final = 0.5
STIFFEST: Final = 2.0
"""Between these shares of ``loops.load.stiffness`` a stiffness is believed [A]: the rubber's own spread is 30 %."""
_POWER: Final = 1.0 / (1.0 - STIFFNESS_EXPONENT)


def force_n(depth: float, stiffness_n_per_mm: float) -> float:
    """Return the force at a depth in mm: the inverse of ``depth_mm``; 0 without contact."""
    if not depth > 0.0:
        return 0.0
    return math.pow(depth * stiffness_n_per_mm / (_POWER * math.pow(200.0, STIFFNESS_EXPONENT)), _POWER)


@dataclass(slots=True)
class ForceObserver:
    """Predicts the change of force over the last window from where the press has gone."""

    stiffness_n_per_mm: float
    """``loops.load.stiffness``: where nothing has been seen yet."""
    unseen_share: float
    """How far off that stiffness a contact may be."""
    seen_share: float
    """The same of one that has been seen."""
    cross_share: float
    """Of the change of friction that the normal force may show: cross-talk and misalignment of the cell."""
    share: float = 1.0
    """Stiffness seen over ``stiffness_n_per_mm``."""
    off_n: float = 0.0
    """How far the force has changed beyond what press and friction explain, in either direction, N."""
    stamp_s: float = -math.inf
    seen_s: float = 0.0
    """How long changes of force have shown the stiffness since the contact was closed."""
    _at: int = 0
    kept: int = 0
    """Readings that are compared with."""
    _times: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _forces: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _frictions: list[float] = field(default_factory=lambda: [nan] * PLACES)
    _places: list[float] = field(default_factory=lambda: [nan] * PLACES)

    def forget(self) -> None:
        """Compare nothing with what was before: the contact is open, or not wanted."""
        self.kept = 0
        self.off_n = self.seen_s = 0.0

    def update(self, r: Readings) -> None:
        """Take in a new reading of the load cell, with the press where it is now."""
        now, force, place = r.cell_at_s, r.force_z_n, r.press_mm
        elapsed_s, self.stamp_s = now - self.stamp_s, now
        times = self._times
        at, kept = self._at, self.kept
        # Leave out what is older than the window needs; the oldest that stays is what is compared with.
        while kept > 1 and now - times[(at - kept + 1) % PLACES] >= WINDOW_S:
            kept -= 1
        if kept:
            first = (at - kept) % PLACES
            self._compare(r, first, min(elapsed_s, WINDOW_S))
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
