"""Grosch's two rules for the maxima of friction, from the compound's moduli, and whether measured maxima obey them.

  v = 6 nm x omega(maximum of the loss modulus) / 2 pi     adhesion: the molecular jump
  v = 150 um x omega(maximum of the loss factor) / 2 pi    deformation: the spacing of the abrasive's grit

Proc. Roy. Soc. A 274 (1963) 21; lengths as paper S prints them (Sharp, Gruber, Fina: circuit racing, track texture,
temperature and rubber friction, section 4), frequencies in rad/s at the temperature of the master curve.

Of two maxima the slower one is that of adhesion, as Grosch has it. A curve's only maximum is that of adhesion on a
smooth track, of deformation on a powdered one, and of neither elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite, log10, nan
from typing import Final

from sim.physics.loss_maxima import loss_maxima
from sim.physics.materials import ShearModulus
from tester.analysis.master_curve.peaks import Peak

JUMP_M: Final = 6e-9
GRIT_M: Final = 150e-6
WITHIN_DECADES: Final = 0.3
"""Distance of a maximum from a rule's speed up to which the rule holds, decades [A]: a factor of 2, for the rules state
their lengths with one or two digits."""


class Mechanism(StrEnum):
    """What makes a maximum of friction."""

    ADHESION = "adhesion"
    DEFORMATION = "deformation"


class RuleVerdict(StrEnum):
    """Whether a measured maximum obeys a rule."""

    HOLDS = "holds"
    DOES_NOT = "does not hold"
    OPEN = "cannot tell"


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule's speed at the reference temperature, m/s; NaN where the known moduli have no such maximum.

    ``peak``: the maximum it is compared with, None for none; ``assigned``: whether that maximum is known to be of the
    rule's mechanism, else it is the nearest one.
    """

    name: str
    mechanism: Mechanism
    speed_m_s: float
    peak: Peak | None = None
    assigned: bool = False

    @property
    def decades(self) -> float:
        """Return the distance of the curve's maximum above the rule, decades; NaN for none."""
        return log10(self.peak.speed_m_s / self.speed_m_s) if self.peak is not None else nan

    @property
    def interval(self) -> tuple[float, float]:
        """Return the 95 % interval of ``decades``, both ends NaN if unknown."""
        if self.peak is None:
            return nan, nan
        low, high = (log10(end / self.speed_m_s) for end in self.peak.interval_m_s)
        return low, high

    @property
    def verdict(self) -> RuleVerdict:
        """Return whether the whole interval is within ``WITHIN_DECADES`` of the rule, or all of it is outside."""
        low, high = self.interval
        if not self.assigned or not (isfinite(low) and isfinite(high)):
            return RuleVerdict.OPEN
        if low >= -WITHIN_DECADES and high <= WITHIN_DECADES:
            return RuleVerdict.HOLDS
        return RuleVerdict.DOES_NOT if low > WITHIN_DECADES or high < -WITHIN_DECADES else RuleVerdict.OPEN


def rules_of(
    modulus: ShearModulus, reference_c: float, peaks: Sequence[Peak], only: Mechanism | None = None
) -> tuple[Rule, Rule]:
    """Return both rules for a compound, compared with the maxima of a curve, from slow to fast.

    ``only``: the mechanism of a curve's only maximum, None if unknown.
    """
    of_modulus_hz, of_factor_hz = loss_maxima(modulus, reference_c)
    own = _assigned(peaks, only)
    adhesion = "6 nm x omega of the loss modulus' maximum / 2 pi"
    deformation = "150 um x omega of the loss factor's maximum / 2 pi"
    return (
        _rule(adhesion, Mechanism.ADHESION, JUMP_M * of_modulus_hz, peaks, own),
        _rule(deformation, Mechanism.DEFORMATION, GRIT_M * of_factor_hz, peaks, own),
    )


def _assigned(peaks: Sequence[Peak], only: Mechanism | None) -> dict[Mechanism, Peak] | None:
    """Return the maximum of each mechanism; None if that is unknown."""
    if len(peaks) == 2:
        return {Mechanism.ADHESION: peaks[0], Mechanism.DEFORMATION: peaks[1]}
    return {only: peaks[0]} if len(peaks) == 1 and only is not None else None


def _rule(
    name: str, mechanism: Mechanism, speed_m_s: float, peaks: Sequence[Peak], own: dict[Mechanism, Peak] | None
) -> Rule:
    if not (peaks and speed_m_s > 0.0):
        return Rule(name, mechanism, speed_m_s)
    if own is not None:
        return Rule(name, mechanism, speed_m_s, own.get(mechanism), mechanism in own)
    return Rule(name, mechanism, speed_m_s, min(peaks, key=lambda peak: abs(log10(peak.speed_m_s / speed_m_s))))
