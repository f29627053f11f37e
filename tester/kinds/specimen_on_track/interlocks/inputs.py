"""The inputs of this machine's interlock conditions, updated once a scan, and when the track is known to stand.

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
"""Over this time the track's way is held against what its commands allow, s [A]: at 1 um/s it goes 1000 increments."""
LAG_S = 0.15
"""By this the way may lag behind a change of its command, s [A]: two slow scans and the drive's ramp loop."""


@dataclass(slots=True)
class TrackLimits:
    """What conditions compare with beside their own parameters: numbers from the rig file's other sections."""

    heartbeat_s: float
    force_n: float
    track_m_s: float
    fastest_m_s: float
    """``axes.track.max_speed``: what of the track counts as standing, and as its least speed, is a share of it."""
    deceleration_m_s2: float
    quick_stop_m_s2: float
    low_mm: float
    high_mm: float
    """Between these a linear track may be; infinite on a disc."""
    air_low_c: float
    air_high_c: float
    chamber: bool
    air: bool
    exit: bool
    """The rig has a chamber, a sensor of the air, a pyrometer."""


class WayMonitor:
    """How far the way that the track has gone in the last second is off what its commands allow."""

    def __init__(self, ramp_m_s2: float) -> None:
        """``ramp_m_s2``: the drive's acceleration."""
        self.ramp_m_s2 = ramp_m_s2
        self.begin(0.0)

    def begin(self, speed_m_s: float) -> None:
        """Begin anew with a track that has this speed."""
        self.speed_m_s = speed_m_s
        self.expected_m = 0.0
        self.changed_m_s = 0.0
        """By how much the command has changed, until the track has followed."""
        self.until_s = -inf
        self.seen: deque[tuple[float, float, float]] = deque()
        self.off_m = 0.0
        """Way in the window beyond what was commanded, less where it is short of it."""
        self.due_m = 0.0
        """Way that was commanded in the window, either way."""

    def follow(self, now: float, way_m: float, command_m_s: float, dt: float) -> None:
        """Take in a scan: the command that was in force in it, and the way at its end."""
        speed, most = self.speed_m_s, self.ramp_m_s2 * dt
        step = command_m_s - speed
        if step != 0.0:
            self.changed_m_s = max(self.changed_m_s, abs(step))
            self.until_s = now + LAG_S
        elif self.changed_m_s and now >= self.until_s:
            self.changed_m_s = 0.0
            self.seen.clear()  # what lagged is no deviation: the window begins anew
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
        """Return how far off the way may be."""
        return share * abs(self.due_m) + floor_m_s * WINDOW_S + LAG_S * self.changed_m_s


@dataclass(slots=True)
class TrackStopStart:
    """How fast the track was as a stop began, and as its quick stop did; what is not known counts as the most."""

    speed_m_s: float = 0.0
    fast_speed_m_s: float = 0.0


@dataclass(slots=True)
class TrackInputs(ScanInputs):
    """One scan, as conditions see it."""

    limits: TrackLimits = field(init=False)
    readings: TrackReadings = field(init=False)
    demand: TrackDemand = field(init=False)
    setpoints: TrackSetpoints = field(init=False)
    """What the scan before has commanded."""
    track: WayMonitor = field(init=False)
    stop_start: TrackStopStart = field(default_factory=TrackStopStart)
    arm_since_s: float = inf
    """Since when the arm has not been where it is told to be."""
    arrived_c: float = inf
    """The chamber's setpoint that its air has been at; infinite where it has not got there yet."""
    off_since_s: float = inf
    """Since when the chamber is to stand by and still gives output."""


Row: TypeAlias = Interlock[TrackInputs]


STANDING_SHARE: Final = Parameter(
    "standing_share", "1", "0.0005", "a track slower than this share of axes.track.max_speed stands [A]", SHARE,
    hardest="0.001", because="a thousandth of the greatest speed counts as motion where everything must stand",
)  # fmt: skip
SPEEDS_OLD_S: Final = Parameter(
    "speeds_old_s", "s", "500 ms", "a stop does not end on a speed older than this [A]",
    hardest="1 s",
    because="the next step of a stop that does not work begins half a second after it: by then it must be known",
)  # fmt: skip


def standing_m_s(v: TrackInputs) -> float:
    """Return the speed below which the track stands, m/s."""
    return v.parameters[STANDING_SHARE] * v.limits.fastest_m_s


def standing(v: TrackInputs) -> bool:
    """Tell whether the track is known to stand."""
    r, slow = v.readings, standing_m_s(v)
    return r.track_at_s >= r.now_s - v.parameters[SPEEDS_OLD_S] and -slow < r.track_now_m_s < slow
