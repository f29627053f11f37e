"""The possible errors of this machine's measuring chain, and the budget of an expected coefficient."""

from __future__ import annotations

from typing import Final

from tester.analysis.kelvin import Slope
from tester.analysis.measurand import expected_budget
from tester.analysis.terms import Acts, BudgetPoint, Term
from tester.analysis.uncertainty import Budget

TERMS: Final[tuple[Term, ...]] = (
    Term("cell linearity", Acts.FRICTION, 0.2, "N", "rectangular", "0.1 % of 200 N, below 20 N 1 % of the force [A]",
         setting="cell_linearity_n", whole_at=20.0),
    Term("cell zero", Acts.FRICTION, 0.05, "N", "rectangular", "0.01 N/K, 5 K since the tare [A]", common="",
         setting="cell_zero_n"),
    Term("weights", Acts.NORMAL, 0.001, "N", "rectangular", "0.1 % of the weights, class M2 and the arm [A]",
         channel="load_n", setting="weights_share"),
    Term("axis misalignment", Acts.ROTATION, 0.2, "deg", "U-shaped", "track and cell, of unknown sign [A]",
         setting="misalignment_deg"),
    Term("thermometer", Acts.TEMPERATURE, 1.0, "K", "rectangular", "Pt100 class B and the air's layers [A]",
         setting="temperature_k"),
    Term("track speed", Acts.SLIDING, 0.001, "m/s", "rectangular", "0.1 % of the speed [A]", channel="sliding_m_s",
         setting="speed_share"),
    Term("specimen to specimen", Acts.PIECE, 0.03, "1", "normal", "stated 3 % [A]", common="",
         setting="specimen_to_specimen"),
)  # fmt: skip
"""Limits are engineering assumptions; a recipe's metadata replaces them as ``uncertainty.<setting>``.

The cell is tared before each repeat, so its curve goes through zero. A quadratic or cubic curve that is 0 at both ends
of the range and within 0.1 % of it is within 1 % of a force below a tenth of the range (1.04 % near zero)."""


def instruments_budget(mu: float, load_n: float, track_m_s: float, slope: Slope) -> Budget:
    """Return the measuring chain's part of the uncertainty of an expected coefficient.

    ``slope``: the known sensitivity to temperature.
    """
    means = {"load_n": load_n, "sliding_m_s": track_m_s}
    return expected_budget(TERMS, BudgetPoint(mu, load_n, track_m_s, means, slope.per_kelvin), slope)
