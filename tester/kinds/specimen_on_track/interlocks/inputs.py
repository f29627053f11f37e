"""The inputs of this machine's interlock conditions, updated once a scan, and the test for standstill.

Old or unknown data do not count as standing. Several rows test for standstill and share its parameters.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from math import inf
from typing import Final, TypeAlias

from tester.inputs.rig.parameter import SHARE, Parameter
from tester.kinds.specimen_on_track.process import TrackDemand, TrackReadings, TrackSetpoints
from tester.machine.inputs import ScanInputs
from tester.machine.row import Interlock

WINDOW_S = 1.0
"""Time over which the track's way is compared with its commands, s [A]: 1000 increments at 1 um/s."""
LAG_S = 0.15
"""Time by which the way may lag behind a change of its command, s [A]: two slow scans and the drive's ramp loop."""


@dataclass(slots=True)
class TrackLimits:
    """Limits besides the conditions' own parameters, from the rig file's other sections."""

    heartbeat_s: float
    force_n: float
    track_m_s: float
    fastest_m_s: float
    """``axes.track.max_speed``; the speed limits of standstill and of least motion are shares of it."""
    deceleration_m_s2: float
    quick_stop_m_s2: float
    low_mm: float
    high_mm: float
    """Range of a linear track's place; infinite on a disc."""
    air_low_c: float
    air_high_c: float
    chamber: bool
    air: bool
    exit: bool
    height: bool
    """The rig has a chamber, a sensor of the air, a pyrometer, a sensor of the arm's height."""


class WayMonitor:
    """Deviation of the track's way from its commands in the last second."""

    def __init__(self, ramp_m_s2: float) -> None:
        """``ramp_m_s2``: the drive's acceleration."""
        self.ramp_m_s2 = ramp_m_s2
        self.begin(0.0)

    def begin(self, speed_m_s: float) -> None:
        """Restart with a track at this speed."""
        self.speed_m_s = speed_m_s
        self.expected_m = 0.0
        self.changed_m_s = 0.0
        """Change of the command that the track has not followed yet."""
        self.until_s = -inf
        self.seen: deque[tuple[float, float, float]] = deque()
        self.off_m = 0.0
        """Way in the window less the commanded way."""
        self.due_m = 0.0
        """Commanded way in the window, with its sign."""

    def follow(self, now: float, way_m: float, command_m_s: float, dt: float) -> None:
        """Process a scan: its command, and the way at its end."""
        speed, most = self.speed_m_s, self.ramp_m_s2 * dt
        step = command_m_s - speed
        if step != 0.0:
            self.changed_m_s = max(self.changed_m_s, abs(step))
            self.until_s = now + LAG_S
        elif self.changed_m_s and now >= self.until_s:
            self.changed_m_s = 0.0
            self.seen.clear()  # a lag is no deviation: restart the window
        self.speed_m_s = speed + (step if -most <= step <= most else most if step > 0.0 else -most)
        self.expected_m += 0.5 * (speed + self.speed_m_s) * dt
        seen = self.seen
        seen.append((now, way_m, self.expected_m))
        while len(seen) > 2 and seen[1][0] <= now - WINDOW_S:
            seen.popleft()
        _, way0_m, expected0_m = seen[0]
        self.due_m = self.expected_m - expected0_m
        self.off_m = way_m - way0_m - self.due_m

    def allowed_m(self, share: float, floor_m_s: float) -> float:
        """Return the allowed deviation of the way, m."""
        return share * abs(self.due_m) + floor_m_s * WINDOW_S + LAG_S * self.changed_m_s


@dataclass(slots=True)
class TrackStopStart:
    """Speed of the track at the start of a stop, and of its quick stop; an unknown speed counts as the greatest."""

    speed_m_s: float = 0.0
    fast_speed_m_s: float = 0.0
    ramp_until_s: float = -inf
    """Time until which the ramp from the last commanded speed lasts."""


@dataclass(slots=True)
class TrackInputs(ScanInputs):
    """The inputs of the conditions in one scan."""

    limits: TrackLimits = field(init=False)
    readings: TrackReadings = field(init=False)
    demand: TrackDemand = field(init=False)
    setpoints: TrackSetpoints = field(init=False)
    """Commands of the previous scan."""
    track: WayMonitor = field(init=False)
    stop_start: TrackStopStart = field(default_factory=TrackStopStart)
    arm_since_s: float = inf
    """Time at which the arm left its commanded place; infinite while it is there."""
    arrived_c: float = inf
    """The chamber's setpoint that its air has reached; infinite before that."""
    chamber_mean_percent: float = 0.0
    """Output of the chamber, filtered over ``OUTPUT_S``."""
    full_c: float = inf
    """The air's reading since which no output has moved it; infinite in standby."""
    settle_s: float = 0.0
    """Time left after a move until the filtered output is that of the air as it is."""
    usual_percent: float = 0.0
    """The output that keeps the air there."""
    full_s: float = 0.0
    excess_s: float = 0.0
    unanswered_s: float = 0.0
    """Since then: time at full output, output beyond the usual one as time at full output, and the greater of both."""
    off_since_s: float = inf
    """Time since which the chamber, commanded to standby, has given output; infinite while it gives none."""

    def seldom(self) -> tuple[object, ...] | None:
        r = self.readings
        return (
            r.safety_chain, r.guard_closed, r.bus_fault, r.drive_fault, r.foreign_master, r.device_fault, r.line_errors,
            r.drives_enabled, self.demand.enabled, self.confirmed,
        )  # fmt: skip


Row: TypeAlias = Interlock[TrackInputs]


STANDING_SHARE: Final = Parameter(
    "standing_share", "1", "0.0005", "a track slower than this share of axes.track.max_speed is at rest [A]", SHARE,
    hardest="0.001", because="a thousandth of the greatest speed counts as motion where everything must stand",
)  # fmt: skip
SPEEDS_OLD_S: Final = Parameter(
    "speeds_old_s", "s", "500 ms", "a stop does not end on a speed older than this [A]",
    hardest="1 s",
    because="the next step of a stop that does not work begins half a second after it: by then it must be known",
)  # fmt: skip


def standing_m_s(v: TrackInputs) -> float:
    """Return the speed below which the track counts as standing, m/s."""
    return v.parameters[STANDING_SHARE] * v.limits.fastest_m_s


def standing(v: TrackInputs) -> bool:
    """Return whether the track is known to stand."""
    r, slow = v.readings, standing_m_s(v)
    return r.track_at_s >= r.now_s - v.parameters[SPEEDS_OLD_S] and -slow < r.track_now_m_s < slow
