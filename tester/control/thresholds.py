"""What the levels compare with: the numbers of the rig file that a scan asks for, in one plain object.

A scan reads some fifty of them. The configuration is known by its annotations and therefore stays Python where the scan
is compiled (docs/decisions/0019); asking it each time would cost more than comparing.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf

from tester.rig import RigConfig


@dataclass(slots=True)
class Thresholds:
    """Names, units and meaning are the rig file's: its sections ``interlocks``, ``limits`` and ``loops``."""

    # interlocks
    contact_share: float
    depth_factor: float
    depth_margin_mm: float
    frozen_cell_s: float
    frozen_model_k: float
    frozen_surface_s: float
    heat_off_s: float
    jacket_margin_k: float
    jump_k: float
    late_scan_s: float
    late_warn_s: float
    least_diameter_mm: float
    lift_failed_s: float
    lift_late_s: float
    line_errors: float
    max_slip_m_s: float
    model_k: float
    open_below_k: float
    open_output_percent: float
    open_rise_k: float
    open_s: float
    overload_factor: float
    overload_margin_n: float
    press_error_mm: float
    runaway_k: float
    speed_error_m_s: float
    stale_can_s: float
    stale_can_scans: float
    stale_cell_s: float
    stale_inputs_s: float
    stale_ir_s: float
    stale_jacket_s: float
    stop_margin_s: float
    stuck_off_s: float
    stuck_rate_k_s: float
    torn_share: float
    torn_slip_m_s: float
    # limits
    jacket_c: float
    load_n: float
    slip_power_w: float
    surface_c: float
    # loops.heat
    hub_min_c: float
    # loops.load
    stiffness_n_per_mm: float
    # axes.press: its software limits, mm
    press_low_mm: float
    press_high_mm: float


def thresholds_of(rig: RigConfig) -> Thresholds:
    """Take the numbers over from a rig's configuration; every other name is in one of these sections."""
    sections = (rig.interlocks, rig.limits, rig.loops.heat, rig.loops.load)
    low_mm, high_mm = rig.axes.press.software_limits or (-inf, inf)
    known = {"press_low_mm": low_mm, "press_high_mm": high_mm}
    for field in fields(Thresholds):
        if field.name not in known:
            known[field.name] = next(getattr(part, field.name) for part in sections if hasattr(part, field.name))
    return Thresholds(**known)
