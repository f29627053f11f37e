"""The stops, scan by scan, from leaving RUN to standstill. What must have happened by when: ``interlocks.stops``."""

from __future__ import annotations

from math import isfinite

from tester.control.interlock_inputs import InterlockInputs
from tester.control.permissives import Bounds, confirmed_speed_m_s
from tester.control.safe_outputs import mirror_emergency, no_outputs, safe_outputs
from tester.control.state import ControlState, Mode
from tester.interlocks.contact import UNLOADED_N
from tester.interlocks.hub import STALE_JACKET_S
from tester.interlocks.known import contactor_open, standing, unloaded
from tester.interlocks.operation import COOLDOWN_AT_MOST_S, COOLDOWN_HUB_C, COOLDOWN_SPEED_M_S
from tester.interlocks.stops import HEAT_OFF_S, LIFTED_MM, PRESS_LAG_S, SLIP_OUT_S, STOP_TIMEOUT_S


def begin_stop(state: ControlState, view: InterlockInputs, now: float, bounds: Bounds) -> None:
    """Note when a stop began, and how fast the drives were: what is not known counts as the most allowed.

    A press on its way to the contact still has its ramp before it, and the lag of scan and drive.
    """
    stop = state.stop
    stop.began_s = now
    stop.speed_m_s = _speed(view, bounds)
    coming = max(view.press.high_mm_s, state.setpoints.press_mm_s)
    coming_mm = coming * (view.parameters[PRESS_LAG_S] + 0.5 * coming / view.rig.axes.press.deceleration)
    stop.press_mm = view.readings.press_mm + coming_mm if isfinite(view.readings.press_mm) else float("inf")
    stop.fast_s = float("inf")
    stop.creeps = False


def begin_fast(state: ControlState, view: InterlockInputs, now: float, bounds: Bounds) -> None:
    """Note when the quick stop began."""
    if state.stop.fast_s > now:
        state.stop.fast_s = now
        state.stop.fast_speed_m_s = _speed(view, bounds)


def _speed(view: InterlockInputs, bounds: Bounds) -> float:
    wheel, belt = abs(view.readings.wheel_speed_m_s), abs(view.readings.belt_speed_m_s)
    if isfinite(wheel) and isfinite(belt):
        return max(wheel, belt)
    return max(bounds.wheel_speed_m_s, bounds.belt_speed_m_s)


def stop_outputs(state: ControlState, view: InterlockInputs) -> None:
    """Command a controlled or a fast stop."""
    out, r, rig = state.setpoints, view.readings, view.rig
    fast = state.mode is not Mode.STOPPING
    wheel_rad_s = out.wheel_rad_s
    safe_outputs(out, rig, fast=fast)
    loaded = not (r.force_z_n < UNLOADED_N)
    matched_m_s = confirmed_speed_m_s(view.parameters)
    slipping = not (-matched_m_s < r.slip_m_s < matched_m_s)
    if not fast and loaded and slipping and view.stopped_s < view.parameters[SLIP_OUT_S] and r.wheel_speed_m_s > 0.0:
        # Slip to zero first: with equal decelerations the slower belt would stand while the wheel still turns.
        out.wheel_rad_s = wheel_rad_s
        out.belt_m_s = min(r.wheel_speed_m_s, rig.limits.belt_speed_m_s)
    lifted_mm = state.load.lifted_mm(rig.loops.load) if unloaded(view) else 0.0
    if r.press_mm <= lifted_mm + view.parameters[LIFTED_MM]:
        out.press_mm_s = 0.0


def stop_ended(state: ControlState, view: InterlockInputs) -> bool:
    """Tell whether the rig stands, lifted, unloaded and without heat, or the time for it is over ("stop not ended")."""
    r = view.readings
    if r.now_s - state.mode_since_s > view.parameters[STOP_TIMEOUT_S]:
        return True
    lifted = r.press_mm <= state.load.lifted_mm(view.rig.loops.load) + view.parameters[LIFTED_MM]
    if state.mode is Mode.EMERGENCY or state.setpoints.power_off or r.drives_disabled:
        lifted = True  # the press has no power: the open contact is what counts
    return standing(view) and lifted and unloaded(view) and heat_off(view)


def heat_off(view: InterlockInputs) -> bool:
    """Tell whether the heat is known to be off: no output and the contactor open.

    Once the time for both is over, one of them is enough, for it keeps the heat off; the other one's row has tripped.
    """
    r, p = view.readings, view.parameters
    silent = r.jacket_valid and r.now_s - r.jacket_at_s <= p[STALE_JACKET_S] and r.heat_percent <= 0.0
    if view.stopped_s <= p[HEAT_OFF_S]:
        return silent and contactor_open(view)
    return silent or contactor_open(view)


def after_stop(state: ControlState, view: InterlockInputs) -> None:
    """Leave a stop that has ended: to the cool-down, to LATCHED after a trip, else to IDLE."""
    r, now = view.readings, view.readings.now_s
    trip = state.trip
    hub_c = r.hub_c if r.jacket_valid else view.jacket.hub_c
    healthy = state.mode is Mode.STOPPING and r.drives_enabled and not r.drive_fault
    if healthy and hub_c > view.parameters[COOLDOWN_HUB_C] and not state.cooled:
        state.enter(Mode.COOLDOWN, now, "jacket hot")
        state.stop.creeps = True
        return
    state.stop.began_s = float("inf")
    state.stop.press_mm = r.press_mm if isfinite(r.press_mm) else float("inf")
    if trip is not None or state.mode is not Mode.STOPPING:
        state.enter(Mode.LATCHED, now, "standstill")
    else:
        state.enter(Mode.IDLE, now, "standstill")
    no_outputs(state.setpoints, view.rig)


def emergency_outputs(state: ControlState, view: InterlockInputs) -> None:
    """Mirror the hardware's emergency stop."""
    mirror_emergency(state.setpoints, view.rig)


def cool_outputs(state: ControlState, view: InterlockInputs) -> bool:
    """Command the cool-down: unloaded creep, heat off. Return whether it is over."""
    out, r, p, now = state.setpoints, view.readings, view.parameters, view.readings.now_s
    safe_outputs(out, view.rig, fast=False)
    out.press_mm_s = 0.0
    cool = r.jacket_valid and r.hub_c <= p[COOLDOWN_HUB_C]
    if cool or now - state.mode_since_s > p[COOLDOWN_AT_MOST_S]:
        state.cooled = True
        state.enter(Mode.STOPPING, now, "cooled down" if cool else "cool-down time over")
        return True
    out.wheel_rad_s = p[COOLDOWN_SPEED_M_S] / (r.diameter_mm * 0.5e-3) if r.diameter_mm > 1.0 else 0.0
    return False


