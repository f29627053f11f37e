"""Possible errors of this machine's measuring chain."""

from __future__ import annotations

from math import hypot
from typing import Final

from tester.analysis.kelvin import Slope
from tester.analysis.measurand import expected_budget
from tester.analysis.terms import Acts, BudgetPoint, Size, Term
from tester.analysis.uncertainty import Budget
from tester.kinds.wheel_on_belt.image.axes import HeldSetpoint
from tester.kinds.wheel_on_belt.interlocks.contact_force import depth_mm
from tester.kinds.wheel_on_belt.rig import RigConfig

_WEAR = "believed wear rate 0.08 mm3/(N m) of a range of 0.02 to 0.3 [A]"

TERMS: Final[tuple[Term, ...]] = (
    Term("cell linearity, friction", Acts.FRICTION, 1.0, "N", "rectangular", "0.1 % of 1000 N [A]",
         setting="cell_linearity_friction_n"),
    Term("cell linearity, load", Acts.NORMAL, 0.6, "N", "rectangular", "0.1 % of 600 N [A]",
         setting="cell_linearity_load_n"),
    Term("load held", Acts.NORMAL, 0.6, "N", "rectangular", "the cell's linearity, by which the load is held [A]",
         factor=0.35, setting="cell_linearity_load_n", factor_setting="mu_load_exponent"),
    Term("cell crosstalk", Acts.CROSSTALK, 0.005, "1", "rectangular", "0.5 % of the other channel [A]",
         setting="cell_crosstalk"),
    Term("cell zero, friction", Acts.FRICTION, 0.5, "N", "rectangular", "0.1 N/K, 5 K since the tare [A]",
         common="", setting="cell_zero_n"),
    Term("cell zero, load", Acts.NORMAL, 0.5, "N", "rectangular", "0.1 N/K, 5 K since the tare [A]", common="",
         setting="cell_zero_n"),
    Term("axis misalignment", Acts.ROTATION, 0.5, "deg", "U-shaped", "0.2 to 0.5 deg of unknown sign [A]",
         setting="misalignment_deg"),
    Term("thermometer", Acts.TEMPERATURE, 1.0, "K", "rectangular", "bias of a session [A]", setting="temperature_k"),
    Term("thermometer lag", Acts.LAG, 0.15, "s", "rectangular", "as long as the lag that is corrected, 0.15 s [A]",
         factor=0.15, setting="thermometer_lag_s"),
    Term("wheel speed", Acts.SLIDING, 0.001, "m/s", "rectangular", "0.1 % of the speed [A]", channel="wheel_speed_m_s",
         factor=0.8, setting="speed_share", factor_setting="mu_slip_exponent"),
    Term("belt speed", Acts.SLIDING, 0.001, "m/s", "rectangular", "0.1 % of the speed [A]", channel="belt_speed_m_s",
         factor=0.8, setting="speed_share", factor_setting="mu_slip_exponent"),
    Term("diameter as installed", Acts.SIZE, 0.15, "mm", "rectangular", "measured by a person [A]",
         channel="wheel_speed_m_s", factor=0.8, common="piece", setting="diameter_mm",
         factor_setting="mu_slip_exponent"),
    Term("diameter worn off", Acts.LOSS, 1.0, "mm", "normal", _WEAR, channel="wheel_speed_m_s", factor=0.8,
         common="piece", setting="wear_share", factor_setting="mu_slip_exponent"),
    Term("wheel to wheel", Acts.PIECE, 0.03, "1", "normal", "stated 3 % [A]", common="", setting="wheel_to_wheel"),
)  # fmt: skip
"""Limits are engineering assumptions; a recipe's metadata replaces them as ``uncertainty.<setting>``. Exponents of load
and speed are those of the model of doi 10.3390/polym16050596 near 200 N and 300 mm/s, rounded up over its three
compounds."""


def terms_of(cell_sensitivity: float, record: str) -> tuple[Term, ...]:
    """Return the terms of a rig, including any calibration of its load cell with weights.

    ``cell_sensitivity``: error of Fx over Fz, with its standard uncertainty (``commission.weights``); 0: not stated.
    """
    if not cell_sensitivity > 0.0:
        return TERMS
    source = f"hung weights, record {record[:12]}" if record else "hung weights"
    sensitivity = Term(
        "cell sensitivity", Acts.COEFFICIENT, cell_sensitivity, "1", "normal", source, setting="cell_sensitivity"
    )
    return (*TERMS, sensitivity)


BETWEEN_PERCENT: Final = 100.0 * sum(term.standard for term in TERMS if term.acts is Acts.PIECE)
"""Standard deviation from wheel to wheel of one compound, as stated."""

def instruments_budget(
    held: HeldSetpoint, mu: float, sliding_m_s: float, size: Size, slope: Slope, *, both_directions: bool = False
) -> Budget:
    """Return the measuring chain's part of the uncertainty of an expected coefficient.

    ``size``: the wheel's expected size at that time; ``slope``: the known sensitivity to temperature.
    """
    means = {"wheel_speed_m_s": held.wheel_speed_m_s, "belt_speed_m_s": held.belt_speed_m_s}
    turning = {"wheel_speed_m_s": 0.0, "belt_speed_m_s": -held.slip_velocity_m_s} if both_directions else None
    at = BudgetPoint(mu, held.load_n, sliding_m_s, means, slope.per_kelvin, size=size, turning=turning)
    return expected_budget(TERMS, at, slope)


ROLL_CHECK_N: Final = 50.0
"""Load of the automatic diameter check, N [A]: small indentation, but more than the press's friction."""
TOUCHES_U_MM: Final = 0.15
"""Expected standard uncertainty of a worn diameter by the wheel's touches, mm [A] (procedures.wear_estimate)."""
ROLL_CHECK_TURNS: Final = 6.0
"""Whole turns averaged by the check: runout and the load loop's ripple cancel."""


def roll_check_u_mm(rig: RigConfig, off_mm: float = 0.0) -> float:
    """Return the standard uncertainty of the diameter from a single roll check, mm.

    ``off_mm``: additional depth of the press due to a load off the nominal load.
    """
    wear, stiffness = rig.wear, rig.loops.load.stiffness_n_per_mm
    per_n = 2.0 * (depth_mm(ROLL_CHECK_N + 0.5, stiffness) - depth_mm(ROLL_CHECK_N - 0.5, stiffness))
    return hypot(
        2.0 * wear.check_press_mm,
        per_n * wear.check_load_n,
        0.01 * wear.check_stiffness_percent * 2.0 * off_mm,
        wear.growth_mm_per_k * wear.check_rubber_k,
    )
