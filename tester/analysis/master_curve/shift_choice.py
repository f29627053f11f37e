"""Which shift the conditions prefer: that of Williams, Landel and Ferry, or an activated process (Arrhenius).

    log10 aT = Ea / (R ln 10) (1 / T - 1 / T_mean),  T in K

Both have one parameter, Ts or Ea. Each is fitted with the number of knots that suits it best; Akaike's criterion
(corrected for few data) then compares their likelihoods.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import Final

import numpy as np

from sim.physics.simple import GAS_J_MOL_K, KELVIN
from tester.analysis.master_curve.collapse import Collapse, criterion, golden, left_of, numbers_of_knots, padded
from tester.base.arrays import Array

DECIDES: Final = 3.0
"""Difference of ln likelihood above which one shift is likelier [A]: 20 times as likely."""
LOWEST_J_MOL, HIGHEST_J_MOL, STEP_J_MOL = 20e3, 500e3, 20e3
"""Range and grid of the search for Ea [A]: rubbers have 30 to 300 kJ/mol, more near their glass transition."""


@dataclass(frozen=True, slots=True)
class ShiftChoice:
    """The best activation energy, J/mol, and ln of the likelihood of WLF over that of Arrhenius."""

    activation_j_mol: float
    wlf_over_arrhenius: float

    @property
    def likelier(self) -> str:
        """Return the likelier shift: WLF, Arrhenius, or "" if the conditions do not decide."""
        if abs(self.wlf_over_arrhenius) <= DECIDES:
            return ""
        return "WLF" if self.wlf_over_arrhenius > 0.0 else "Arrhenius"


def arrhenius_shifts(celsius: Array, activation_j_mol: float) -> Array:
    """Return log10 aT of temperatures in degC, shape (n,); 0 at their mean."""
    kelvin = celsius + KELVIN
    mean = 1.0 / float(np.mean(kelvin))
    return np.asarray(activation_j_mol / (GAS_J_MOL_K * log(10.0)) * (1.0 / kelvin - mean))


def choice_of(wlf: Collapse) -> ShiftChoice:
    """Return the choice for a set whose Ts was searched."""
    of, y = wlf.of, padded(wlf.of, wlf.of.log_mu)
    n = of.log_v.size

    def left(activation_j_mol: float, interior: int) -> float:
        return left_of(of, of.log_v + arrhenius_shifts(of.celsius, activation_j_mol), interior, y)

    trials = np.arange(LOWEST_J_MOL, HIGHEST_J_MOL + STEP_J_MOL, STEP_J_MOL)
    _, interior, near = min(
        (criterion(at_least, n, k), k, float(at))
        for k in numbers_of_knots(n)
        for at_least, at in [min((left(float(trial), k), trial) for trial in trials)]
    )
    best = golden(lambda at: left(at, interior), max(near - STEP_J_MOL, 1.0), near + STEP_J_MOL, 10.0)
    at_wlf = criterion(left_of(of, wlf.x, wlf.interior, y), n, wlf.interior)
    return ShiftChoice(best, 0.5 * (criterion(left(best, interior), n, interior) - at_wlf))
