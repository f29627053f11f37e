"""The stops of this machine, scan by scan, from leaving RUN to standstill. Deadlines are in ``interlocks.stops``."""

from __future__ import annotations

from math import inf, isfinite
from typing import Final

from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.control.loops import WheelState
from tester.kinds.wheel_on_belt.control.permissives import Bounds, confirmed_speed_m_s
from tester.kinds.wheel_on_belt.image.process_image import Demand, Readings, Setpoints
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N
from tester.kinds.wheel_on_belt.interlocks.hub import STALE_JACKET_S
from tester.kinds.wheel_on_belt.interlocks.inputs import contactor_open, standing, unloaded
from tester.kinds.wheel_on_belt.interlocks.operation import COOLDOWN_AT_MOST_S, COOLDOWN_HUB_C, COOLDOWN_SPEED_M_S
from tester.kinds.wheel_on_belt.interlocks.stops import HEAT_OFF_S, LIFTED_MM, PRESS_LAG_S, SLIP_OUT_S, STOP_TIMEOUT_S
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.control import Control
from tester.machine.state import Mode

SWELL_SHARE: Final = 0.1
SWELL_S: Final = 0.5
"""The creep of a cool-down is slower by this share [A] for this time, s [A], and then as long not: the data of a drive
that obeys change.
"""


def safe_outputs(setpoints: Setpoints, rig: RigConfig, *, fast: bool) -> None:
    """Overwrite the commands with safe commands, all in this scan; no action waits for another.

    The heat is off and the contactor open, the press retracts, and both drives go to zero on equal linear decelerations
    (``fast``: by quick stop, with the press at full speed). Positioned axes stay: moving them would not help.
    """
    setpoints.heat = False
    setpoints.contactor = False
    setpoints.hub_c = rig.loops.heat.hub_min_c
    setpoints.press_mm_s = -rig.axes.press.max_speed if fast else -rig.loops.load.lift_speed_mm_s
    setpoints.wheel_rad_s = 0.0
    setpoints.belt_m_s = 0.0
    setpoints.quick_stop = fast


def heat_off(view: InterlockInputs) -> bool:
    """Return whether the heat is known to be off: no output and the contactor open.

    Once the time for both is over, either is enough, because it keeps the heat off; the other's row has tripped.
    """
    r, p = view.readings, view.parameters
    silent = r.jacket_valid and r.now_s - r.jacket_at_s <= p[STALE_JACKET_S] and r.heat_percent <= 0.0
    if view.stopped_s <= p[HEAT_OFF_S]:
        return silent and contactor_open(view)
    return silent or contactor_open(view)


