"""Grosch's two rules for the maxima of friction, from the compound's moduli, and the maxima of a master curve.

  v = 6 nm x omega(maximum of the loss modulus) / 2 pi     adhesion: the molecular jump
  v = 150 um x omega(maximum of the loss factor) / 2 pi    deformation: the spacing of the abrasive's grit

Proc. Roy. Soc. A 274 (1963) 21; lengths as paper S prints them (Sharp, Gruber, Fina: circuit racing, track texture,
temperature and rubber friction), frequencies in rad/s at the temperature of the master curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, pi
from typing import Final

import numpy as np

from sim.physics.materials import OutsideError, ShearModulus
from sim.physics.wlf import PoleError
from tester.analysis.master_curve.collapse import Collapse, Curve, curve_through, padded, shifts
from tester.base.arrays import Array

JUMP_M: Final = 6e-9
GRIT_M: Final = 150e-6
DECADES: Final = (-6, 14)
"""Powers of ten of rad/s that bound the search for maxima of the moduli."""
A_DECADE: Final = 50
PROMINENT: Final = 0.02
"""A maximum of the curve counts where ln mu falls by more than this on both sides [A]."""
PLACES: Final = 1000
DRAWN: Final = 200
"""Resampled sets in which each maximum is searched again."""
FINER: Final = 4
"""Additional knots of the finer spline that shows how far smoothing moves a maximum [A]."""
SURE: Final = 0.95
"""Share of the resampled sets that must have the maximum."""
REACH_DECADES: Final = 1.0
"""Distance within which a maximum counts as the same, for a curve's only maximum [A]; for several, half their distance.
"""


@dataclass(frozen=True, slots=True)
class Peak:
    """A maximum of the master curve: its speed in m/s at the reference temperature with its 95 % interval, and mu."""

    speed_m_s: float
    mu: float
    interval_m_s: tuple[float, float] = (nan, nan)


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule's speed at the reference temperature, m/s; NaN where the known moduli have no such maximum.

    ``nearest_m_s``: the nearest maximum of the curve, ``decades``: its distance above the rule, both NaN for none.
    """

    name: str
    speed_m_s: float
    nearest_m_s: float = nan

    @property
    def decades(self) -> float:
        """Return the distance of the curve's maximum above the rule, decades."""
        return float(np.log10(self.nearest_m_s / self.speed_m_s))


