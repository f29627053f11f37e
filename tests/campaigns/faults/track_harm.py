"""Harm, as the plant sees it: an observer of the true state, never of measurements or intentions.

All figures are [A].
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Final

from sim.machines.specimen_on_track.rig import TrackRig

OVERLOAD: Final = 1.0
"""A force beyond this share of the cell's range strains it."""
HOTTEST_C: Final = 110.0
COLDEST_C: Final = -60.0
"""Beyond these the chamber's air spoils specimen and cell; its own limiters act at 105 and -55 degC."""
STILL_SHARE: Final = 1e-3
"""A track slower than this share of its drive's greatest speed counts as standing."""
LIFT_MM: Final = 0.2
"""An arm that must stand has come down at most this far, mm."""
UNLOADED_N: Final = 0.5
GROUND_M: Final = 1.0
"""A bare holder has spoilt the track after this distance under load, m: half a second at 2 m/s."""


@dataclass(slots=True)
class TrackTruth:
    """The part of the rig's state that determines harm, in plain numbers."""

    load_n: float
    force_n: float
    track_m_s: float
    air_c: float

    @classmethod
    def of(cls, rig: TrackRig) -> TrackTruth:
        """Look at a rig."""
        plant = rig.plant
        return cls(plant.load_n, plant.force_n, rig.track_m_s, plant.air_c)

    def unsafe(self, still_m_s: float) -> list[str]:
        """Return what the safe state lacks: the track must stand; empty when the rig is safe.

        A load that rests on a standing track is safe: dead weights come off by hand, or with the lift once its drive
        has power again.
        """
        return [] if abs(self.track_m_s) < still_m_s else [f"track {self.track_m_s:.3g} m/s"]


@dataclass(slots=True)
class TrackHarmObserver:
    """Watches one rig. ``found`` names each harm once, with time and figure. Copied together with the rig.

    ``tared``: the cell has been tared and the load checked, so that the track may move with the arm lowered.
    """

    rig: TrackRig
    tared: bool = False
    found: dict[str, str] = field(default_factory=dict[str, str])
    most_n: float = 0.0
    """The greatest tangential force so far, N."""
    _lowest_mm: float = inf

    @property
    def still_m_s(self) -> float:
        """A track slower than this counts as standing, m/s."""
        track = self.rig.axes["track"]
        return STILL_SHARE * track.config.max_speed * (1e-3 if track.config.unit == "mm/s" else 1.0)

    def look(self, must_stand: bool) -> None:
        """Look at the rig as it is now; ``must_stand``: latched, idle or emergency stop, and time enough to rest."""
        rig, now, truth = self.rig, self.rig.now_s, TrackTruth.of(self.rig)
        force_n = abs(truth.force_n)
        self.most_n = max(self.most_n, force_n)
        most_n = OVERLOAD * rig.plant.parameters.sensors.force_range
        if force_n > most_n:
            self._note("force beyond the cell", f"{force_n:.0f} N at {now:.2f} s, at most {most_n:g} N")
        if rig.plant.parameters.enclosed and not COLDEST_C <= truth.air_c <= HOTTEST_C:
            limits = f"{COLDEST_C:g} to {HOTTEST_C:g} degC"
            self._note("chamber beyond its range", f"{truth.air_c:.0f} degC at {now:.2f} s, allowed {limits}")
        if rig.plant.ground_m > GROUND_M:
            self._note("holder grinds along the track", f"{rig.plant.ground_m:.2f} m at {now:.2f} s")
        if rig.hit_stop:
            self._note("end of travel hit", f"at {now:.2f} s")
        moves = abs(truth.track_m_s) >= self.still_m_s
        if moves and truth.load_n > UNLOADED_N and not self.tared:
            self._note("track moves under load before the tare", f"{truth.track_m_s:.3g} m/s at {now:.2f} s")
        if not must_stand:
            self._lowest_mm = inf
            return
        if moves:
            self._note("motion where everything must stand", f"track {truth.track_m_s:.3g} m/s at {now:.2f} s")
        if rig.lift_mm < self._lowest_mm - LIFT_MM and self._lowest_mm < inf:
            self._note("motion where everything must stand", f"arm down to {rig.lift_mm:.1f} mm at {now:.2f} s")
        self._lowest_mm = min(self._lowest_mm, rig.lift_mm) if self._lowest_mm < inf else rig.lift_mm

    def _note(self, name: str, text: str) -> None:
        self.found.setdefault(name, text)
