"""Wear of a wheel from checks of its diameter: the rate k = V / (F s), with its uncertainty, after the GUM.

V is the volume worn off, F the normal load, s the distance slid; the product F s is summed up during the sliding. A
roll check is compared with the first of its series (the press's position has no zero of its own), so all checks of a
series share the error of that one: they are fitted together with an offset (generalised least squares), and the rate
from two of them alone uses the same covariance.

Contributions (JCGM 100:2008, 5.2): independent for every check, the position of the press and the load in it, and the
rubber's mean temperature (``u_mm``); common to all, the growth of the tread per kelvin (``u_growth_mm_k``); of the
rate, load, slip and the tread's width (``u_rate_percent``).

The diameter during a condition follows from the checks of the piece around it, with its uncertainty.

Speeds are computed with an assumed diameter: that of the last check, less the wear since then at the rig file's rate. A
check before the condition and one after it show the error of that assumption in between, in proportion to the distance
slid. Without a check after it, the wear rate from the piece's checks gives that error; without that rate, the whole
assumed wear is uncertain. A series of roll checks has no zero of its own: all of them share the error of the first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite, pi, sqrt

from tester.analysis.results import NAN
from tester.analysis.terms import Size
from tester.base.arrays import Array

NO_CONDITION = 0
TOUCH = "touch"
"""Method of a check by the place of a touch: its diameter is an estimate from all touches of the wheel so far."""


@dataclass(frozen=True, slots=True)
class WearCheck:
    """One check of a wheel's diameter.

    ``method``: roll (the press's position under a light load), person (a number in an answer) or touch.
    ``reference_s``: time of the series' first check, rig seconds. ``before``, ``after``: the conditions on either side,
    0 for none.
    """

    piece: int
    """Number of the checked piece."""
    method: str
    t_s: float
    reference_s: float
    before: int
    after: int
    diameter_mm: float
    """Cold, at the rig file's ``wear.reference``."""
    u_mm: float
    """Standard uncertainty of the diameter, of this check alone."""
    rubber_c: float
    """Mean temperature of the rubber: the average of hub and surface."""
    u_growth_mm_k: float
    """Standard uncertainty of the correction for thermal growth of the diameter, per kelvin."""
    press_mm: float
    """Means over whole turns; NaN where a person measured."""
    load_n: float
    sliding_m: float
    """Distance slid since the wheel was new."""
    exposure_n_m: float
    """Load times distance slid since the wheel was new."""
    width_mm: float
    u_rate_percent: float
    """Standard uncertainty of a rate from exposure and width, relative."""
    used: int
    """1; 0: rejected (larger than the check before, or no rubber left)."""
    expected_mm: float = NAN
    """The diameter assumed until then, cold; NaN in a record without it."""


COVERAGE = 2.0
"""Coverage factor for 95 %: most contributions are estimates of limits, taken as known (GUM G.6.4)."""


@dataclass(frozen=True, slots=True)
class WearRate:
    """A wear rate in mm3/(N m) with its standard and expanded (95 %) uncertainty; NaN without two checks."""

    rate: float = NAN
    standard: float = NAN
    checks: int = 0

    @property
    def expanded(self) -> float:
        """Return half the width of the interval that covers the rate with 95 %."""
        return COVERAGE * self.standard

    @property
    def resolved(self) -> bool:
        """Return whether the interval excludes 0: the checks show wear."""
        return self.rate > self.expanded


@dataclass(frozen=True, slots=True)
class ConditionWear:
    """Wear by one condition: the diameter before and after, mm, its standard uncertainty, and the rate."""

    before_mm: float
    after_mm: float
    u_mm: float
    rate: WearRate


def wear_rate(checks: Sequence[WearCheck], installed_mm: float = NAN) -> WearRate:
    """Return the rate over a wheel's life: a line through the volume worn off against load times distance.

    Touches alone give the mean rate since the wheel was new, of ``installed_mm``.

    A rate that varies between conditions scatters the checks about the line by more than their uncertainties; the
    uncertainty of their mean is then widened by that scatter (Birge ratio).
    """
    used = [check for check in checks if check.used and check.method != TOUCH]
    if not used:
        return _by_touch(checks, installed_mm)
    references = sorted({check.reference_s for check in used})
    count, unknown = len(used), len(references) + 1
    if count < unknown or len({check.exposure_n_m for check in used}) < 2:
        return WearRate(checks=count)
    import numpy as np  # only runs with checks pay for it

    first = [next(check for check in used if check.reference_s == at) for at in references]
    volumes, covariance = _volumes(used, {check.reference_s: check for check in first})
    design = np.zeros((count, unknown))
    for i, check in enumerate(used):
        design[i, references.index(check.reference_s)] = 1.0
        design[i, -1] = check.exposure_n_m - used[0].exposure_n_m
    if np.linalg.matrix_rank(design) < unknown:
        return WearRate(checks=count)
    weights = np.linalg.inv(covariance)
    spread = np.linalg.inv(design.T @ weights @ design)
    fitted = spread @ design.T @ weights @ volumes
    off = volumes - design @ fitted
    rate, variance = float(fitted[-1]), float(spread[-1, -1])
    # Birge ratio: scatter beyond the stated uncertainties widens the result, and smaller scatter never narrows it.
    if count > unknown:
        variance *= max(float(off @ weights @ off) / (count - unknown), 1.0)
    relative = 0.01 * max(check.u_rate_percent for check in used)
    return WearRate(rate, hypot(sqrt(variance), relative * rate), count)


def _by_touch(checks: Sequence[WearCheck], installed_mm: float) -> WearRate:
    last = next((check for check in reversed(checks) if check.used), None)
    if last is None or not last.exposure_n_m > 0.0:
        return WearRate(checks=len(checks))
    volume_mm3 = 0.25 * pi * last.width_mm * (installed_mm**2 - last.diameter_mm**2)
    return WearRate(volume_mm3 / last.exposure_n_m, _volume_per_mm(last) * last.u_mm / last.exposure_n_m, len(checks))


def condition_wear(checks: Sequence[WearCheck], condition: int) -> ConditionWear | None:
    """Return the wear by a condition, from the check before it and the one after; None without both."""
    used = [check for check in checks if check.used and check.method != TOUCH]
    after = next((check for check in used if check.after == condition), None)
    if condition == NO_CONDITION or after is None:
        return None
    earlier = [
        check for check in used
        if check.before == condition and check.reference_s == after.reference_s and check.piece == after.piece
    ]  # fmt: skip
    if not earlier:
        return None
    before = earlier[0]
    exposure = after.exposure_n_m - before.exposure_n_m
    pair = [before, after]
    volumes, covariance = _volumes(pair, {after.reference_s: before})
    variance = float(covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1])
    u_mm = sqrt(variance) / _volume_per_mm(before)
    if not exposure > 0.0:
        return ConditionWear(before.diameter_mm, after.diameter_mm, u_mm, WearRate(checks=2))
    rate = float(volumes[1] - volumes[0]) / exposure
    relative = 0.01 * max(check.u_rate_percent for check in pair)
    standard = hypot(sqrt(variance) / exposure, relative * rate)
    return ConditionWear(before.diameter_mm, after.diameter_mm, u_mm, WearRate(rate, standard, 2))


