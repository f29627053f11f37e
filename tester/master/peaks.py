"""Grosch's two rules for where friction has its maxima, from the compound's moduli, and the maxima of a master curve.

    v = 6 nm x omega(maximum of the loss modulus) / 2 pi     adhesion: the molecular jump
    v = 150 um x omega(maximum of the loss factor) / 2 pi    deformation: the spacing of the abrasive's grit

Proc. Roy. Soc. A 274 (1963) 21; lengths as paper S prints them (Sharp, Gruber, Fina: circuit racing, track texture,
temperature and rubber friction), frequencies in rad/s at the temperature of the master curve.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import nan, pi
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics.materials import OutsideError, ShearModulus
from sim.physics.wlf import PoleError
from tester.master.collapse import Collapse, shifts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

JUMP_M: Final = 6e-9
GRIT_M: Final = 150e-6
DECADES: Final = (-6, 14)
"""Powers of ten of rad/s between which maxima of the moduli are looked for."""
A_DECADE: Final = 50
PROMINENT: Final = 0.02
"""A maximum of the curve counts where ln mu falls by more than this on both sides [A]."""


@dataclass(frozen=True, slots=True)
class Peak:
    """A maximum of the master curve: its speed in m/s at the reference temperature, and mu."""

    speed_m_s: float
    mu: float


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule's speed at the reference temperature, m/s; NaN where the moduli have no such maximum that is known.

    ``nearest``: the maximum of the curve that is nearest, ``decades``: how far it is above the rule, both NaN for none.
    """

    name: str
    speed_m_s: float
    nearest_m_s: float = nan

    @property
    def decades(self) -> float:
        """Return by how many decades the curve's maximum stands above the rule."""
        return float(np.log10(self.nearest_m_s / self.speed_m_s))


def peaks_of(one: Collapse, reference_c: float) -> tuple[Peak, ...]:
    """Return the maxima within a master curve, from slow to fast; raises PoleError for the reference temperature."""
    x = np.linspace(float(np.min(one.x)), float(np.max(one.x)), 2000)
    y = one.curve.at(x)
    back = float(shifts(np.array([reference_c]), one.ts_c)[0])
    found: list[Peak] = []
    for i in np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1:
        if min(_falls(y[i::-1]), _falls(y[i:])) > PROMINENT:
            found.append(Peak(float(10.0 ** (x[i] - back)), float(np.exp(y[i]))))
    return tuple(found)


def _falls(y: Array) -> float:
    """Return how far values fall from their first one before they rise above it."""
    above = np.flatnonzero(y > y[0])
    return float(y[0] - np.min(y[: above[0]] if above.size else y))


def rules_of(modulus: ShearModulus, reference_c: float, peaks: tuple[Peak, ...]) -> tuple[Rule, ...]:
    """Return Grosch's two rules for a compound, held against the maxima of a curve."""
    omega, storage, loss = _known(modulus, reference_c)
    found = (
        ("6 nm x omega of the loss modulus' maximum / 2 pi", JUMP_M, loss),
        ("150 um x omega of the loss factor's maximum / 2 pi", GRIT_M, loss / storage if loss.size else loss),
    )
    return tuple(_rule(name, length * _maximum(omega, values) / (2.0 * pi), peaks) for name, length, values in found)


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
    """Return where values are greatest, by a parabola over log omega; NaN where that is an end of what is known."""
    if values.size < 3:
        return nan
    i = int(np.argmax(values))
    if i in (0, values.size - 1):
        return nan
    y, x = np.log(values[i - 1 : i + 2]), np.log(omega[i - 1 : i + 2])
    bend = float(y[0] - 2.0 * y[1] + y[2])
    share = 0.5 * float(y[0] - y[2]) / bend if bend < 0.0 else 0.0
    return float(np.exp(x[1] + share * (x[2] - x[1])))