def peaks_of(collapse: Collapse, reference_c: float) -> tuple[tuple[Peak, ...], int]:
    """Return the maxima of a master curve that are not due to its scatter, from slow to fast, and the number of the
    others; raises PoleError for the reference temperature.

    A maximum counts where a share ``SURE`` of the resampled sets has one as well. Its interval includes its place on a
    curve of ``FINER`` more knots: a spline that smooths detail away moves a maximum, and resampling does not show that.
    """
    back = _back(collapse.ts_c, reference_c)
    maxima = [(x - back, mu) for x, mu in _maxima(collapse.curve, collapse.x)]
    if not maxima or collapse.drawn is None:
        return tuple(Peak(float(10.0**x), mu) for x, mu in maxima), 0
    places = [x for x, _ in maxima]
    again = [_maxima_again(collapse, i, reference_c) for i in range(min(DRAWN, collapse.drawn.ts_c.size))]
    finer, _ = curve_through(
        collapse.of,
        collapse.x,
        min(collapse.interior + FINER, collapse.x.size // 3),
        padded(collapse.of, collapse.of.log_mu),
    )
    places_finer = [at - back for at, _ in _maxima(finer, collapse.x)]
    peaks: list[Peak] = []
    for x, mu in maxima:
        reach = min([0.5 * abs(x - other) for other in places if other != x], default=REACH_DECADES)
        near = [min(maxima_again, key=lambda at, x=x: abs(at - x)) for maxima_again in again if maxima_again]
        same = [at for at in near if abs(at - x) <= reach]
        if len(same) >= SURE * len(again):
            moved = min((at - x for at in places_finer if abs(at - x) <= reach), key=abs, default=0.0)
            low, high = np.quantile(same, [0.025, 0.975]) + np.array([min(moved, 0.0), max(moved, 0.0)])
            peaks.append(Peak(float(10.0**x), mu, (float(10.0**low), float(10.0**high))))
    return tuple(peaks), len(maxima) - len(peaks)


def _maxima_again(collapse: Collapse, i: int, reference_c: float) -> list[float]:
    """Return x, at the reference temperature, of each maximum of the curve fitted to resampled set ``i``."""
    assert collapse.drawn is not None
    ts_c = float(collapse.drawn.ts_c[i])
    x = collapse.of.log_v + shifts(collapse.of.celsius, ts_c)
    curve, _ = curve_through(collapse.of, x, collapse.interior, collapse.drawn.y[:, i])
    back = _back(ts_c, reference_c - float(collapse.drawn.thermometer_k[i]))
    return [at - back for at, _ in _maxima(curve, x)]


def _back(ts_c: float, reference_c: float) -> float:
    return float(shifts(np.array([reference_c]), ts_c)[0])


def _maxima(curve: Curve, over: Array) -> list[tuple[float, float]]:
    """Return x and mu of the ``PROMINENT`` maxima of a curve within a range."""
    x = np.linspace(float(np.min(over)), float(np.max(over)), PLACES)
    y = curve.at(x)
    return [
        (float(x[i]), float(np.exp(y[i])))
        for i in np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
        if min(_falls(y[i::-1]), _falls(y[i:])) > PROMINENT
    ]


def _falls(y: Array) -> float:
    """Return how far values fall from the first before they rise above it."""
    above = np.flatnonzero(y > y[0])
    return float(y[0] - np.min(y[: above[0]] if above.size else y))


def rules_of(modulus: ShearModulus, reference_c: float, peaks: tuple[Peak, ...]) -> tuple[Rule, ...]:
    """Return Grosch's two rules for a compound, compared with the maxima of a curve."""
    omega, storage, loss = _known(modulus, reference_c)
    named = (
        ("6 nm x omega of the loss modulus' maximum / 2 pi", JUMP_M, loss),
        ("150 um x omega of the loss factor's maximum / 2 pi", GRIT_M, loss / storage if loss.size else loss),
    )
    return tuple(_rule(name, length * _maximum(omega, values) / (2.0 * pi), peaks) for name, length, values in named)


def _rule(name: str, speed_m_s: float, peaks: tuple[Peak, ...]) -> Rule:
    if not (peaks and speed_m_s > 0.0):
        return Rule(name, speed_m_s)
    nearest = min(peaks, key=lambda peak: abs(np.log10(peak.speed_m_s / speed_m_s)))
    return Rule(name, speed_m_s, nearest.speed_m_s)


def _known(modulus: ShearModulus, celsius: float) -> tuple[Array, Array, Array]:
    """Return frequencies at which a modulus is known at a temperature, with G' and G''."""
    rows: list[tuple[float, float, float]] = []
    for omega in np.logspace(*DECADES, (DECADES[1] - DECADES[0]) * A_DECADE + 1):
        try:
            value = complex(modulus.complex_pa(np.array([omega]), celsius)[0])
        except (OutsideError, PoleError):
            continue
        if value.real > 0.0 and value.imag > 0.0:
            rows.append((float(omega), value.real, value.imag))
    table = np.array(rows).reshape(-1, 3)
    return table[:, 0], table[:, 1], table[:, 2]


def _maximum(omega: Array, values: Array) -> float:
    """Return the place of the maximum, by a parabola over log omega; NaN where that is an end of the known range."""
    if values.size < 3:
        return nan
    i = int(np.argmax(values))
    if i in (0, values.size - 1):
        return nan
    y, x = np.log(values[i - 1 : i + 2]), np.log(omega[i - 1 : i + 2])
    bend = float(y[0] - 2.0 * y[1] + y[2])
    share = 0.5 * float(y[0] - y[2]) / bend if bend < 0.0 else 0.0
    return float(np.exp(x[1] + share * (x[2] - x[1])))
