"""One setting that a run measures several times: whether its values agree, and by how much two of them differ.

A setting (a compound, and what it is held at) has one coefficient. Measurements of it, on one piece or on several, are
values x_i with the covariance

    C_ij = sum over causes e_ik e_jk,

e_ik the standard uncertainty in measurement i of cause k, with its sign. What is each measurement's own
(repeatability, drift, the cell's zero) is in the diagonal alone. What a piece brings (its own factor, its diameter,
what is believed to be worn off it) is shared by the measurements on it, by each as much as it has then. What the rig
brings is shared by all, and drops out of differences but for what it moves them by differently. The sensitivity to
temperature is the same for all: its error counts as far as their temperatures differ.

One test judges the whole setting. With the generalised mean m (Aitken), chi2 = (x - m)' C^-1 (x - m) of k measurements
has k - 1 degrees of freedom. Where repeatability comes from few repeats, chi2 / (k - 1) is held against Fisher's F. Its
degrees of freedom are those of the repeatability over the root of its greatest share in the variance of any contrast.
Welch and Satterthwaite divide by the square, which so far out in the tail gives up to 0.7 % of false alarms with 4
degrees of freedom, and 2 % with 2 (Monte Carlo); with the root, and with fewer than 4 without it, no more than 0.2 %.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isfinite, sqrt
from typing import TYPE_CHECKING, Final

from tester.analysis.difference import RIG, Difference
from tester.analysis.kelvin import TEMPERATURE_SENSITIVITY, SurfaceWarmth
from tester.analysis.measurand import REPEATABILITY, Surroundings
from tester.analysis.quantiles import f_quantile
from tester.analysis.reference import COUNTERFACE
from tester.analysis.repeats import ConditionResult
from tester.analysis.terms import Acts, Term
from tester.analysis.uncertainty import Contribution, effective_df

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LEVEL: Final = 0.002
"""Chance of a false alarm for a setting whose measurements do agree."""
PIECE: Final = "piece"
"""Of errors that all measurements on what is mounted have (``Contribution.common``)."""
_FEW_DF: Final = 4.0
"""With fewer degrees of freedom than these, what is known beside an estimate does not count."""
_MANY_DF: Final = 1e5
"""Degrees of freedom of a standard uncertainty that is taken as known, as far as a quantile tells."""


@dataclass(frozen=True, slots=True)
class ErrorPart:
    """What one cause adds to a measurement: its standard uncertainty in mu, with its sign.

    ``common``: RIG (all measurements have the same error), PIECE (those on one piece), "" (none other). ``estimate``:
    errors whose size is known from the same repeats share one, with ``df`` degrees of freedom.
    """

    cause: str
    value: float
    common: str = ""
    estimate: str = ""
    df: float = inf


@dataclass(frozen=True, slots=True)
class SettingMeasurement:
    """One measurement of a setting: its condition and piece by number, the coefficient at the temperature asked for."""

    condition: int
    piece: int
    mu: float
    errors: tuple[ErrorPart, ...]

    @property
    def usable(self) -> bool:
        """Return whether coefficient and uncertainty are known."""
        return self.mu > 0.0 and all(isfinite(one.value) for one in self.errors)


def measurement(condition: int, piece: int, result: ConditionResult, by: Surroundings) -> SettingMeasurement:
    """Return a condition's result, with its budgets, as one measurement of its setting.

    What the counterface has changed is left out: a setting that it has changed does not agree.
    """
    shared = {one.name: _shared(one, by) for one in by.terms}
    errors = [
        _part(one, condition, shared.get(one.name, one.common), by)
        for one in result.compound_budget.contributions
        if one.name not in (COUNTERFACE, TEMPERATURE_SENSITIVITY)
    ]
    errors.append(_of_sensitivity(result.mu, by.warmth, by.terms))
    return SettingMeasurement(condition, piece, result.mu if result.ok else float("nan"), tuple(errors))


def _shared(term: Term, by: Surroundings) -> str:
    """Return what has a term's error in common."""
    if term.acts is Acts.PIECE:
        return PIECE
    # A check of the diameter is off by itself. What the checks of a series share makes U rather too large.
    return "" if term.acts is Acts.LOSS and by.size.checked else term.common


def _part(one: Contribution, condition: int, common: str, by: Surroundings) -> ErrorPart:
    signed = one.input_u * one.sensitivity
    value = signed if isfinite(signed) else one.standard
    estimate = ""
    if one.name == REPEATABILITY:
        estimate = "pool" if one.df == float(by.pool.df) else f"condition {condition}"
    return ErrorPart(one.name, value, common, estimate, one.df)


def _of_sensitivity(mu: float, warmth: SurfaceWarmth, terms: Sequence[Term]) -> ErrorPart:
    """Return what the error of the sensitivity to temperature does; with the thermometer's bias it moves all alike."""
    return ErrorPart(TEMPERATURE_SENSITIVITY, mu * warmth.slope.u_per_kelvin * warmth.offset_k(terms), RIG)


