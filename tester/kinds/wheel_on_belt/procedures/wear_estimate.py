"""A wheel's loss of diameter and its wear rate, from the places of its touches.

A wheel that has lost rubber is touched later. So is rubber that a load has dented: it gives way by nearly the same
share of the load in every decade of time, and recovers as slowly. The estimate therefore has three unknowns: the loss
of diameter, the wear rate, and that share (Kalman filter; each touch is one observation). Loss follows load times
distance and the dent follows the loads of the last hours, so their parts separate; a touch without sliding before it
shows the dent alone. The rate that the rig file believes is the prior.

Places are compared at equal load, corrected for heat growth; after a change of temperature the loss is as uncertain as
the growth. Stiffness hardly matters: at the 10 N of a touch, 20 % of it are 0.03 mm of depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import hypot, nan, pi, sqrt
from typing import Final

from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm

PRIOR_RATE: Final = 0.2
"""Standard uncertainty of a believed wear rate, mm3/(N m) [A]: compounds wear by 0.02 to 0.6."""
PRIOR_SHARE: Final = 0.03
"""... of the share of a load that rubber gives way by in a decade of time [A]: 0.02 to 0.05 for filled rubber."""
PLACE_MM: Final = 0.05
"""... of a diameter from the place of one touch, mm [A]: runout (0.05 mm of radius, peak to peak), a scan at 2 mm/s."""
DENT_SHARE: Final = 0.1
"""... of the dent that the model states, a share [A]."""
BRIEF_SHARE: Final = 0.2
"""... added where the contact was open for less than ``BRIEF_S``: the quickest part of a dent is still there [A]."""
BRIEF_S: Final = 1.4
RATE_CHANGES: Final = 0.03
"""Share by which a rate changes from touch to touch [A]: conditions differ in load, slip and temperature."""
LOSS_CHANGES: Final = 0.1
"""Share by which the loss between two touches differs from rate times load times distance [A]."""
SHARE_CHANGES: Final = 0.001
"""How much the share of the dent changes from touch to touch [A]: warm rubber gives way more."""
LEAST_SHARE: Final = 0.005
"""Least share at which the dent's slope is computed: at 0 it is steepest."""
DECADES: Final = 5
"""Number of averages of the load, the first over 1 s, each further one over ten times as long."""
FOLD_S: Final = 0.5
"""Period in which the loads are added to the memories, s."""
FAR_U: Final = 3.0
"""A touch disagrees if it is off by more than this many standard uncertainties of both itself and the estimate [A]."""
FAR_MM: Final = 0.3
"""... and by more than this, mm of diameter [A]: 3 mm/s of slip at 0.8 m/s."""
DISAGREEMENTS: Final = 2
"""Touches in a row that disagree before a new wheel is asked for [A]."""


@dataclass(slots=True)
class LoadMemory:
    """The loads of the last hours: their averages over one to 10,000 s."""

    averages_n: list[float] = field(default_factory=lambda: [0.0] * DECADES)
    _sum_n_s: float = 0.0
    _since_s: float = 0.0

    def add(self, load_n: float, dt: float) -> None:
        """Add a scan of ``dt`` s under a load, N; a load that is unknown counts as 0."""
        if load_n > 0.0:
            self._sum_n_s += load_n * dt
        self._since_s += dt
        if self._since_s >= FOLD_S:
            self.fold()

    def fold(self) -> None:
        """Bring the averages up to date."""
        since_s = self._since_s
        if not since_s > 0.0:
            return
        mean_n, averages, over_s = self._sum_n_s / since_s, self.averages_n, 1.0
        for i in range(DECADES):
            averages[i] += (mean_n - averages[i]) * since_s / (over_s + since_s)
            over_s *= 10.0
        self._sum_n_s = self._since_s = 0.0

    def remembered_n(self) -> float:
        """Return the sum of the averages, N: a share of it is the load that dented rubber lacks."""
        self.fold()
        return sum(self.averages_n)


