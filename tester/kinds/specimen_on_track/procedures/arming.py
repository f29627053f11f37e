"""The checks and proofs of this machine before a run may begin.

Homing raises an arm that has a drive. Before the track creeps, the load cell must show no force without a tare, and it
is watched while the track creeps: an arm that a person has left down would load it.
"""

from __future__ import annotations

from math import nan

from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.connect import Arming, Lifting
from tester.machine.proof import WatchdogProof

BUMP_S = 0.6
"""Time after which ramp and lag are over, s [A]."""
BUMP_SHARE = 0.3
"""Greatest deviation of a speed that follows its target, as a share of the target [A]."""
SILENT_S = 1.0
"""Longest time without a valid reading of the cell, s [A]: it is read in every tick."""


class TrackUnloaded(Lifting):
    """Waits for a valid reading of the cell, then watches that its readings stay valid and without force."""

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Move nothing: homing raises the arm."""
        self.devices, self.rig = devices, rig
        self.since_s = nan
        self.done = False
        self.raised = False
        """Whether the arm is raised: the cell must then show no force."""

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""
        if self.since_s != self.since_s:
            self.since_s = now
        if self.devices.cell.valid:
            self.done = True
        elif now - self.since_s > SILENT_S:
            self.failure = f"the load cell gave no valid reading for {SILENT_S:g} s"

    def trouble(self, now: float) -> str:
        """Return "", or the reason why the rig may be loaded."""
        cell = self.devices.cell
        if self.done and not (cell.valid and now - cell.stamp_s <= SILENT_S):
            return "load cell silent: whether the specimen touches is unknown"
        return loaded(cell.raw[0], self.rig) if self.raised else ""


def loaded(force_n: float, rig: TrackConfig) -> str:
    """Return "", or the force on a cell that should show none; ``force_n``: without tare."""
    most_n = rig.arming.unloaded_n
    if abs(force_n) <= most_n:
        return ""
    return (
        f"the load cell shows {force_n:.1f} N without tare, unloaded it is {most_n:g} N at most (arming.unloaded):"
        " is the arm down, or its zero wrong?"
    )


class TrackProof(WatchdogProof):
    """Proves that the track follows at creep speed, and that every drive stops without our heartbeat."""

    unloaded = ("no force on the load cell",)

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Move nothing before the first ``step``."""
        arming = rig.arming
        super().__init__(devices, follow=arming.bump_test, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
        self.track, self.places = devices.track, rig.linear
        self.creep = arming.creep_m_s / rig.metres
        self.seen: tuple[float, float] = (nan, nan)
        self.speed = nan
        self.middle = 0.5 * (rig.limits.travel_low_mm + rig.limits.travel_high_mm)

    def step(self, now: float) -> None:
        """Advance by one scan; with position feedback the speed is taken from one scan to the next."""
        track = self.track
        if not self.places:
            self.speed = track.actual
        elif track.stamp_s > self.seen[0] or self.seen[0] != self.seen[0]:
            self.speed = (track.actual - self.seen[1]) / (track.stamp_s - self.seen[0])
            self.seen = track.stamp_s, track.actual
        super().step(now)

    def still(self) -> bool:
        """Return whether the track is at rest."""
        return abs(self.speed) < 0.1 * self.creep

    def begin(self, now: float) -> None:
        """Start creeping, away from the nearer end of the travel."""
        self.track.target = self.creep if not self.places or self.track.actual < self.middle else -self.creep

    def move(self, now: float, elapsed: float) -> bool:
        """Check that the track follows."""
        if elapsed < BUMP_S:
            return False
        if self.follow and not abs(self.speed - self.track.target) <= BUMP_SHARE * self.creep:
            unit = self.track.config.unit
            self.failure = f"the track goes at {self.speed:.3f} {unit}, asked for {self.track.target:g} {unit}"
        return True


class TrackArming(Arming[TrackDevices, TrackConfig]):
    """Watches the cell, homes the arm upwards, then creeps. The chamber stays in standby."""

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Send nothing."""
        super().__init__(devices, rig)
        self._lifting: TrackUnloaded | None = None

    def at_rest(self) -> str:
        """Return the force on the cell of an arm that should be raised."""
        return loaded(self.devices.cell.raw[0], self.rig)

    def lift(self) -> TrackUnloaded:
        """Begin to watch the load cell."""
        self._lifting = TrackUnloaded(self.devices, self.rig)
        return self._lifting

    def prove(self) -> TrackProof:
        """Begin the proof of the drives: the arm is raised."""
        if self._lifting is not None:
            self._lifting.raised = True
        return TrackProof(self.devices, self.rig)
