"""The levels of the interlock table, as plain comparisons: each function returns the bits of the rows that hold.

Every comparison is made in every scan. Conditions are written so that NaN and missing data fall on the tripped side:
``not (x <= limit)``, never ``x > limit``.
"""

from __future__ import annotations

from math import inf, isfinite
from typing import Final

from tester.control.interlocks import bit
from tester.control.load_loop import depth_mm
from tester.control.view import STANDING_M_S, UNLOADED_N, View
from tester.process import Readings

_INF: Final = inf
CONTACT_LEAST_N: Final = 50.0
"""A target below this is too near to touching to tell a lost contact (rulings, 18)."""
SPEEDS_OLD_S: Final = 0.5
"""Older than this, speeds, force and position are unknown to a stop, s [A]: it does not end on them."""
PRESSED_N: Final = 50.0
"""A contact that nobody wants gets no firmer by more than this, N [A]: runout and noise are 10 N."""
PUSHED_MM: Final = 0.3
"""A press that was told to lift has gone on beyond its ramp by this at most, mm [A]: 50 N at 200 N of load."""
TOUCH_MARGIN_MM: Final = 1.5
"""The wheel is touched at most this much later than where it was touched last, or its diameter says, mm [A]: about
160 N of force (physics, section 5) that a frozen load cell would not show."""
APART_M_S: Final = 0.1
"""One drive standing, the other faster than this, is no rounding of two equal ramps [A]."""
STOP_TIMEOUT_S: Final = 10.0
"""A stop that has not reached standstill by then takes the power off, and latches where it is [A]."""
CLEAR_MM: Final = 0.5
"""The press stands this far off the known contact: open, whatever the cell shows [A] (runout 0.05 mm, wear)."""

_CHAIN: Final = bit("safety chain")
_FAULT: Final = bit("drive fault")
_BUS: Final = bit("bus lost")
_MASTER: Final = bit("second master")
_JUMPED: Final = bit("clock jump")
_LATE: Final = bit("scan late")
_DELAYED: Final = bit("scan delayed")
_GUARD: Final = bit("guard open")
_DATA: Final = bit("drive data stale")
_INPUTS: Final = bit("inputs stale")
_DROPPED: Final = bit("drive dropped out")
_OVERSPEED: Final = bit("overspeed")
_WHEEL: Final = bit("wheel speed")
_BELT: Final = bit("belt speed")
_PRESS: Final = bit("press speed")
_STANDING: Final = bit("drive standing under load")
_TORN: Final = bit("belt torn")
_CELL_STALE: Final = bit("load cell stale")
_CELL_BAD: Final = bit("load cell saturated")
_CELL_FROZEN: Final = bit("load cell frozen")
_OVERLOAD: Final = bit("overload")
_OVERSHOOT: Final = bit("load overshoot")
_DEEP: Final = bit("contact too deep")
_CONTACT: Final = bit("contact lost")
_POWER: Final = bit("slip power")
_SURFACE_HOT: Final = bit("surface hot")
_HUB_HOT: Final = bit("jacket hot")
_RUNAWAY: Final = bit("jacket runaway")
_STUCK: Final = bit("heater stuck")
_OPEN: Final = bit("heater line open")
_STANDSTILL: Final = bit("heating at standstill")
_HUB_JUMP: Final = bit("hub sensor jump")
_SURFACE_JUMP: Final = bit("surface sensor jump")
_FROZEN: Final = bit("thermometer frozen")
_MODEL: Final = bit("surface off model")
_SURFACE_STALE: Final = bit("surface data stale")
_JACKET_STALE: Final = bit("jacket data stale")
_REFUSED: Final = bit("device refused")
_NOISY: Final = bit("line noisy")
_WORN: Final = bit("wheel worn")
_NOT_LIFTED: Final = bit("not lifted")
_LIFT_FAILED: Final = bit("lift failed")
_NOT_STOPPING: Final = bit("not stopping")
_QUICK_FAILED: Final = bit("quick stop failed")
_HEAT_ON: Final = bit("heat not off")
_OUTPUT: Final = bit("output not off")
_ENDLESS: Final = bit("stop not ended")
_WELDED: Final = bit("contactor welded")
_TRAVEL: Final = bit("press travel")
_MOVING: Final = bit("moving at rest")
_LOADED: Final = bit("loaded at rest")


