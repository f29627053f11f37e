"""Adhesion and hysteresis of a specimen from its coefficients dry and with a film between the surfaces.

A film of water or powder is assumed to remove all adhesion and change nothing else. At one speed, load and temperature

  hysteresis = mu_film,  adhesion = mu_dry - mu_film,  share = mu_film / mu_dry  (of hysteresis).

Both coefficients are of one specimen on one rig. Common errors (terms of the budget that belong to the rig or the
piece, ``Contribution.common``) move both the same way, so only the combined effect on a component counts; independent
errors add in squares. The contact is warmer dry than with a film. mu_film is corrected to the temperature of the dry
contact with the sensitivity c = d ln mu / dT, mu_film exp(c (T_dry - T_film)). The uncertainty of c acts over that
difference, whose own uncertainty is at least ``RUBBER_K``. The expanded uncertainty covers 95 %, with Welch and
Satterthwaite's degrees of freedom.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import exp, hypot, inf, isfinite, sqrt
from typing import Final

from tester.analysis.kelvin import Slope
from tester.analysis.quantiles import t_quantile
from tester.analysis.repeats import ConditionResult
from tester.analysis.results import NAN
from tester.analysis.uncertainty import CONFIDENCE, effective_df

SENSITIVITY: Final = "sensitivity to temperature"
"""Name of the contribution of the difference between the contact's temperatures."""
RUBBER_K: Final = 1.0
"""Standard uncertainty of the difference between the rubber's temperatures, K, beyond the thermometer's [A]: the
thermometer sees the track as it leaves the contact, and the rubber is still warm from earlier conditions."""


@dataclass(frozen=True, slots=True)
class PartValue:
    """A value with its uncertainty.

    ``own``: standard uncertainty and degrees of freedom of each error that no other value shares. ``common``: by cause,
    the signed error of the value when the cause is off by its standard uncertainty, and the degrees of freedom.
    """

    value: float
    own: tuple[tuple[float, float], ...] = ()
    common: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])

    @property
    def _parts(self) -> list[tuple[float, float]]:
        return [*self.own, *((abs(u), df) for u, df in self.common.values())]

    @property
    def standard(self) -> float:
        """Return the standard uncertainty; NaN where a part is unknown."""
        return sqrt(sum(u * u for u, _ in self._parts))

    @property
    def expanded(self) -> float:
        """Return the expanded uncertainty, 95 %; NaN where a part is unknown."""
        standard = self.standard
        if not isfinite(standard):
            return NAN
        return t_quantile(0.5 + 0.5 * CONFIDENCE, effective_df(self._parts, standard)) * standard


@dataclass(frozen=True, slots=True)
class ByFilm:
    """Components of one condition; ``warmer_k``: temperature of the dry contact less that with the film."""

    adhesion: PartValue
    hysteresis: PartValue
    share: PartValue
    """Of hysteresis, in the dry coefficient."""
    warmer_k: float


def by_film(dry: ConditionResult, film: ConditionResult, slope: Slope) -> ByFilm:
    """Return the components of a condition from its results on one specimen; ``slope``: of mu_film with temperature.

    Uncertainties are NaN where a result has no budget, or no repeats to derive its repeatability from.
    """
    warmer_k = dry.measured.temperature - film.measured.temperature
    apart_k = warmer_k if isfinite(warmer_k) else 0.0
    factor = exp(slope.per_kelvin * apart_k)
    mu_d, mu_f = dry.mu_resultant, film.mu_resultant * factor
    unknown = mu_f * hypot(apart_k, RUBBER_K) * slope.u_per_kelvin
    both = (dry.budget.contributions, film.budget.contributions)

    def combined(value: float, to_dry: float, to_film: float) -> PartValue:
        """Return a component from its derivatives with respect to both coefficients."""
        scales = (to_dry, to_film * factor)
        scaled = [(term, scale) for contributions, scale in zip(both, scales, strict=True) for term in contributions]
        independent = [(abs(scale) * term.standard, term.df) for term, scale in scaled if not term.common]
        common: dict[str, tuple[float, float]] = {SENSITIVITY: (to_film * unknown, inf)}
        for term, scale in scaled:
            if term.common:
                so_far, df = common.get(term.name, (0.0, inf))
                common[term.name] = so_far + scale * term.error, min(df, term.df)
        if not all(both):
            independent.append((NAN, inf))
        return PartValue(value, tuple(independent), common)

    return ByFilm(
        adhesion=combined(mu_d - mu_f, 1.0, -1.0),
        hysteresis=combined(mu_f, 0.0, 1.0),
        share=combined(mu_f / mu_d, -mu_f / mu_d**2, 1.0 / mu_d),
        warmer_k=warmer_k,
    )


def mean_of(values: Sequence[PartValue]) -> PartValue:
    """Return the mean of values of one rig and compound; NaN where none has an uncertainty above 0.

    Weighted by 1 / (u^2 + d^2), d the standard deviation by which conditions truly differ, where they scatter by more
    than their uncertainties (DerSimonian and Laird, Controlled Clinical Trials 7, 1986, 177). The measurand is the
    plain mean of these conditions: as far as the weights differ from equal ones, d counts among the uncertainties.
    Common errors do not average out.
    """
    certain = [value_of_rig for value_of_rig in values if isfinite(value_of_rig.value) and value_of_rig.standard > 0.0]
    if not certain:
        return PartValue(NAN, ((NAN, inf),))
    apart = between(certain)
    weights = [1.0 / (value_of_rig.standard**2 + apart**2) for value_of_rig in certain]
    shares = [weight / sum(weights) for weight in weights]
    common: dict[str, tuple[float, float]] = {}
    for value_of_rig, share in zip(certain, shares, strict=True):
        for name, (u, df) in value_of_rig.common.items():
            so_far, least = common.get(name, (0.0, inf))
            common[name] = so_far + share * u, min(least, df)
    value = sum(share * value_of_rig.value for value_of_rig, share in zip(certain, shares, strict=True))
    independent = [
        (share * u, df) for value_of_rig, share in zip(certain, shares, strict=True) for u, df in value_of_rig.own
    ]
    if apart > 0.0:
        unequal = sqrt(sum((share - 1.0 / len(shares)) ** 2 for share in shares))
        independent.append((apart * unequal, len(certain) - 1.0))
    return PartValue(value, tuple(independent), common)


def between(values: Sequence[PartValue]) -> float:
    """Return the standard deviation between the true values, 0 where their uncertainties explain their scatter.

    ``values``: at least one, each with an uncertainty above 0.
    """
    weights = [1.0 / one.standard**2 for one in values]
    total = sum(weights)
    mean = sum(weight * one.value for weight, one in zip(weights, values, strict=True)) / total
    scatter = sum(weight * (one.value - mean) ** 2 for weight, one in zip(weights, values, strict=True))
    freedom = total - sum(weight**2 for weight in weights) / total
    return sqrt(max(0.0, scatter - (len(values) - 1)) / freedom) if len(values) > 1 else 0.0
