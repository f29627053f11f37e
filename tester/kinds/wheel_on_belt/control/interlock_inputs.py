"""The inputs of the interlocks' conditions, brought up to date once a scan."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Final

from tester.inputs.rig.config import values_of
from tester.inputs.rig.parameter import Values
from tester.kinds.wheel_on_belt.control.loops import WheelState
from tester.kinds.wheel_on_belt.control.observer import ThermalObserver
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings
from tester.kinds.wheel_on_belt.interlocks import hub, motion, surface, witness
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N, ForceObserver
from tester.kinds.wheel_on_belt.interlocks.heat_balance import HeatBalance, KnownRatio
from tester.kinds.wheel_on_belt.interlocks.inputs import STANDING_M_S, Inputs, PressBand, RigLimits
from tester.kinds.wheel_on_belt.interlocks.monitors import (
    FREE_MM,
    FreeTravel,
    JacketMonitor,
    PressTracker,
    SpeedTracker,
    SurfaceMonitor,
)
from tester.kinds.wheel_on_belt.rig import RigConfig

_INF: Final = inf
_LOAD: Final = Press.LOAD  # bound once: a look-up on the enum class costs several times as much (CPython 3.11)
ALIKE_K: Final = 1.5
"""Hub and surface of a rig at the air's temperature differ by less, K [A]: the bias of the thermometer and noise."""
UNKNOWN_MM: Final = 2.0
"""A wheel that has not been touched yet may be so much nearer than its diameter says, mm: interlocks.touch_margin."""
AIR_OFF_K: Final = 3.0
AIR_WRONG_K: Final = 20.0
"""Air off the file's by more than the first is believed, K [A]; by more than the second, a sensor is wrong."""


