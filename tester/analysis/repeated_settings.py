"""One setting that a run measures several times: whether its values agree, and the difference of any two.

A setting (a compound and its setpoints) has one coefficient. Measurements of it, on one piece or on several, are values
x_i with the covariance

  C_ij = sum over causes e_ik e_jk,

e_ik the standard uncertainty in measurement i of cause k, with its sign. Independent causes (repeatability, drift, the
cell's zero) appear in the diagonal alone. Errors of a piece (its own factor, its diameter, its estimated wear) are
common to the measurements on it, with their size at the time of each. Errors of the rig are common to all; in a
difference only that of their effects remains. The sensitivity to temperature is the same for all: its error counts as
far as their temperatures differ.

One test judges the whole setting. With the generalised mean m (Aitken), chi2 = (x - m)' C^-1 (x - m) of k measurements
has k - 1 degrees of freedom. Where repeatability comes from few repeats, chi2 / (k - 1) is compared with Fisher's F.
Its degrees of freedom are those of the repeatability over the root of its greatest share in the variance of any
contrast. Welch and Satterthwaite divide by the square. So far out in the tail that gives up to 0.7 % of false alarms
with 4 degrees of freedom, and 2 % with 2 (Monte Carlo). The root, or below 4 degrees of freedom no division, gives at
most 0.2 %.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import Final

from tester.analysis.difference import RIG, Difference
from tester.analysis.kelvin import TEMPERATURE_SENSITIVITY, SurfaceWarmth
from tester.analysis.measurand import REPEATABILITY, Surroundings
from tester.analysis.quantiles import f_quantile
from tester.analysis.reference import COUNTERFACE
from tester.analysis.repeats import ConditionResult
from tester.analysis.terms import Acts, Term
from tester.analysis.uncertainty import Contribution, effective_df
from tester.base.arrays import Array

LEVEL: Final = 0.002
"""Probability of a false alarm for a setting whose measurements do agree."""
PIECE: Final = "piece"
"""Marks errors common to all measurements on a mounted piece (``Contribution.common``)."""
_FEW_DF: Final = 4.0
"""An estimate with fewer degrees of freedom counts as the whole variance of a contrast."""
_MANY_DF: Final = 1e5
"""Degrees of freedom of a standard uncertainty taken as known: for a quantile as good as infinite."""


@dataclass(frozen=True, slots=True)
class ErrorPart:
    """Contribution of one cause to a measurement: its standard uncertainty in mu, with its sign.

    ``common``: RIG (all measurements have the same error), PIECE (those on one piece), "" (independent). ``estimate``:
    name shared by errors whose size is estimated from the same repeats, with ``df`` degrees of freedom.
    """

    cause: str
    value: float
    common: str = ""
    estimate: str = ""
    df: float = inf


@dataclass(frozen=True, slots=True)
class SettingMeasurement:
    """One measurement of a setting: its condition and piece by number, the coefficient at the nominal temperature."""

    condition: int
    piece: int
    mu: float
    errors: tuple[ErrorPart, ...]

    @property
    def usable(self) -> bool:
        """Return whether coefficient and uncertainty are known."""
        return self.mu > 0.0 and all(isfinite(error.value) for error in self.errors)


def measurement(condition: int, piece: int, result: ConditionResult, by: Surroundings) -> SettingMeasurement:
    """Return a condition's result, with its budgets, as one measurement of its setting.

    The change of the counterface is left out on purpose: a setting that it has changed must not agree.
    """
    shared = {term.name: _shared(term, by) for term in by.terms}
    errors = [
        _part(contribution, condition, shared.get(contribution.name, contribution.common), by)
        for contribution in result.compound_budget.contributions
        if contribution.name not in (COUNTERFACE, TEMPERATURE_SENSITIVITY)
    ]
    errors.append(_of_sensitivity(result.mu, by.warmth, by.terms))
    return SettingMeasurement(condition, piece, result.mu if result.ok else float("nan"), tuple(errors))


def _shared(term: Term, by: Surroundings) -> str:
    """Return the measurements that share a term's error: RIG, PIECE or ""."""
    if term.acts is Acts.PIECE:
        return PIECE
    # A check of the diameter has an error of its own. The common error of a series of checks makes U slightly too
    # large.
    return "" if term.acts is Acts.LOSS and by.size.checked else term.common


def _part(contribution: Contribution, condition: int, common: str, by: Surroundings) -> ErrorPart:
    value = contribution.error if isfinite(contribution.error) else contribution.standard
    estimate = ""
    if contribution.name == REPEATABILITY:
        estimate = "pool" if contribution.df == float(by.pool.df) else f"condition {condition}"
    return ErrorPart(contribution.name, value, common, estimate, contribution.df)


def _of_sensitivity(mu: float, warmth: SurfaceWarmth, terms: Sequence[Term]) -> ErrorPart:
    """Return the error of the sensitivity to temperature; common to all measurements, as is the thermometer's bias."""
    return ErrorPart(TEMPERATURE_SENSITIVITY, mu * warmth.slope.u_per_kelvin * warmth.offset_k(terms), RIG)


def difference_of(first: SettingMeasurement, second: SettingMeasurement) -> Difference:
    """Return the second measurement less the first, with its standard uncertainty and degrees of freedom."""
    shared = RIG if first.piece != second.piece else (RIG, PIECE)
    first_parts, second_parts = (
        {(error.cause, error.common): error for error in each.errors if error.common and error.common in shared}
        for each in (first, second)
    )
    parts = [
        (error.value, error.estimate, error.df)
        for each in (first, second)
        for error in each.errors
        if not (error.common and error.common in shared)
    ]
    for key in dict.fromkeys([*first_parts, *second_parts]):
        pair = [each.get(key) for each in (first_parts, second_parts)]
        off = [part.value if part is not None else 0.0 for part in pair]
        parts.append((off[1] - off[0], "", min(part.df for part in pair if part is not None)))
    standard = sqrt(sum(value * value for value, _, _ in parts))
    return Difference(second.mu - first.mu, standard, effective_df(_by_estimate(parts), standard))