def process_levels(v: View) -> int:
    """Return the levels of inputs, wires, devices and the scan itself."""
    r, b = v.readings, v.bounds
    held = 0
    if not r.safety_chain:
        held |= _CHAIN
    if not (r.now_s - r.inputs_at_s <= b.stale_inputs_s):
        held |= _INPUTS
    if r.drive_fault:
        held |= _FAULT
    if r.bus_fault:
        held |= _BUS
    if r.foreign_master:
        held |= _MASTER
    if r.device_fault:
        held |= _REFUSED
    if not (r.line_errors <= b.line_errors):
        held |= _NOISY
    if not (r.diameter_mm >= b.least_diameter_mm):
        held |= _WORN
    late_s = r.now_s - v.state.last_s - v.scan_s
    if not (late_s <= b.late_warn_s):
        held |= _DELAYED
        if not (late_s <= b.late_scan_s):
            held |= _LATE
    if not (r.now_s >= v.state.last_s):
        held |= _JUMPED
    if r.contactor_closed and not v.state.setpoints.contactor:
        held |= _WELDED
    return held


def motion_levels(v: View) -> int:
    """Return the levels of the drives."""
    r, b = v.readings, v.bounds
    wheel, belt = r.wheel_speed_m_s, r.belt_speed_m_s
    held = 0
    if v.demand.enabled:
        if not r.guard_closed:
            held |= _GUARD
        if r.drives_enabled:
            # Drives answer a scan's SYNC: after a late one their data is as old as that scan was ("scan late" judges).
            allowed = b.stale_can_scans * max(v.scan_s, r.now_s - v.state.last_s)
            since = r.now_s - (allowed if allowed < b.stale_can_s else b.stale_can_s)
            if not (
                r.wheel_at_s >= since
                and r.belt_at_s >= since
                and r.press_at_s >= since
                and r.sideslip_at_s >= since
                and r.camber_at_s >= since
            ):
                held |= _DATA
            if not (b.press_low_mm <= r.press_mm <= b.press_high_mm):
                held |= _TRAVEL
        elif v.confirmed:
            held |= _DROPPED
    if not r.drives_disabled and not (
        -v.wheel_most_m_s <= wheel <= v.wheel_most_m_s and -v.belt_most_m_s <= belt <= v.belt_most_m_s
    ):
        held |= _OVERSPEED
    if v.confirmed:
        error = b.speed_error_m_s
        if not (v.wheel.low_m_s - error <= wheel <= v.wheel.high_m_s + error):
            held |= _WHEEL
        if not (v.belt.low_m_s - error <= belt <= v.belt.high_m_s + error):
            held |= _BELT
        if not (v.press.ahead_mm <= b.press_error_mm):
            held |= _PRESS
    if not (r.force_z_n < UNLOADED_N) and not v.unpowered:
        belt_moves = belt > STANDING_M_S or belt < -STANDING_M_S
        # While they come down together one may stand a moment before the other: that is no wheel on a stopped belt.
        slow = -APART_M_S <= wheel <= APART_M_S and -APART_M_S <= belt <= APART_M_S
        # A quick stop takes both down at once, whatever their difference: it cannot be made any quicker.
        quick = v.stopped_s >= 0.0 and v.state.stop.fast_s <= r.now_s
        apart = v.turning is not belt_moves and not slow and not quick
        if apart or (v.pressing and not (v.turning and belt_moves)):
            held |= _STANDING
    return held