def difference_of(first: SettingMeasurement, second: SettingMeasurement) -> Difference:
    """Return the second measurement less the first, with its standard uncertainty and degrees of freedom."""
    shared = RIG if first.piece != second.piece else (RIG, PIECE)
    mine, other = (
        {(one.cause, one.common): one for one in each.errors if one.common and one.common in shared}
        for each in (first, second)
    )
    parts = [
        (one.value, one.estimate, one.df)
        for each in (first, second)
        for one in each.errors
        if not (one.common and one.common in shared)
    ]
    for key in dict.fromkeys([*mine, *other]):
        found = [each.get(key) for each in (mine, other)]
        off = [one.value if one is not None else 0.0 for one in found]
        parts.append((off[1] - off[0], "", min(one.df for one in found if one is not None)))
    standard = sqrt(sum(value * value for value, _, _ in parts))
    return Difference(second.mu - first.mu, standard, effective_df(_by_estimate(parts), standard))


def _by_estimate(parts: Sequence[tuple[float, str, float]]) -> list[tuple[float, float]]:
    """Return standard uncertainties with their degrees of freedom, those of one estimate as one."""
    found = [(abs(value), df) for value, estimate, df in parts if not estimate]
    for name in dict.fromkeys(estimate for _, estimate, _ in parts if estimate):
        listed = [(value, df) for value, estimate, df in parts if estimate == name]
        found.append((sqrt(sum(value * value for value, _ in listed)), listed[0][1]))
    return found


@dataclass(frozen=True, slots=True)
class SettingAgreement:
    """The test of a setting: ``chi2`` of its measurements about their mean, and the ``limit`` of it at ``LEVEL``."""

    measurements: tuple[SettingMeasurement, ...]
    mean: float
    """Generalised mean of the coefficients."""
    chi2: float
    limit: float
    off: tuple[float, ...]
    """By how much each measurement differs from what all others together say it should be."""
    off_standard: tuple[float, ...]
    """Standard uncertainty of each."""

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
        """Return which measurement stands out most, from 0; None of two, where each differs from the other alike."""
        if self.df < 2:
            return None
        return max(range(len(self.off)), key=lambda i: abs(self.off[i]) / self.off_standard[i])


def agreement(measurements: Sequence[SettingMeasurement]) -> SettingAgreement | None:
    """Return whether measurements of one setting agree; None with fewer than two whose uncertainty is known."""
    import numpy as np  # only runs that measure a setting several times pay for it

    used = tuple(one for one in measurements if one.usable)
    if len(used) < 2:
        return None
    values = np.array([one.mu for one in used])
    covariance, parts = _covariance(used)
    weights = np.linalg.pinv(covariance, hermitian=True)
    ones = np.ones(len(used))
    total = float(ones @ weights @ ones)
    mean = float(ones @ weights @ values) / total
    left = weights - np.outer(weights @ ones, ones @ weights) / total
    chi2 = float(values @ left @ values)
    own = np.diag(left)
    contrasts = len(used) - 1
    df = _known_df(covariance, parts)
    limit = contrasts * f_quantile(1.0 - LEVEL, float(contrasts), min(max(df, 1.0), _MANY_DF))
    return SettingAgreement(
        used,
        mean,
        chi2,
        limit,
        tuple(float(one) for one in (left @ values) / own),
        tuple(float(one) for one in 1.0 / np.sqrt(own)),
    )


Estimated = tuple["NDArray[np.float64]", float]
"""Covariance by one estimate, and its degrees of freedom."""


def _covariance(used: Sequence[SettingMeasurement]) -> tuple[NDArray[np.float64], list[Estimated]]:
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
    for cause, common in dict.fromkeys((one.cause, one.common) for each in used for one in each.errors):
        found = [_named(each, cause, common) for each in used]
        off = np.array([one.value if one is not None else 0.0 for one in found])
        mask = np.array([[together[common](i, j) for j in range(count)] for i in range(count)])
        covariance += np.outer(off, off) * mask
        for i, one in enumerate(found):
            if one is not None and one.estimate:
                part, _ = estimated.setdefault(one.estimate, (np.zeros((count, count)), one.df))
                part[i, i] += one.value**2
    return covariance, list(estimated.values())


def _named(of: SettingMeasurement, cause: str, common: str) -> ErrorPart | None:
    return next((one for one in of.errors if (one.cause, one.common) == (cause, common)), None)


def _known_df(covariance: NDArray[np.float64], parts: Sequence[Estimated]) -> float:
    """Return the degrees of freedom that the test has of what is estimated.

    The greatest share of any contrast's variance that an estimate makes is the greatest eigenvalue of that estimate's
    covariance where all contrasts are made independent, with variance 1.
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