def _by_estimate(parts: Sequence[tuple[float, str, float]]) -> list[tuple[float, float]]:
    """Return standard uncertainties with their degrees of freedom, those of one estimate combined."""
    independent = [(abs(value), df) for value, estimate, df in parts if not estimate]
    for name in dict.fromkeys(estimate for _, estimate, _ in parts if estimate):
        listed = [(value, df) for value, estimate, df in parts if estimate == name]
        independent.append((sqrt(sum(value * value for value, _ in listed)), listed[0][1]))
    return independent


@dataclass(frozen=True, slots=True)
class SettingAgreement:
    """The test of a setting: ``chi2`` of its measurements about their mean, and its ``limit`` at ``LEVEL``."""

    measurements: tuple[SettingMeasurement, ...]
    mean: float
    """Generalised mean of the coefficients."""
    chi2: float
    limit: float
    off: tuple[float, ...]
    """Difference of each measurement from its prediction by all others together."""
    off_standard: tuple[float, ...]
    """Standard uncertainty of each difference."""

    @property
    def kept(self) -> bool:
        """Return whether the measurements agree."""
        return self.chi2 <= self.limit

    @property
    def df(self) -> int:
        """Return the degrees of freedom of chi2."""
        return len(self.measurements) - 1

    @property
    def outstanding(self) -> int | None:
        """Return the position of the most deviant measurement, from 0; None for two, which differ equally from each
        other."""
        if self.df < 2:
            return None
        return max(range(len(self.off)), key=lambda i: abs(self.off[i]) / self.off_standard[i])


def agreement(measurements: Sequence[SettingMeasurement]) -> SettingAgreement | None:
    """Return whether measurements of one setting agree; None with fewer than two of known uncertainty."""
    import numpy as np  # only runs that measure a setting several times pay for it

    used = tuple(measurement for measurement in measurements if measurement.usable)
    if len(used) < 2:
        return None
    values = np.array([value.mu for value in used])
    covariance, parts = _covariance(used)
    weights = np.linalg.pinv(covariance, hermitian=True)
    ones = np.ones(len(used))
    total = float(ones @ weights @ ones)
    mean = float(ones @ weights @ values) / total
    left = weights - np.outer(weights @ ones, ones @ weights) / total
    chi2 = float(values @ left @ values)
    diagonal = np.diag(left)
    contrasts = len(used) - 1
    df = _known_df(covariance, parts)
    limit = contrasts * f_quantile(1.0 - LEVEL, float(contrasts), min(max(df, 1.0), _MANY_DF))
    return SettingAgreement(
        used,
        mean,
        chi2,
        limit,
        tuple(float(value) for value in (left @ values) / diagonal),
        tuple(float(value) for value in 1.0 / np.sqrt(diagonal)),
    )


Estimated = tuple[Array, float]
"""Covariance by one estimate, and its degrees of freedom."""


def _covariance(used: Sequence[SettingMeasurement]) -> tuple[Array, list[Estimated]]:
    """Return the covariance of measurements, and its parts whose size is an estimate."""
    import numpy as np

    count = len(used)
    together: dict[str, Callable[[int, int], bool]] = {
        "": lambda i, j: i == j,
        PIECE: lambda i, j: used[i].piece == used[j].piece,
        RIG: lambda i, j: True,
    }
    covariance = np.zeros((count, count))
    estimated: dict[str, Estimated] = {}
    for cause, common in dict.fromkeys(
        (error.cause, error.common) for setting_measurement in used for error in setting_measurement.errors
    ):
        parts = [_named(setting_measurement, cause, common) for setting_measurement in used]
        off = np.array([error.value if error is not None else 0.0 for error in parts])
        mask = np.array([[together[common](i, j) for j in range(count)] for i in range(count)])
        covariance += np.outer(off, off) * mask
        for i, error in enumerate(parts):
            if error is not None and error.estimate:
                part, _ = estimated.setdefault(error.estimate, (np.zeros((count, count)), error.df))
                part[i, i] += error.value**2
    return covariance, list(estimated.values())


def _named(of: SettingMeasurement, cause: str, common: str) -> ErrorPart | None:
    return next((error for error in of.errors if (error.cause, error.common) == (cause, common)), None)


def _known_df(covariance: Array, parts: Sequence[Estimated]) -> float:
    """Return the degrees of freedom of the test due to estimated variances.

    The greatest share of an estimate in the variance of any contrast is the greatest eigenvalue of that estimate's
    covariance after the contrasts are made independent, with variance 1.
    """
    import numpy as np

    count = len(covariance)
    contrasts = np.eye(count)[1:] - 1.0 / count
    variances, directions = np.linalg.eigh(contrasts @ covariance @ contrasts.T)
    if not variances[0] > 0.0:
        return inf
    whitened = (directions / np.sqrt(variances)).T @ contrasts
    shares = [(float(np.linalg.eigvalsh(whitened @ part @ whitened.T)[-1]), df) for part, df in parts]
    limited = sum((sqrt(max(share, 0.0)) if df >= _FEW_DF else 1.0) / df for share, df in shares if df < inf)
    return 1.0 / limited if limited > 0.0 else inf
