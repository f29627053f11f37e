"""Monitors of several readings: rates, jumps, values that do not change, speeds on their ramps.

Each monitor is updated when new data has arrived, not in every scan; the interlocks compare its results in every scan.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, isfinite, nan

from tester.kinds.wheel_on_belt.image.process_image import Readings


@dataclass(slots=True)
class JacketMonitor:
    """The hub from poll to poll. Its limits are parameters of the rows in ``hub``."""

    blind_s: float
    rate_filter_s: float
    rate_window_s: float
    rate_settle_s: float
    open_output_percent: float
    open_below_k: float
    open_rise_k: float
    stamp_s: float = -inf
    hub_c: float = nan
    """Last valid reading."""
    jump_k: float = 0.0
    """Difference of the last two valid readings."""
    filtered_c: float = nan
    rate_k_s: float = 0.0
    marks: tuple[float, float, float, float] = (nan, nan, nan, nan)
    """(time, filtered hub) at the last two ends of a window, older first."""
    off_since_s: float = inf
    """Time since which no heat has been commanded, or the output has been zero."""
    coolest_c: float = -inf
    """The coolest valid reading since the last output, and since the rubber was last hotter; -inf while there is
    output."""
    weak_since_s: float = inf
    """Time since which the output has been high with the hub well below its setpoint."""
    weak_from_c: float = nan
    rise_k: float = 0.0
    blind_until_s: float = -inf

    def forget(self, now: float) -> None:
        """Drop earlier readings: a person was at the wheel and its hub."""
        self.filtered_c = nan
        self.jump_k = 0.0
        self.coolest_c = -inf
        self.blind_until_s = now + self.blind_s

    def update(self, r: Readings, heat: bool, setpoint_c: float) -> None:
        """Process a new reading; ``heat`` and ``setpoint_c`` (degC) are the commands."""
        stamp = r.jacket_at_s
        dt, self.stamp_s = stamp - self.stamp_s, stamp
        if not heat or r.heat_percent <= 0.0:
            self.off_since_s = min(self.off_since_s, stamp)
        else:
            self.off_since_s = inf
        if not r.jacket_valid:
            return
        hub = r.hub_c
        known = isfinite(self.hub_c) and stamp > self.blind_until_s
        self.jump_k = abs(hub - self.hub_c) if known else 0.0
        self.hub_c = hub
        if not r.heat_percent <= 0.0:
            self.coolest_c = -inf
        elif self.coolest_c == -inf or hub < self.coolest_c or (r.surface_valid and r.surface_c > hub):
            # Hotter rubber warms the hub, which then cools more slowly than the rubber does.
            self.coolest_c = hub
        self._follow_rate(stamp, hub, dt)
        self._watch_line(r, heat, setpoint_c)

    def _follow_rate(self, stamp: float, hub_c: float, dt: float) -> None:
        if isfinite(self.filtered_c) and 0.0 < dt < 10.0:
            self.filtered_c += (hub_c - self.filtered_c) * dt / (self.rate_filter_s + dt)
        else:
            self.filtered_c = hub_c
            self.marks = (stamp, hub_c, stamp, hub_c)
        if not stamp - self.off_since_s >= self.rate_settle_s:
            self.marks = (stamp, self.filtered_c, stamp, self.filtered_c)
            self.rate_k_s = 0.0
            return
        old_s, old_c, new_s, new_c = self.marks
        if stamp - new_s >= self.rate_window_s:
            self.marks = old_s, old_c, new_s, new_c = (new_s, new_c, stamp, self.filtered_c)
        if stamp - old_s >= self.rate_window_s:
            self.rate_k_s = (self.filtered_c - old_c) / (stamp - old_s)

    def _watch_line(self, r: Readings, heat: bool, setpoint_c: float) -> None:
        """Measure the rise while the output is high: a heater with an open line makes no rise."""
        weak = heat and r.heat_percent >= self.open_output_percent and r.hub_c < setpoint_c - self.open_below_k
        if not weak:
            self.weak_since_s = inf
            self.rise_k = 0.0
            return
        rise = r.hub_c - self.weak_from_c
        if self.weak_since_s == inf or rise >= self.open_rise_k:
            self.weak_since_s, self.weak_from_c = self.stamp_s, r.hub_c
            rise = 0.0
        self.rise_k = rise


@dataclass(slots=True)
class SurfaceMonitor:
    """The thermometer from poll to poll."""

    blind_s: float
    stamp_s: float = -inf
    surface_c: float = nan
    jump_k: float = 0.0
    model_c: float = nan
    """The model when the thermometer's reading last changed."""
    changed_s: float = -inf
    blind_until_s: float = -inf

    def forget(self, now: float) -> None:
        """Drop earlier readings: another wheel is in front of the thermometer."""
        self.jump_k = 0.0
        self.blind_until_s = now + self.blind_s

    def update(self, r: Readings, model_c: float) -> None:
        """Process a new reading; ``model_c``: the observer's value for it."""
        self.stamp_s = r.surface_at_s
        if r.surface_changed_s > self.changed_s or not isfinite(self.model_c):
            self.changed_s = r.surface_changed_s
            self.model_c = model_c
        if not r.surface_valid:
            return
        known = isfinite(self.surface_c) and self.stamp_s > self.blind_until_s
        self.jump_k = abs(r.surface_c - self.surface_c) if known else 0.0
        self.surface_c = r.surface_c