class WheelStops(Control[WheelState, Readings, Demand, InterlockInputs]):
    """Control outside RUN and HOLD; the module ``step`` adds the commands in RUN and HOLD."""

    rig: RigConfig
    bounds: Bounds

    def safe_outputs(self) -> None:
        safe_outputs(self.state.setpoints, self.rig, fast=True)

    def emergency_outputs(self) -> None:
        """Set every command to zero: the hardware has cut the power, and nothing may start when power returns.

        The quick stop ends in power off by itself; the press gets no power, so that its spring lifts it.
        """
        safe_outputs(self.state.setpoints, self.rig, fast=True)
        self._no_power()

    def rest_outputs(self) -> None:
        """Set every command to zero and request no power. Escalations stay until they are acknowledged."""
        safe_outputs(self.state.setpoints, self.rig, fast=False)
        self._no_power()

    def _no_power(self) -> None:
        out = self.state.setpoints
        out.press_mm_s = 0.0
        out.enable = out.creeps = False

    def withdraw_escalation(self) -> None:
        super().withdraw_escalation()
        self.state.setpoints.jacket_silent = False

    def end_lease(self, readings: Readings) -> None:
        """Stop renewing the jacket's setpoint while it gives output."""
        if not (readings.heat_percent <= 0.0):
            self.state.setpoints.jacket_silent = True

    def note_stop(self) -> None:
        """Record the drives' speeds at the start of a stop, and how far the press may still come.

        A press that approaches the contact still moves during its ramp and the lag of scan and drive.
        """
        state, view = self.state, self.view
        start = state.stop_start
        start.speed_m_s = self._speed()
        coming = max(view.press.high_mm_s, state.setpoints.press_mm_s)
        coming_mm = coming * (view.parameters[PRESS_LAG_S] + 0.5 * coming / self.rig.axes.press.deceleration)
        start.press_mm = view.readings.press_mm + coming_mm if isfinite(view.readings.press_mm) else inf
        start.lifted_mm = state.load.lifted_mm(self.rig.loops.load)

    def note_fast_stop(self) -> None:
        self.state.stop_start.fast_speed_m_s = self._speed()

    def note_rest(self) -> None:
        press_mm = self.view.readings.press_mm
        self.state.stop_start.press_mm = press_mm if isfinite(press_mm) else inf

    def _speed(self) -> float:
        """Return the faster of wheel and belt, m/s; an unknown speed counts as the highest allowed."""
        wheel, belt = abs(self.view.readings.wheel_speed_m_s), abs(self.view.readings.belt_speed_m_s)
        if isfinite(wheel) and isfinite(belt):
            return max(wheel, belt)
        return max(self.bounds.wheel_speed_m_s, self.bounds.belt_speed_m_s)

    def stop_outputs(self) -> None:
        """Command a controlled or a fast stop."""
        state, view, rig = self.state, self.view, self.rig
        out, r = state.setpoints, view.readings
        fast = state.mode is not Mode.STOPPING
        wheel_rad_s = out.wheel_rad_s
        safe_outputs(out, rig, fast=fast)
        loaded = not (r.force_z_n < UNLOADED_N)
        matched_m_s = confirmed_speed_m_s(view.parameters)
        slipping = not (-matched_m_s < r.slip_m_s < matched_m_s)
        taking_out = not fast and view.stopped_s < view.parameters[SLIP_OUT_S]
        if taking_out and loaded and slipping and r.wheel_speed_m_s > 0.0:
            # Slip to zero first: with equal decelerations the slower belt would stop while the wheel still turns.
            out.wheel_rad_s = wheel_rad_s
            out.belt_m_s = min(r.wheel_speed_m_s, rig.limits.belt_speed_m_s)
        lifted_mm = state.load.lifted_mm(rig.loops.load) if unloaded(view) else 0.0
        if r.press_mm <= lifted_mm + view.parameters[LIFTED_MM]:
            out.press_mm_s = 0.0
        if fast and self.motion_over():
            out.enable = False  # after a controlled stop a hot wheel turns on

    def motion_over(self) -> bool:
        """Return whether wheel and belt are known to stand, and the press to be lifted and unloaded."""
        state, view = self.state, self.view
        r = view.readings
        lifted = r.press_mm <= state.load.lifted_mm(self.rig.loops.load) + view.parameters[LIFTED_MM]
        if state.mode is Mode.EMERGENCY or state.setpoints.power_off or r.drives_disabled:
            lifted = True  # the press has no power: only the open contact counts
        return standing(view) and lifted and unloaded(view)

    def stop_ended(self) -> bool:
        """Return whether the rig is at rest, lifted, unloaded and without heat, or has timed out ("stop not ended")."""
        view = self.view
        late = view.readings.now_s - self.state.mode_since_s > view.parameters[STOP_TIMEOUT_S]
        return late or (self.motion_over() and (heat_off(view) or self._heat_given_up()))

    def _heat_given_up(self) -> bool:
        """Return whether a stop under power has waited long enough for a heater whose failure has tripped.

        The wheel turns on if it is hot, and every other axis loses its power. A fast stop waits without power.
        """
        state, view = self.state, self.view
        waited = view.stopped_s > view.parameters[HEAT_OFF_S]
        return waited and state.mode is Mode.STOPPING and state.trip is not None

    def must_cool(self) -> str:
        """Return why the wheel must turn on after a controlled stop: a hot hub bakes one spot of a standing wheel."""
        view = self.view
        r = view.readings
        hub_c = r.hub_c if r.jacket_valid else view.jacket.hub_c
        healthy = r.drives_enabled and not r.drive_fault
        return "jacket hot" if healthy and hub_c > view.parameters[COOLDOWN_HUB_C] else ""

    def cool_outputs(self) -> str:
        """Command the cool-down: unloaded creep, heat off. Return why it is over, "" until then."""
        out, r, p = self.state.setpoints, self.view.readings, self.view.parameters
        safe_outputs(out, self.rig, fast=False)
        out.press_mm_s = 0.0
        out.creeps = True
        since_s = r.now_s - self.state.mode_since_s
        self.state.cooling.follow(r.hub_c)
        if r.jacket_valid and r.hub_c <= p[COOLDOWN_HUB_C]:
            return "cooled down"
        if since_s > p[COOLDOWN_AT_MOST_S]:
            return "cool-down time over"
        slower = 1.0 - SWELL_SHARE if since_s % (2.0 * SWELL_S) < SWELL_S else 1.0
        creep_m_s = slower * p[COOLDOWN_SPEED_M_S]
        out.wheel_rad_s = creep_m_s / (r.diameter_mm * 0.5e-3) if r.diameter_mm > 1.0 else 0.0
        return ""

    def cools_s(self) -> float:
        r, p, cooling = self.view.readings, self.view.parameters, self.state.cooling
        if not (r.jacket_valid and cooling.far(cooling.last_c - p[COOLDOWN_HUB_C])):
            return 0.0
        return p[COOLDOWN_AT_MOST_S] - (r.now_s - self.state.mode_since_s)