@dataclass(slots=True)
class WearEstimate:
    """The estimate of one mounted wheel; ``begin`` it with a rate. Lengths are of the diameter, in mm."""

    rate_mm3_per_n_m: float = 0.0
    u_rate: float = PRIOR_RATE
    loss_mm: float = 0.0
    share: float = 0.0
    """Share of a load by which the rubber gives way in a decade of time."""
    place_mm: float = nan
    """Place of the wheel's first touch, less half of the loss by then; NaN before it."""
    touches: int = 0
    disagreed: int = 0
    """Number of touches in a row that disagreed."""
    off_mm: float = 0.0
    """How much larger the loss is by the last touch than by the estimate before it."""
    reference_mm: float = PLACE_MM
    """Standard uncertainty of the place that the loss is measured from; 0 once a check has measured the loss."""
    rubber_c: float = nan
    """Mean temperature of the rubber at the last touch, degC; NaN before it."""
    _exposure_n_m: float = 0.0
    _p: list[float] = field(default_factory=lambda: [PLACE_MM**2, 0.0, 0.0, PRIOR_RATE**2, 0.0, PRIOR_SHARE**2])
    """Covariance: loss, loss and rate, loss and share; rate, rate and share; share."""

    def begin(
        self, rate_mm3_per_n_m: float, u_rate: float, loss_mm: float, exposure_n_m: float, u_mm: float = 0.0
    ) -> None:
        """Begin with a wheel that was just mounted; its first touch is the reference of the later ones.

        ``u_mm``: standard uncertainty of its loss so far, and of the dent that earlier loads have left.
        """
        self.rate_mm3_per_n_m, self.u_rate = rate_mm3_per_n_m, u_rate
        self.loss_mm, self._exposure_n_m = loss_mm, exposure_n_m
        self.place_mm, self.touches, self.disagreed, self.rubber_c = nan, 0, 0, nan
        self.reference_mm = hypot(PLACE_MM, u_mm)
        self._p = [PLACE_MM**2, 0.0, 0.0, u_rate**2, 0.0, PRIOR_SHARE**2]

    @property
    def u_mm(self) -> float:
        """Standard uncertainty of the loss at the last touch, mm.

        The place of the first touch, to which all others are compared, is in it for ever.
        """
        return hypot(sqrt(max(self._p[0], 0.0)), self.reference_mm)

    def since(self, exposure_n_m: float) -> float:
        """Return load times distance since the last touch, N m, from that since the wheel was mounted."""
        return max(exposure_n_m - self._exposure_n_m, 0.0)

    def slid(self, exposure_n_m: float, per_n_m: float) -> None:
        """Add the wear since the last touch; ``per_n_m``: loss of diameter per rate and load times distance."""
        slope = per_n_m * self.since(exposure_n_m)
        self._exposure_n_m = exposure_n_m
        worn_mm = slope * self.rate_mm3_per_n_m
        self.loss_mm += worn_mm
        ll, lr, ls, rr, rs, ss = self._p
        changed = RATE_CHANGES * self.rate_mm3_per_n_m if worn_mm > 0.5 * PLACE_MM else 0.0
        self._p = [
            ll + 2.0 * slope * lr + slope * slope * rr + (LOSS_CHANGES * worn_mm) ** 2, lr + slope * rr,
            ls + slope * rs, rr + changed * changed, rs, ss + SHARE_CHANGES**2,
        ]  # fmt: skip

    def warmed(self, rubber_c: float, u_mm_per_k: float) -> None:
        """Add the growth's uncertainty since the last touch: ``u_mm_per_k`` times the change of temperature, degC."""
        changed_k = rubber_c - self.rubber_c
        if changed_k == changed_k:
            self._p[0] += (u_mm_per_k * changed_k) ** 2
        self.rubber_c = rubber_c

    def touch(self, place_mm: float, touch_n: float, remembered_n: float, open_s: float, stiffness: float) -> bool:
        """Take the place of a touch under ``touch_n``, of a cold wheel; return whether the estimate has used it."""
        if self.place_mm != self.place_mm:
            self.place_mm = place_mm - 0.5 * self.loss_mm
            self.touches = 1
            return True
        seen_mm = 2.0 * (place_mm - self.place_mm)
        share = max(self.share, LEAST_SHARE)
        lost_n = share * remembered_n
        dent_mm = 2.0 * (depth_mm(touch_n + lost_n, stiffness) - depth_mm(touch_n, stiffness))
        slope = 2.0 * remembered_n * (depth_mm(touch_n + lost_n + 0.5, stiffness)
                                      - depth_mm(touch_n + lost_n - 0.5, stiffness))  # fmt: skip
        dent_mm += slope * (self.share - share)
        own_mm = hypot(PLACE_MM, DENT_SHARE * dent_mm, BRIEF_SHARE * dent_mm if open_s < BRIEF_S else 0.0)
        self.off_mm = off_mm = seen_mm - self.loss_mm - dent_mm
        ll, lr, ls, rr, rs, ss = self._p
        to_loss, to_rate, to_share = ll + slope * ls, lr + slope * rs, ls + slope * ss
        known = max(to_loss + slope * to_share, 0.0)
        if abs(off_mm) > max(FAR_U * (own_mm + sqrt(known)), FAR_MM):
            self.disagreed += 1
            return False
        self.disagreed = 0
        self.touches += 1
        all_mm2 = known + own_mm * own_mm
        a, b, c = to_loss / all_mm2, to_rate / all_mm2, to_share / all_mm2
        self.loss_mm += a * off_mm
        self.rate_mm3_per_n_m = max(self.rate_mm3_per_n_m + b * off_mm, 0.0)
        self.share += c * off_mm
        self._p = [
            ll - a * to_loss, lr - a * to_rate, ls - a * to_share, rr - b * to_rate, rs - b * to_share,
            ss - c * to_share,
        ]  # fmt: skip
        if self.share < 0.0:
            self._no_dent()
        self.u_rate = sqrt(max(self._p[3], 0.0))
        return True

    def _no_dent(self) -> None:
        """Replace a share below 0, which no rubber has, by 0, and correct loss and rate accordingly."""
        _, _, ls, _, rs, ss = self._p
        self.loss_mm -= ls / ss * self.share
        self.rate_mm3_per_n_m = max(self.rate_mm3_per_n_m - rs / ss * self.share, 0.0)
        self.share = 0.0

    def measured(self, loss_mm: float, u_mm: float) -> None:
        """Take the loss that a check of the diameter found; the dent at the next touch starts anew from it."""
        self.off_mm = loss_mm - self.loss_mm
        self.loss_mm = loss_mm
        _, _, _, rr, rs, ss = self._p
        self._p = [u_mm * u_mm, 0.0, 0.0, rr, rs, ss]
        self.reference_mm = 0.0


def loss_per_n_m(diameter_mm: float, width_mm: float) -> float:
    """Return the loss of diameter, mm, per wear rate (mm3/(N m)) and load times distance (N m)."""
    return 2.0 / (pi * diameter_mm * width_mm)
