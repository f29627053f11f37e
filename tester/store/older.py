"""What records of older schemas do not say of themselves: which kind of rig they are of, its axes, its error terms.

Up to schema 7 there was one kind. This list is as its records were made and is never edited: what is here is theirs.
"""

from __future__ import annotations

from typing import Final

from tester.analysis.terms import Acts, Term
from tester.base.axes import Axes, Axis

KIND: Final = "wheel_on_belt"

AXES: Final = Axes(
    (
        Axis("slip_velocity", "m/s", "slip_velocity_m_s", "mm/s", 1e3, "slip_velocity_mm_s", "Slip Velocity /mm·s⁻¹",
             "Slip mm/s", "", None, True, 2),
        Axis("load", "N", "load_n", "N", 1.0, "load_n", "Load /N", "Load N", "", None, True, 1),
        Axis("sideslip", "deg", "sideslip_deg", "deg", 1.0, "sideslip_deg", "Sideslip Angle /°", "Angle °", "sideslip",
             0.0, True, 4),
        Axis("camber", "deg", "camber_deg", "deg", 1.0, "camber_deg", "Camber Angle /°", "Camber °", "camber",
             0.0, False, 5),
        Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "",
             None, True, 3),
        Axis("wheel_speed", "m/s", "wheel_speed_m_s", "m/s", 1.0, "wheel_speed_m_s", "Wheel Speed /m·s⁻¹", "Wheel m/s",
             "wheel", 0.8, False, 6),
    ),
    blocks="temperature",
)  # fmt: skip

_WEAR = "believed wear rate 0.08 mm3/(N m) of a range of 0.02 to 0.3 [A]"

TERMS: Final = (
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
"""What the measuring chain may be off by, of records up to schema 8. Limits are engineering assumptions; a recipe's
metadata replaces them as ``uncertainty.<setting>``. Exponents of load and speed are those of the model of doi
10.3390/polym16050596 near 200 N and 300 mm/s, rounded up over its three compounds."""