def load_levels(v: View) -> int:
    """Return the levels of load and friction; unloaded, or with the drives off, there is nothing to watch."""
    if not v.loaded or v.unpowered:
        return 0
    r, b, load = v.readings, v.bounds, v.state.load
    fz = r.force_z_n
    held = 0
    if not (r.now_s - r.cell_at_s <= b.stale_cell_s):
        held |= _CELL_STALE
    if not r.cell_valid:
        held |= _CELL_BAD
    if not (fz <= b.load_n):
        held |= _OVERLOAD
    if not (v.friction_w <= b.slip_power_w):
        held |= _POWER
    if v.turning and not (fz < UNLOADED_N) and not (r.now_s - r.cell_changed_s <= b.frozen_cell_s):
        held |= _CELL_FROZEN
    if not v.pressing:
        if not (fz <= v.least_n + PRESSED_N):
            held |= _OVERSHOOT
    else:
        beyond_mm = r.press_mm - v.contact_mm
        if not (fz >= UNLOADED_N) and not (beyond_mm <= TOUCH_MARGIN_MM):
            held |= _CELL_FROZEN
        if load.in_contact:
            needed_mm = depth_mm(fz, b.stiffness_n_per_mm)
            if not (beyond_mm <= b.depth_factor * needed_mm + b.depth_margin_mm):
                held |= _DEEP
        wanted = v.demand.load_n
        highest = load.highest_n if load.highest_n > wanted else wanted
        if not (fz <= b.overload_factor * highest + b.overload_margin_n):
            held |= _OVERSHOOT
        if load.loaded:
            lowest = load.lowest_n if load.lowest_n < wanted else wanted
            if lowest >= CONTACT_LEAST_N and not (fz >= b.contact_share * lowest):
                held |= _CONTACT
            if r.slip_m_s > b.torn_slip_m_s and not (v.friction_n >= b.torn_share * fz):
                least_nm = b.torn_share * fz * r.diameter_mm * 0.5e-3
                if not (abs(r.drive_torque_nm) >= least_nm):
                    held |= _TORN
    return held


def heat_levels(v: View) -> int:
    """Return the levels of jacket and surface."""
    r, b, jacket = v.readings, v.bounds, v.jacket
    held = 0
    heats = not (r.heat_percent <= 0.0)
    if heats and r.contactor_closed and not v.turning:
        held |= _STANDSTILL
    if r.jacket_valid and not (r.hub_c <= b.jacket_c + b.jacket_margin_k):
        held |= _HUB_HOT
    if not v.attended:
        held |= _hub_levels(v)
    if r.now_s - jacket.weak_since_s >= b.open_s and not (jacket.rise_k >= b.open_rise_k):
        held |= _OPEN
    if v.pressing or -_INF < v.demand.surface_c < _INF:
        if not (r.surface_valid and r.now_s - r.surface_at_s <= b.stale_ir_s):
            held |= _SURFACE_STALE
        if not (v.surface.jump_k <= b.jump_k):
            held |= _SURFACE_JUMP
    if r.surface_valid:
        if not (r.surface_c <= b.surface_c):
            held |= _SURFACE_HOT
        if v.turning:
            model = v.observer.surface_c
            if not (-b.model_k <= r.surface_c - model <= b.model_k):
                held |= _MODEL
            if not (r.now_s - r.surface_changed_s <= b.frozen_surface_s) or not (
                -b.frozen_model_k <= model - v.surface.model_c <= b.frozen_model_k
            ):
                held |= _FROZEN
    return held


def _hub_levels(v: View) -> int:
    """Return the levels that compare the hub's readings; while a person is at its plug they say nothing."""
    r, b, jacket = v.readings, v.bounds, v.jacket
    held = 0
    if not (r.jacket_valid and r.now_s - r.jacket_at_s <= b.stale_jacket_s):
        held |= _JACKET_STALE
    if r.jacket_valid:
        ceiling = v.state.hub_ceiling
        # A hub that was hot takes longer to cool than the window is: without output it must not get hotter again,
        # except by a rubber that friction has made hotter than itself.
        if ceiling:
            coolest = jacket.coolest_c
            highest = max(ceiling[0][1], b.hub_min_c, coolest)
            if coolest > -_INF and r.surface_valid and r.surface_c > highest:
                highest = r.surface_c
            if not (r.hub_c <= highest + b.runaway_k):
                held |= _RUNAWAY
        if not (jacket.rate_k_s <= b.stuck_rate_k_s) and r.now_s - jacket.off_since_s >= b.stuck_off_s:
            held |= _STUCK
    if not (jacket.jump_k <= b.jump_k):
        held |= _HUB_JUMP
    return held


def lift_levels(v: View) -> int:
    """Return the levels of a stop or a hold that does not lift; call it only while one is under way."""
    b, held = v.bounds, 0
    if not (v.lifting_s <= b.lift_late_s) and not unloaded(v):
        held |= _NOT_LIFTED
        if not (v.lifting_s <= b.lift_failed_s):
            held |= _LIFT_FAILED
    return held


