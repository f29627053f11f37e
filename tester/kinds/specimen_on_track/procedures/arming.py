"""What this machine asks of its devices, and shows, before a run may begin.

An arm with a drive is raised by homing it; before the track creeps the load cell, asked without tare, has to be without
force, and it is watched while the track creeps: an arm that a person has left down would draw on it.
"""

from __future__ import annotations

from math import nan

from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.connect import Arming
from tester.machine.proof import WatchdogProof

BUMP_S = 0.6
"""Ramp and lag are over by then [A]."""
BUMP_SHARE = 0.3
"""A speed within this share of its target follows [A]."""
SILENT_S = 1.0
"""The cell is read with every tick: one that gives no valid reading for this long will not [A]."""


class TrackUnloaded:
    """Asks the cell for a valid reading, and from then on watches that it goes on giving them without a force."""

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Nothing moves: homing raises the arm."""
        self.devices, self.rig = devices, rig
        self.failure = ""
        self.since_s = nan
        self.done = False
        self.raised = False
        """The arm is raised: no force may be on the cell from now on."""

    def step(self, now: float) -> None:
        """Advance by one scan at ``now`` s."""
        if self.since_s != self.since_s:
            self.since_s = now
        if self.devices.cell.valid:
            self.done = True
        elif now - self.since_s > SILENT_S:
            self.failure = f"the load cell gave no valid reading for {SILENT_S:g} s"

    def trouble(self, now: float) -> str:
        """Return "" or why the rig is not known to be unloaded."""
        cell = self.devices.cell
        if self.done and not (cell.valid and now - cell.stamp_s <= SILENT_S):
            return "load cell silent: nobody sees whether the specimen touches"
        if not self.raised:
            return ""
        force_n, most_n = cell.raw[0], self.rig.arming.unloaded_n
        if abs(force_n) <= most_n:
            return ""
        return (
            f"the load cell shows {force_n:.1f} N without tare, unloaded it is {most_n:g} N at most (arming.unloaded):"
            " is the arm down, or its zero wrong?"
        )

    def stop(self) -> None:
        """Do nothing: nothing was moved."""


class TrackProof(WatchdogProof):
    """The track creeps, its speed is looked at, and every drive stops without our heartbeat."""

    unloaded = ("no force on the load cell",)

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Nothing moves before the first ``step``."""
        arming = rig.arming
        super().__init__(devices, follow=arming.bump_test, watchdog=arming.watchdog_proof, withhold_s=arming.withhold_s)
        self.track, self.places = devices.track, rig.linear
        self.creep = arming.creep_m_s / rig.metres
        self.seen: tuple[float, float] = (nan, nan)
        self.speed = nan
        self.middle = 0.5 * (rig.limits.travel_low_mm + rig.limits.travel_high_mm)

    def step(self, now: float) -> None:
        """Advance by one scan; the speed of a track that tells its place is taken from one scan to the next."""
        track = self.track
        if not self.places:
            self.speed = track.actual
        elif track.stamp_s > self.seen[0] or self.seen[0] != self.seen[0]:
            self.speed = (track.actual - self.seen[1]) / (track.stamp_s - self.seen[0])
            self.seen = track.stamp_s, track.actual
        super().step(now)

    def stand(self) -> None:
        """Command zero to the track."""
        self.track.target = 0.0

    def still(self) -> bool:
        """Tell whether the track stands."""
        return abs(self.speed) < 0.1 * self.creep

    def begin(self, now: float) -> None:
        """Let the track creep, away from the nearer end of its travel."""
        self.track.target = self.creep if not self.places or self.track.actual < self.middle else -self.creep

    def move(self, now: float, elapsed: float) -> bool:
        """See that it follows."""
        if elapsed < BUMP_S:
            return False
        if self.follow and not abs(self.speed - self.track.target) <= BUMP_SHARE * self.creep:
            unit = self.track.config.unit
            self.failure = f"the track goes at {self.speed:.3f} {unit}, asked for {self.track.target:g} {unit}"
        return True


class TrackArming(Arming[TrackDevices, TrackConfig]):
    """Watches the cell, homes the arm upwards, lets the track creep. The chamber stays in standby."""

    def __init__(self, devices: TrackDevices, rig: TrackConfig) -> None:
        """Nothing is sent."""
        super().__init__(devices, rig)
        self._lifting: TrackUnloaded | None = None

    def lift(self) -> TrackUnloaded:
        """Ask the load cell."""
        self._lifting = TrackUnloaded(self.devices, self.rig)
        return self._lifting

    def prove(self) -> TrackProof:
        """Let the track creep: the arm is raised."""
        if self._lifting is not None:
            self._lifting.raised = True
        return TrackProof(self.devices, self.rig)
