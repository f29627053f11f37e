"""The context of this machine's steps: the specimen on the arm, weights, the cell's zero, the gates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan
from typing import ClassVar, Final, Protocol

from tester.base.quantities import Quantities
from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.process import TrackDemand, TrackReadings, TrackSetpoints
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.context import BaseContext
from tester.machine.plain.context import PlainAttendant
from tester.machine.prompts import Prompts
from tester.store.recorder import Recorder

GATES: Final = {"speed": 1, "temperature": 2, "contact": 8, "settling": 4}
"""Bits of the gates in the channel ``gate``, by name: set while the gate is closed."""
_SPEED, _TEMPERATURE, _CONTACT, _SETTLING = GATES.values()
SAMPLES = 40.0
"""A stretch is recorded with about this many samples, or with every scan where it is shorter [A]."""


class TrackAttendant(PlainAttendant, Protocol):
    """What a person does at the rig, in addition to mounting a specimen."""

    def keep(self, specimen: int, compound: str) -> None:
        """Keep the specimen of an interrupted run on the arm, or put it back."""
        ...

    def put_on(self, weights_n: float) -> None:
        """Hang weights on the arm, N."""
        ...

    def cover(self, surface: str) -> None:
        """Cover the track with a surface of this name, clean and dry."""
        ...

    def prepare(self, interface: str) -> None:
        """Dry, wet or powder the track."""
        ...

    def raise_arm(self) -> None:
        """Raise an arm that has no drive."""
        ...

    def lower_arm(self) -> None:
        """Lower an arm that has no drive."""
        ...


@dataclass(slots=True)
class TrackTarget:
    """The target values of the gates; the measuring activity writes them."""

    track_m_s: float = 0.0
    temperature_c: float = nan
    band_k: float = nan
    stretch_m: float = 0.0
    """Length of a stretch of the way; 0: stretches are not counted."""
    stationary: bool = False
    """Friction has become stationary since the track began to move in this direction."""


class TrackContext(BaseContext[TrackConfig, TrackReadings, TrackDemand]):
    """One per run; only activities read and write it."""

    gate_bits: ClassVar[Mapping[str, int]] = GATES

    def __init__(
        self,
        rig: TrackConfig,
        prompts: Prompts,
        journal: Recorder,
        attendant: TrackAttendant,
        devices: TrackDevices,
        quantities: Quantities = QUANTITIES,
    ) -> None:
        """``quantities``: the run's table of channels."""
        super().__init__(rig, TrackReadings(channels=[nan] * len(quantities.further)), TrackDemand(), prompts, journal)
        self.setpoints = TrackSetpoints()
        self.attendant = attendant
        self.devices = devices
        self.quantities = quantities
        self.weights_n = 0.0
        """Weights on the arm, N."""
        self.target = TrackTarget()
        self.recorded_s = float("-inf")
        self._way_m = 0.0
        self._from_m = 0.0
        self._way = 0.0
        track = rig.axes.track
        self._still_m_s = rig.interlocks.standing_share * track.max_speed * rig.metres

    def after_reading(self) -> None:
        """Derive values from the readings: friction against the motion, distance slid, load, stretches."""
        r, demand = self.readings, self.demand
        way = 1.0 if demand.track_m_s > 0.0 else -1.0 if demand.track_m_s < 0.0 else 0.0
        r.load_n = self.weights_n if r.lowered else 0.0
        r.friction_n = way * r.force_n if way else r.force_n
        r.sliding_m_s = way * r.track_m_s if way else r.track_m_s
        if way != self._way or not r.lowered:
            self._way, self._from_m = way, r.way_m
        demand.sliding_m = way * (r.way_m - self._from_m)
        if r.lowered:
            self.mounted.sliding_m += abs(r.way_m - self._way_m)
        self._way_m = r.way_m
        stretch_m = self.target.stretch_m
        r.stretch = r.way_m / stretch_m if stretch_m > 0.0 else 0.0

    def closed_gates(self) -> int:
        """Return the mask of the closed gates; NaN closes a gate."""
        r, target = self.readings, self.target
        mask = 0
        if not abs(r.track_m_s - target.track_m_s) <= 0.01 * self.rig.gates.speed_percent * abs(target.track_m_s):
            mask |= _SPEED
        if not (r.air_valid and abs(r.air_c - target.temperature_c) <= target.band_k):
            mask |= _TEMPERATURE
        if not target.stationary:
            mask |= _SETTLING
        if not (r.lowered and r.cell_valid):
            mask |= _CONTACT
        return mask

    def calm(self) -> tuple[float, ...]:
        r = self.readings
        if self.demand.lowered or not r.raised:
            return ()
        if self.demand.track_m_s != 0.0 or not abs(r.track_m_s) <= self._still_m_s:
            return ()
        return r.air_c, r.contact_c

    def touching(self) -> bool:
        """Return whether to record this scan: with the arm down, as often as a stretch needs."""
        if not self.readings.lowered:
            return False
        speed_m_s, stretch_m = abs(self.target.track_m_s), self.target.stretch_m
        if self.burst and speed_m_s > 0.0 and self.now - self.recorded_s < stretch_m / (SAMPLES * speed_m_s) - 1e-6:
            return False
        self.recorded_s = self.now
        return True