def stop_levels(v: View) -> int:
    """Return the levels of a stop that does not work; call it only while one is under way."""
    r, b, stop = v.readings, v.bounds, v.state.stop
    since = v.stopped_s
    held = 0
    if not (r.press_mm <= stop.press_mm + PUSHED_MM) and not unloaded(v):
        held |= _LIFT_FAILED
    if not (since <= b.heat_off_s) and not (r.heat_percent <= 0.0):
        held |= _OUTPUT
        if not contactor_open(v):
            held |= _HEAT_ON
    if not stop.creeps and not (r.now_s - v.state.mode_since_s <= STOP_TIMEOUT_S):
        held |= _ENDLESS
    if not stop.creeps and not standing(r):
        axis = v.rig.axes.belt
        # Slip is taken out first (half a second at most), then both come down on the ramp.
        if not (since <= 0.5 + stop.speed_m_s / axis.deceleration + b.stop_margin_s):
            held |= _NOT_STOPPING
        if not (r.now_s - stop.fast_s <= stop.fast_speed_m_s / axis.quick_stop_deceleration + b.stop_margin_s):
            held |= _QUICK_FAILED
    return held


def rest_levels(v: View) -> int:
    """Return the levels of a rig that is to rest; call it only in idle, armed and latched."""
    r = v.readings
    held = 0
    if not standing(r) or (not r.drives_disabled and not (r.press_mm <= v.state.stop.press_mm + PUSHED_MM)):
        held |= _MOVING
    if not unloaded(v):
        held |= _LOADED
    if not (r.heat_percent <= 0.0):
        held |= _OUTPUT
    return held


def unpowered_levels(v: View) -> int:
    """Return the levels of a run whose drives are off, or on their way to operation: a person may be near.

    What a hand turns has no power; what nobody has said anything of for a while may have.
    """
    r = v.readings
    if v.demand.enabled:
        still = standing(r) and r.press_mm <= v.rest_mm + PUSHED_MM
    else:
        since = r.now_s - SPEEDS_OLD_S
        still = r.drives_disabled and r.wheel_at_s >= since and r.belt_at_s >= since and r.press_at_s >= since
    return 0 if still else _MOVING


def unseen_levels(v: View) -> int:
    """Return levels that are watched only while drives, load or heat are wanted, as if they were: is a cause gone?"""
    r, since = v.readings, v.readings.now_s - SPEEDS_OLD_S
    held = 0
    if not r.guard_closed:
        held |= _GUARD
    if not (r.cell_at_s >= since):
        held |= _CELL_STALE
    if not r.cell_valid:
        held |= _CELL_BAD
    if not (r.surface_valid and r.now_s - r.surface_at_s <= v.bounds.stale_ir_s):
        held |= _SURFACE_STALE
    return held


def standing(r: Readings) -> bool:
    """Tell whether wheel and belt are known to stand; what is old or unknown is not standing."""
    since = r.now_s - SPEEDS_OLD_S
    return (
        r.wheel_at_s >= since
        and r.belt_at_s >= since
        and -STANDING_M_S < r.wheel_speed_m_s < STANDING_M_S
        and -STANDING_M_S < r.belt_speed_m_s < STANDING_M_S
    )


def contactor_open(v: View) -> bool:
    """Tell whether the heater's contactor is known to be open."""
    r = v.readings
    return not r.contactor_closed and r.now_s - r.inputs_at_s <= v.bounds.stale_inputs_s


def unloaded(v: View) -> bool:
    """Tell whether the contact is known to be open: by a fresh force, or by the press standing clear of it.

    The position only counts where the cell says nothing: it is stale, invalid, or repeats itself.
    """
    r = v.readings
    if r.cell_valid and r.now_s - r.cell_at_s <= SPEEDS_OLD_S:
        if r.force_z_n < UNLOADED_N:
            return True
        if r.now_s - r.cell_changed_s <= SPEEDS_OLD_S:
            return False
    load = v.state.load
    known = isfinite(load.contact_mm) and r.now_s - r.press_at_s <= SPEEDS_OLD_S
    return known and r.press_mm <= load.contact_mm - CLEAR_MM