@dataclass(slots=True)
class PressTracker:
    """The press's travel towards the contact beyond its commands."""

    ramp_mm_s2: float
    """Deceleration of a slow ramp."""
    high_mm_s: float = 0.0
    """Greatest speed towards the contact that is still allowed."""
    at_s: float = -inf
    press_mm: float = nan
    ahead_mm: float = 0.0

    def begin(self, r: Readings) -> None:
        """Begin at the press's position."""
        self.high_mm_s = self.ahead_mm = 0.0
        self.at_s, self.press_mm = r.press_at_s, r.press_mm

    def follow(self, target_mm_s: float, dt: float, r: Readings) -> None:
        """Process a target that lasted ``dt`` s, and a new position if there is one."""
        high = self.high_mm_s - self.ramp_mm_s2 * dt
        if not high > target_mm_s:
            high = target_mm_s
        self.high_mm_s = high = high if high > 0.0 else 0.0
        at_s = r.press_at_s
        if at_s > self.at_s:
            press_mm = r.press_mm
            ahead = self.ahead_mm + press_mm - self.press_mm - high * (at_s - self.at_s)
            self.ahead_mm = 0.0 if ahead < 0.0 else ahead
            self.at_s, self.press_mm = at_s, press_mm


FREE_MM = 1.0
"""The press is free this far off the contact, mm [A]: twice what a hot wheel grows."""
UNDER_WAY_MM = 0.2
"""Travel one way after which the screw's friction acts that way, mm [A]: ten times its presliding."""
MOVES_MM = 0.002
"""Travel between two readings that counts as motion, mm [A]: two increments."""
LEAST_READINGS = 3
"""Readings of a way that make a torque [A]."""


@dataclass(slots=True)
class FreeTravel:
    """The torque of the press's drive in free travel: half the sum of both ways is what the lifting spring takes.

    The friction of the screw cancels. A spring shares nothing with any sensor: it shows whether the torque is right.
    """

    spring_nm: float
    """Torque that the spring takes without friction, with the press at 0 mm; 0 without a spring."""
    rate_nm_per_mm: float
    """More of it per mm of travel."""
    digit_nm: float
    """Half the last digit of the drive's torque."""
    off_share: float = 0.0
    """How far the half sum is off the spring's torque beyond a digit, a share of it; 0 until both ways are known."""
    at_s: float = -inf
    down_nm: float = nan
    """Mean torque of the last way down, and of the last way up, less what the rate makes of the places."""
    up_nm: float = nan
    _down: bool = False
    _up: bool = False
    _press_mm: float = nan
    _way_mm: float = 0.0
    """Travel since it last turned round, positive towards the contact."""
    _mean_nm: float = 0.0
    _count: int = 0

    def begin(self, r: Readings) -> None:
        """Begin a way at the press's position: the drive was off, and the press may have moved without it."""
        self.at_s, self._press_mm = r.press_at_s, r.press_mm
        self._way_mm = 0.0
        self._count = 0

    def update(self, r: Readings, free: bool) -> None:
        """Process a new position and torque; ``free``: the press is clear of the contact."""
        moved_mm = r.press_mm - self._press_mm
        self.at_s, self._press_mm = r.press_at_s, r.press_mm
        if not free or moved_mm * self._way_mm < 0.0:
            self._way_mm = 0.0
            self._count = 0
        if not free or not abs(moved_mm) >= MOVES_MM:
            return
        self._way_mm += moved_mm
        if abs(self._way_mm) < UNDER_WAY_MM:
            return
        self._count += 1
        before_nm = self._mean_nm if self._count > 1 else 0.0
        grown_nm = self.rate_nm_per_mm * r.press_mm
        self._mean_nm = mean = before_nm + (r.press_torque_nm - grown_nm - before_nm) / self._count
        if self._count < LEAST_READINGS:
            return
        if self._way_mm > 0.0:
            self.down_nm, self._down = mean, True
        else:
            self.up_nm, self._up = mean, True
        if not (self._down and self._up):
            return
        off_nm = abs(0.5 * (self.down_nm + self.up_nm) - self.spring_nm) - self.digit_nm
        self.off_share = 0.0 if off_nm < 0.0 else off_nm / (self.spring_nm + grown_nm)


@dataclass(slots=True)
class SpeedTracker:
    """The allowed range of a drive's speed: from its target to the present speed of a slow ramp to the target."""

    ramp_m_s2: float
    """Acceleration of the slow ramp."""
    low_m_s: float = 0.0
    high_m_s: float = 0.0

    def begin(self, actual_m_s: float) -> None:
        """Begin at an actual speed."""
        self.low_m_s = min(0.0, actual_m_s)
        self.high_m_s = max(0.0, actual_m_s)

    def follow(self, target_m_s: float, dt: float) -> None:
        """Move both ends towards a target, for ``dt`` s."""
        high, low = self.high_m_s - self.ramp_m_s2 * dt, self.low_m_s + self.ramp_m_s2 * dt
        self.high_m_s = target_m_s if target_m_s > high else high
        self.low_m_s = target_m_s if target_m_s < low else low