def _volumes(
    checks: Sequence[WearCheck], first: dict[float, WearCheck]
) -> tuple[Array, Array]:
    """Return the volume lost by each check since the first of its series, mm3, and the covariance of all."""
    import numpy as np

    lost: list[float] = []
    independent: list[float] = []
    growth: list[float] = []
    for check in checks:
        start = first[check.reference_s]
        per_mm = _volume_per_mm(check)
        lost.append(0.25 * pi * check.width_mm * (start.diameter_mm**2 - check.diameter_mm**2))
        independent.append((per_mm * check.u_mm) ** 2)
        growth.append(per_mm * check.u_growth_mm_k * (check.rubber_c - start.rubber_c))
    shared = np.array(growth)
    return np.array(lost), np.diag(independent) + np.outer(shared, shared)


def _volume_per_mm(check: WearCheck) -> float:
    """Return dV/dD in mm2: half the tread's surface."""
    return 0.5 * pi * check.width_mm * check.diameter_mm


@dataclass(frozen=True, slots=True)
class Worn:
    """A piece through its life: diameter when new and as last assumed, mm; sliding by then, m; checks of it."""

    installed_mm: float
    last_mm: float
    last_m: float
    checks: tuple[WearCheck, ...] = ()

    def size(self, at_m: float) -> Size:
        """Return the diameter after ``at_m`` metres of sliding, and its uncertainty by checks. NaN: at the end."""
        at_m = at_m if isfinite(at_m) else self.last_m
        used = [check for check in self.checks if check.used]
        before = next((check for check in reversed(used) if check.sliding_m <= at_m), None)
        if before is None:
            return self._believed(at_m)
        if before.method == TOUCH:
            return self._touched(before, at_m)
        later = [check for check in used if check.sliding_m > at_m and check.reference_s == before.reference_s]
        if later:
            return self._between(before, later[0], at_m)
        loss_mm = self._loss(before)
        since_mm = max(before.diameter_mm - self.last_mm, 0.0) * _share(before.sliding_m, at_m, self.last_m)
        u_mm = hypot(self._u(before), since_mm * self._rate_share())
        return self._sized(loss_mm + since_mm, u_mm, "the check of the diameter before it")

    def _between(self, before: WearCheck, after: WearCheck, at_m: float) -> Size:
        share = _share(before.sliding_m, at_m, after.sliding_m)
        worn_mm = before.diameter_mm - after.diameter_mm
        off_mm = after.expected_mm - after.diameter_mm if isfinite(after.expected_mm) else worn_mm
        u_mm = hypot(self._begun_u(before), self._read_u({before: 1.0 - share, after: share}), share * off_mm)
        return self._sized(self._loss(before) + share * worn_mm, u_mm, "checks of the diameter before and after it")

    def _touched(self, touch: WearCheck, at_m: float) -> Size:
        """Return the size by the last touch: its uncertainty counts the distance from the diameter in use."""
        since_mm = max(touch.expected_mm - self.last_mm, 0.0) * _share(touch.sliding_m, at_m, self.last_m)
        u_mm = hypot(touch.u_mm, since_mm * min(0.01 * touch.u_rate_percent, 1.0))
        return self._sized(self.installed_mm - touch.expected_mm + since_mm, u_mm, "touches of the wheel before it")

    def _believed(self, at_m: float) -> Size:
        loss_mm = max(self.installed_mm - self.last_mm, 0.0) if isfinite(self.last_mm) else 0.0
        return self._sized(loss_mm * _share(0.0, at_m, self.last_m), NAN, "")

    def _sized(self, loss_mm: float, u_mm: float, source: str) -> Size:
        return Size(self.installed_mm - loss_mm, max(loss_mm, 0.0), u_mm, source)

    def _loss(self, check: WearCheck) -> float:
        return self.installed_mm - check.diameter_mm

    def _u(self, check: WearCheck) -> float:
        """Return the standard uncertainty of the loss by a check."""
        return hypot(self._begun_u(check), self._read_u({check: 1.0}))

    def _read_u(self, shares: dict[WearCheck, float]) -> float:
        """Return the uncertainty from the readings of checks, by the share of each; roll checks are relative to their
        first."""
        weights = dict(shares)
        first = self._first(next(iter(shares)))
        if first.method == "roll":
            weights[first] = weights.get(first, 0.0) - 1.0
        return hypot(*(share * reading.u_mm for reading, share in weights.items()))

    def _first(self, check: WearCheck) -> WearCheck:
        return next(
            candidate for candidate in self.checks if candidate.used and candidate.reference_s == check.reference_s
        )

    def _begun_u(self, check: WearCheck) -> float:
        """Return the uncertainty of the loss at the start of a check's series, mm; 0 for a person, whose gauge has its
        own zero."""
        first = self._first(check)
        if check.method != "roll":
            return 0.0
        begun_mm, used = self._loss(first), [candidate for candidate in self.checks if candidate.used]
        earlier = [candidate for candidate in used if candidate.t_s < first.t_s]
        if earlier:
            since_mm = begun_mm - self._loss(earlier[-1])
            return hypot(self._u(earlier[-1]), since_mm * self._rate_share())
        rate = wear_rate(used)
        if not rate.resolved:
            return abs(begun_mm)
        per_mm = 0.5 * pi * first.width_mm * self.installed_mm
        by_rate_mm, u_mm = rate.rate * first.exposure_n_m / per_mm, rate.standard * first.exposure_n_m / per_mm
        return hypot(by_rate_mm - begun_mm, u_mm)

    def _rate_share(self) -> float:
        """Return the relative standard uncertainty of the wear since a check: 1 where checks show no rate."""
        rate = wear_rate(self.checks)
        return rate.standard / rate.rate if rate.resolved else 1.0


def _share(from_m: float, at_m: float, to_m: float) -> float:
    """Return the position of a distance between two others, 0..1; 1 where they are equal."""
    return min(max((at_m - from_m) / (to_m - from_m), 0.0), 1.0) if to_m > from_m else 1.0
