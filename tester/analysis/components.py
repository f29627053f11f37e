"""Adhesion and hysteresis of a specimen from its coefficients dry and with the contact kept apart by a film.

With a film, of water or of powder, that takes all adhesion away, leaves all hysteresis and does nothing else, at one
speed, load and temperature

    hysteresis = mu_film,  adhesion = mu_dry - mu_film,  share = mu_film / mu_dry  (of hysteresis).

Both coefficients are of one specimen on one rig. What they have in common (the terms of the budget that are the
rig's or the piece's, ``Contribution.common``) moves both the same way, and only what it moves a component by is left;
what is each one's own adds in squares. The contact is warmer dry than with a film. mu_film is taken to the temperature
of the dry contact with the sensitivity c = d ln mu / dT that is known of it, mu_film exp(c (T_dry - T_film)). What is
not known of c adds its uncertainty times that difference, which is itself not known better than ``RUBBER_K``. The
expanded uncertainty is of 95 %, with Welch and Satterthwaite's degrees of freedom.
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
from tester.analysis.uncertainty import CONFIDENCE, Contribution, effective_df

SENSITIVITY: Final = "sensitivity to temperature"
"""Name of what the difference of the contact's temperatures contributes."""
RUBBER_K: Final = 1.0
"""Standard uncertainty of the difference between the rubber's temperatures, K, beside what the thermometer shows of it
[A]: that sees the track where it leaves the contact, and the rubber is warm from what was measured before."""


@dataclass(frozen=True, slots=True)
class PartValue:
    """A value and what makes it uncertain.

    ``own``: standard uncertainties and degrees of freedom of what is nothing else's. ``common``: by how much, with its
    sign, it is off where a cause that others have too is off by its standard uncertainty; and the degrees of freedom.
    """

    value: float
    own: tuple[tuple[float, float], ...] = ()
    common: Mapping[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])

    @property
    def _parts(self) -> list[tuple[float, float]]:
        return [*self.own, *((abs(u), df) for u, df in self.common.values())]

    @property
    def standard(self) -> float:
        """Return the standard uncertainty; NaN where a part is not known."""
        return sqrt(sum(u * u for u, _ in self._parts))

    @property
    def expanded(self) -> float:
        """Return the expanded uncertainty, 95 %; NaN where a part is not known."""
        standard = self.standard
        if not isfinite(standard):
            return NAN
        return t_quantile(0.5 + 0.5 * CONFIDENCE, effective_df(self._parts, standard)) * standard


@dataclass(frozen=True, slots=True)
class ByFilm:
    """Components of one condition; ``warmer_k``: by how much the dry contact was warmer than that with the film."""

    adhesion: PartValue
    hysteresis: PartValue
    share: PartValue
    """Of hysteresis, in the dry coefficient."""
    warmer_k: float


def by_film(dry: ConditionResult, film: ConditionResult, slope: Slope) -> ByFilm:
    """Return the components of a condition from its results on one specimen; ``slope``: of the film's coefficient.

    Uncertainties are NaN where a result has no budget, or no repeats to tell its repeatability.
    """
    warmer_k = dry.measured.temperature - film.measured.temperature
    apart_k = warmer_k if isfinite(warmer_k) else 0.0
    factor = exp(slope.per_kelvin * apart_k)
    mu_d, mu_f = dry.mu_resultant, film.mu_resultant * factor
    unknown = mu_f * hypot(apart_k, RUBBER_K) * slope.u_per_kelvin
    both = (dry.budget.contributions, film.budget.contributions)

    def combined(value: float, to_dry: float, to_film: float) -> PartValue:
        """Return a component by its derivatives to both coefficients."""
        scales = (to_dry, to_film * factor)
        known = [(one, scale) for found, scale in zip(both, scales, strict=True) for one in found]
        own = [(abs(scale) * one.standard, one.df) for one, scale in known if not one.common]
        common: dict[str, tuple[float, float]] = {SENSITIVITY: (to_film * unknown, inf)}
        for one, scale in known:
            if one.common:
                so_far, df = common.get(one.name, (0.0, inf))
                common[one.name] = so_far + scale * _error(one), min(df, one.df)
        if not all(both):
            own.append((NAN, inf))
        return PartValue(value, tuple(own), common)

    return ByFilm(
        adhesion=combined(mu_d - mu_f, 1.0, -1.0),
        hysteresis=combined(mu_f, 0.0, 1.0),
        share=combined(mu_f / mu_d, -mu_f / mu_d**2, 1.0 / mu_d),
        warmer_k=warmer_k,
    )


def _error(one: Contribution) -> float:
    """Return by how much mu is off, with its sign, where the cause is off by its standard uncertainty."""
    return one.input_u * one.sensitivity


def mean_of(values: Sequence[PartValue]) -> PartValue:
    """Return the mean of values of one rig and compound, weighted by 1 / u^2; NaN where none is certain to some degree.

    What they have in common does not average out.
    """
    kept = [one for one in values if isfinite(one.value) and one.standard > 0.0]
    if not kept:
        return PartValue(NAN, ((NAN, inf),))
    weights = [1.0 / one.standard**2 for one in kept]
    shares = [weight / sum(weights) for weight in weights]
    common: dict[str, tuple[float, float]] = {}
    for one, share in zip(kept, shares, strict=True):
        for name, (u, df) in one.common.items():
            so_far, least = common.get(name, (0.0, inf))
            common[name] = so_far + share * u, min(least, df)
    value = sum(share * one.value for one, share in zip(kept, shares, strict=True))
    own = tuple((share * u, df) for one, share in zip(kept, shares, strict=True) for u, df in one.own)
    return PartValue(value, own, common)