@dataclass(slots=True)
class InterlockInputs(Inputs):
    """One object serves every scan: ``look`` brings it up to date."""

    state: WheelState = field(kw_only=True)
    rig: RigConfig = field(kw_only=True)
    observer: ThermalObserver = field(init=False)
    warmer_k: float = 0.0
    """How much warmer the air is than the file states, K; 0 where it is colder, or not known."""
    _air_unknown: bool = True
    heat_known: str = ""
    """Facts about the heat balance from earlier runs, in words."""

    def __post_init__(self) -> None:
        """Read the rig file's limits, link the control's state, and create the observers and monitors."""
        rig, state = self.rig, self.state
        self.parameters = p = values_of(rig.interlocks, rig.table.parameters)
        self.note_further(rig)
        self.limits = limits_of(rig)
        self.setpoints, self.contact = state.setpoints, state.load
        self.stop, self.stop_start = state.stop, state.stop_start
        self.hub_setpoints = state.hub_ceiling
        self.observer = ThermalObserver(rig)
        self.jacket = _jacket_monitor(p)
        self.surface = SurfaceMonitor(p[surface.BLIND_S])
        radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
        self.wheel = SpeedTracker(p[motion.RAMP_SHARE] * rig.axes.wheel.acceleration * radius_m)
        self.belt = SpeedTracker(p[motion.RAMP_SHARE] * rig.axes.belt.acceleration)
        self.press = PressTracker(p[motion.RAMP_SHARE] * rig.loops.load.acceleration_mm_s2)
        self.press_band = _press_band(rig)
        self.free = _free_travel(rig)
        self.force = ForceObserver(
            self.limits.stiffness_n_per_mm,
            p[witness.FORCE_STEP_UNSEEN_SHARE],
            p[witness.FORCE_STEP_SEEN_SHARE],
            p[witness.FORCE_STEP_CROSS_SHARE],
        )
        self.heat = _heat_balance(rig, p)

    def look(self, demand: Demand, r: Readings, scan_s: float, dt: float) -> None:
        """Store this scan's demand and readings, and compute the values that several conditions use."""
        self.demand, self.readings = demand, r
        state = self.state
        self.note_times(state, r.now_s, scan_s)
        self.pressing = pressing = demand.press is _LOAD
        self.loaded = loaded = pressing or not (r.force_z_n < UNLOADED_N)
        if pressing:
            self.least_n = inf
            contact_mm = state.load.worn_to_mm(r.diameter_mm)
            if not -_INF < contact_mm < _INF:
                contact_mm = self.rig.geometry.touch_at_mm(r.diameter_mm)
            self.contact_mm = contact_mm
            if r.cell_valid and r.cell_at_s > self.force.stamp_s:
                self.force.update(r)
        elif r.force_z_n < self.least_n:
            self.least_n = r.force_z_n
        if not pressing and self.force.kept:
            self.force.forget()
        wheel_m_s = r.wheel_speed_m_s
        still = self.parameters[STANDING_M_S]
        self.turning = wheel_m_s > still or wheel_m_s < -still
        self._follow_speeds(demand, r, dt)
        if self.attended is not demand.attended:
            self.attended = demand.attended
            self._forget_readings(r.now_s)
        observer = self.observer
        if loaded:
            fx, fy = r.force_x_n, r.force_y_n
            self.friction_n = friction = sqrt(fx * fx + fy * fy)
            self.friction_w = power = friction * r.slip_m_s
            if not (r.force_z_n < UNLOADED_N):
                observer.rub(power, dt)
        else:
            self.friction_n = self.friction_w = 0.0
        if r.now_s >= observer.due_s:
            self._follow_heat(r)
        if r.jacket_at_s > self.jacket.stamp_s:
            self.jacket.update(r, state.setpoints.heat, state.setpoints.hub_c)
        self.model_c = model_c = observer.surface_c
        if r.surface_at_s > self.surface.stamp_s:
            self.surface.update(r, model_c)

    def _follow_heat(self, r: Readings) -> None:
        """Advance the thermal observer and the heat balance."""
        if self._air_unknown and r.surface_valid and r.jacket_valid:
            self._look_at_air(r)
        observer = self.observer
        hub_c = r.hub_c if r.jacket_valid else self.jacket.hub_c
        observer.step(r.now_s, hub_c, r.wheel_speed_m_s, r.surface_c)
        self.heat.update(r.now_s, hub_c, r.heat_percent if r.contactor_closed else 0.0, observer.given_j)

    def _look_at_air(self, r: Readings) -> None:
        """Take the air's temperature from a rig that has it everywhere, where its file states a clearly different one.

        Otherwise air that is 15 K off would look like a thermometer that is 6 K off.
        """
        self._air_unknown = False
        off_k = r.hub_c - self.rig.ambient_c
        even = -ALIKE_K <= r.surface_c - r.hub_c <= ALIKE_K
        if even and AIR_OFF_K < abs(off_k) <= AIR_WRONG_K:
            self.observer.air(r.hub_c)
            self.heat.ambient_c = r.hub_c
            self.warmer_k = max(0.0, off_k)

    def _follow_speeds(self, demand: Demand, r: Readings, dt: float) -> None:
        """Update the speed trackers while the drives are in operation and receive commands.

        A stop has its own limits: its ramps are steeper, and separate rows check that it ends.
        """
        resting = self.unpowered
        if self.note_drives(self.state.mode, demand, r):
            self.wheel.begin(r.wheel_speed_m_s)
            self.belt.begin(r.belt_speed_m_s)
            self.press.begin(r)
            self.free.begin(r)
        if self.confirmed:
            out = self.state.setpoints
            self.wheel.follow(out.wheel_rad_s * r.diameter_mm * 0.5e-3, dt)
            belt = self.belt
            if not belt.low_m_s == out.belt_m_s == belt.high_m_s:
                belt.follow(out.belt_m_s, dt)
            self.press.follow(out.press_mm_s, dt, r)
            if r.press_at_s > self.free.at_s and self.free.spring_nm > 0.0:
                self.free.update(r, r.press_mm < self._free_to_mm(r.diameter_mm))
        elif self.unpowered and (not resting or r.press_mm < self.rest_mm):
            self.rest_mm = r.press_mm

    def _free_to_mm(self, diameter_mm: float) -> float:
        """Return how far the press surely touches no wheel, mm."""
        contact_mm = self.state.load.contact_mm
        if -_INF < contact_mm < _INF:
            return contact_mm - FREE_MM
        return self.rig.geometry.touch_at_mm(diameter_mm) - UNKNOWN_MM

    def wheel_changed(self, now: float) -> None:
        """Restart with a wheel at ambient temperature: nothing is compared with the previous wheel."""
        self.observer.new_wheel()
        self._forget_readings(now)

    def know_heat(self, known: KnownRatio) -> None:
        """Take over the history of the rig's heatings, before the first scan."""
        widest, beyond = self.parameters[hub.HEAT_SHARE], self.parameters[hub.HEAT_SHARE_KNOWN]
        self.heat.share = known.share(widest, beyond)
        self.heat.ungiven_share = known.ungiven_share(widest, beyond)
        if known.heatings:
            self.heat.ratio, self.heat.spread = known.ratio, beyond
        self.heat_known = known.words(widest, beyond)

    def _forget_readings(self, now: float) -> None:
        """Drop earlier temperatures from later comparisons."""
        self.surface.forget(now)
        self.jacket.forget(now)
        self.heat.forget()


