"""The diameter during a condition, with its uncertainty, from the checks of the piece around it.

Speeds are computed with an assumed diameter: that of the last check, less the wear since then at the rig file's rate. A
check before the condition and one after it show the error of that assumption in between, in proportion to the distance
slid. Without a check after it, the wear rate from the piece's checks gives that error; without that rate, the whole
assumed wear is uncertain. A series of roll checks has no zero of its own: all of them share the error of the first.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, isfinite, pi

from tester.analysis.results import NAN
from tester.analysis.terms import Size
from tester.analysis.wear_rate import WearCheck, wear_rate


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
