"""What the interlocks' levels may look at in one scan, and what several of them ask for."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, sqrt
from typing import Final

from tester.control.load_loop import UNLOADED_N
from tester.control.monitors import RAMP_SHARE, JacketMonitor, PressTracker, SpeedTracker, SurfaceMonitor
from tester.control.observer import ThermalObserver
from tester.control.state import ControlState, Mode
from tester.control.thresholds import Thresholds, thresholds_of
from tester.process import Demand, Press, Readings
from tester.rig import RigConfig

_INF: Final = inf
STANDING_M_S: Final = 0.02
"""Below this a drive counts as standing [A]."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_LOAD: Final = Press.LOAD
_RUN: Final = Mode.RUN
_HOLD: Final = Mode.HOLD
_COOLDOWN: Final = Mode.COOLDOWN
_IDLE: Final = Mode.IDLE
_ARMED: Final = Mode.ARMED
_LATCHED: Final = Mode.LATCHED


@dataclass(slots=True)
class View:
    """One object serves every scan: ``look`` brings it up to date."""

    state: ControlState
    rig: RigConfig
    bounds: Thresholds = field(init=False)
    readings: Readings = field(init=False)
    demand: Demand = field(init=False)
    observer: ThermalObserver = field(init=False)
    jacket: JacketMonitor = field(default_factory=JacketMonitor)
    surface: SurfaceMonitor = field(default_factory=SurfaceMonitor)
    wheel: SpeedTracker = field(init=False)
    belt: SpeedTracker = field(init=False)
    press: PressTracker = field(init=False)
    scan_s: float = 0.0
    """Period of the scan, s."""
    pressing: bool = False
    """Contact is wanted."""
    loaded: bool = True
    """Contact is wanted or cannot be excluded."""
    turning: bool = False
    """The wheel is confirmed turning."""
    confirmed: bool = False
    """Every drive has been in operation since they were last wanted to be."""
    least_n: float = inf
    """The least force since contact was last wanted: what is lifting does not get firmer."""
    contact_mm: float = inf
    """Where the press touches the wheel: as it was touched last, less its wear since, or as its diameter says."""
    friction_n: float = 0.0
    friction_w: float = 0.0
    """Resultant friction force and its power (NaN where a part is unknown); 0 while unloaded."""
    stopped_s: float = -inf
    """How long a stop has been under way; -inf while none is."""
    lifting_s: float = -inf
    """How long a stop or a hold has been lifting; -inf while neither is."""
    resting: bool = True
    """Everything is to rest: idle, armed or latched."""
    unpowered: bool = False
    """A run that wants no drives has seen them without power: until all are in operation again, nothing may move."""
    rest_mm: float = inf
    """How far back the press has been since then."""
    attended: bool = False
    """A person was asked to come near; what hands do to sensors is nobody's fault."""
    wheel_most_m_s: float = field(init=False)
    belt_most_m_s: float = field(init=False)
    """Overspeed begins here."""

    def __post_init__(self) -> None:
        """Keep the parts of the rig file that levels compare with."""
        rig = self.rig
        self.bounds = thresholds_of(rig)
        limits, bounds = rig.limits, rig.interlocks
        self.observer = ThermalObserver(rig)
        radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
        self.wheel = SpeedTracker(RAMP_SHARE * rig.axes.wheel.acceleration * radius_m)
        self.belt = SpeedTracker(RAMP_SHARE * rig.axes.belt.acceleration)
        self.press = PressTracker(RAMP_SHARE * rig.axes.press.acceleration)
        self.wheel_most_m_s = limits.wheel_speed_m_s * (1.0 + bounds.overspeed_share)
        self.belt_most_m_s = limits.belt_speed_m_s * (1.0 + bounds.overspeed_share)

    def look(self, demand: Demand, readings: Readings, scan_s: float, dt: float) -> None:
        """Take this scan's demand and readings, and work out what several levels ask for."""
        self.readings = r = readings
        self.demand = demand
        self.scan_s = scan_s
        state = self.state
        self.pressing = pressing = demand.press is _LOAD
        self.loaded = loaded = pressing or not (r.force_z_n < UNLOADED_N)
        if pressing:
            self.least_n = inf
            contact_mm = state.load.worn_to_mm(r.diameter_mm)
            if not -_INF < contact_mm < _INF:
                contact_mm = self.rig.geometry.touch_mm + 0.5 * (self.rig.geometry.wheel_diameter_mm - r.diameter_mm)
            self.contact_mm = contact_mm
        elif r.force_z_n < self.least_n:
            self.least_n = r.force_z_n
        wheel_m_s = r.wheel_speed_m_s
        self.turning = wheel_m_s > STANDING_M_S or wheel_m_s < -STANDING_M_S
        mode = state.mode
        self.stopped_s = self.lifting_s = r.now_s - state.stop.began_s
        if mode is _HOLD:
            self.lifting_s = r.now_s - state.mode_since_s
        self.resting = mode is _IDLE or mode is _LATCHED or mode is _ARMED
        self._follow_speeds(demand, r, dt)
        self._note_rest(demand, r)
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
            observer.step(r.now_s, r.hub_c if r.jacket_valid else self.jacket.hub_c, wheel_m_s, r.surface_c)
        if r.jacket_at_s > self.jacket.stamp_s:
            out = state.setpoints
            self.jacket.update(r, out.heat, out.hub_c, self.bounds)
        if r.surface_at_s > self.surface.stamp_s:
            self.surface.update(r, observer.surface_c)

    def _follow_speeds(self, demand: Demand, r: Readings, dt: float) -> None:
        """Bring the speed trackers up to date while the drives are in operation and something commands them.

        A stop has limits of its own: its ramps are steeper, and it says itself what has not come to its end.
        """
        mode = self.state.mode
        if not demand.enabled or not (mode is _RUN or mode is _HOLD or mode is _COOLDOWN):
            self.confirmed = False
            return
        if not self.confirmed:
            if not r.drives_enabled:
                return
            self.confirmed = True
            self.wheel.begin(r.wheel_speed_m_s)
            self.belt.begin(r.belt_speed_m_s)
            self.press.begin(r)
        out = self.state.setpoints
        self.wheel.follow(out.wheel_rad_s * r.diameter_mm * 0.5e-3, dt)
        self.belt.follow(out.belt_m_s, dt)
        self.press.follow(out.press_mm_s, dt, r)

    def _note_rest(self, demand: Demand, r: Readings) -> None:
        """Note when a run has its drives off, and where the press stood at most since."""
        mode = self.state.mode
        if self.confirmed or not (mode is _RUN or mode is _HOLD):
            self.unpowered = False
        elif self.unpowered or (not demand.enabled and r.drives_disabled):
            if not self.unpowered or r.press_mm < self.rest_mm:
                self.rest_mm = r.press_mm
            self.unpowered = True

    def wheel_changed(self, now: float) -> None:
        """Begin anew with a wheel at ambient temperature: nothing is compared with the one before."""
        self.observer.new_wheel()
        self._forget_readings(now)

    def _forget_readings(self, now: float) -> None:
        """Compare no temperature with the one before."""
        self.surface.forget(now)
        self.jacket.forget(now)