def limits_of(rig: RigConfig) -> RigLimits:
    """Return the limits for conditions from a rig file's sections other than ``interlocks``.

    The configuration depends on its annotations and therefore stays Python where the scan is compiled
    (docs/decisions/0019). Reading it in every scan would cost more than comparing.
    """
    limits, belt = rig.limits, rig.axes.belt
    low_mm, high_mm = rig.axes.press.software_limits or (-inf, inf)
    return RigLimits(
        load_n=limits.load_n,
        heartbeat_s=rig.can.drive_heartbeat_s,
        wheel_speed_m_s=limits.wheel_speed_m_s,
        belt_speed_m_s=limits.belt_speed_m_s,
        slip_power_w=limits.slip_power_w,
        roller_m=0.5e-3 * rig.geometry.belt_roller_diameter_mm,
        jacket_c=limits.jacket_c,
        surface_c=limits.surface_c,
        hub_min_c=rig.loops.heat.hub_min_c,
        stiffness_n_per_mm=rig.loops.load.stiffness_n_per_mm,
        press_low_mm=low_mm,
        press_high_mm=high_mm,
        deceleration_m_s2=belt.deceleration,
        quick_stop_m_s2=belt.quick_stop_deceleration,
        lift_mm_s=rig.loops.load.lift_speed_mm_s,
    )


def _press_band(rig: RigConfig) -> PressBand:
    screw = rig.axes.press.screw
    if screw is None:
        return PressBand(known=False)
    return PressBand(
        True, screw.drag_most_nm, screw.spring_n, screw.spring_rate_n_per_mm, screw.reached_n_per_nm,
        screw.held_n_per_nm,
    )  # fmt: skip


def _free_travel(rig: RigConfig) -> FreeTravel:
    press, screw = rig.axes.press, rig.axes.press.screw
    digit_nm = 0.5e-3 * press.rated_torque_nm
    if screw is None:
        return FreeTravel(0.0, 0.0, digit_nm)
    return FreeTravel(screw.spring_nm, screw.nm_per_n * screw.spring_rate_n_per_mm, digit_nm)


def _heat_balance(rig: RigConfig, p: Values) -> HeatBalance:
    thermal = rig.observer.thermal
    return HeatBalance(
        thermal.hub_capacity, thermal.hub_to_shaft, thermal.jacket_power, rig.ambient_c, p[hub.HEAT_SHARE],
        p[hub.HEAT_LEAK_W], p[hub.HEAT_SHARE],
    )  # fmt: skip


def _jacket_monitor(p: Values) -> JacketMonitor:
    return JacketMonitor(
        blind_s=p[surface.BLIND_S],
        rate_filter_s=p[hub.RATE_FILTER_S],
        rate_window_s=p[hub.RATE_WINDOW_S],
        rate_settle_s=p[hub.RATE_SETTLE_S],
        open_output_percent=p[hub.OPEN_OUTPUT_PERCENT],
        open_below_k=p[hub.OPEN_BELOW_K],
        open_rise_k=p[hub.OPEN_RISE_K],
    )
