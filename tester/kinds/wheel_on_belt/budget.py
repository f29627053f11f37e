"""What this machine's measuring chain may be off by."""

from __future__ import annotations

from typing import Final

from tester.analysis.kelvin import Slope
from tester.analysis.measurand import expected_budget
from tester.analysis.terms import Acts, BudgetPoint, Size, Term
from tester.analysis.uncertainty import Budget
from tester.kinds.wheel_on_belt.image.axes import Held
from tester.store import older

TERMS: Final[tuple[Term, ...]] = older.TERMS
"""Those of the records that do not say theirs, as long as nothing about the machine is known better."""



def terms_of(cell_sensitivity: float, record: str) -> tuple[Term, ...]:
    """Return the terms of a rig; one whose cell was calibrated with weights has what was found in them.

    ``cell_sensitivity``: of Fx over Fz, with its standard uncertainty (``commission.weights``), 0: not stated.
    """
    if not cell_sensitivity > 0.0:
        return TERMS
    source = f"hung weights, record {record[:12]}" if record else "hung weights"
    sensitivity = Term(
        "cell sensitivity", Acts.COEFFICIENT, cell_sensitivity, "1", "normal", source, setting="cell_sensitivity"
    )
    return (*TERMS, sensitivity)


BETWEEN_PERCENT: Final = 100.0 * sum(one.standard for one in TERMS if one.acts is Acts.PIECE)
"""Standard deviation from wheel to wheel of one compound, as stated."""

def instruments_budget(
    held: Held, mu: float, sliding_m_s: float, size: Size, slope: Slope, *, both_directions: bool = False
) -> Budget:
    """Return what the measuring chain adds to the uncertainty of a coefficient that is expected.

    ``size``: of the wheel, as it is expected by then; ``slope``: what is known of the sensitivity to temperature.
    """
    means = {"wheel_speed_m_s": held.wheel_speed_m_s, "belt_speed_m_s": held.belt_speed_m_s}
    turning = {"wheel_speed_m_s": 0.0, "belt_speed_m_s": -held.slip_velocity_m_s} if both_directions else None
    at = BudgetPoint(mu, held.load_n, sliding_m_s, means, slope.per_kelvin, size=size, turning=turning)
    return expected_budget(TERMS, at, slope)
