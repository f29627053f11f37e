"""Manual mode of this machine: its axes, the size of a step, and the reasons for refusing one."""

from __future__ import annotations

from math import isfinite, nan
from typing import Final

from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.procedures.motions import TakeTrackTare, still_m_s
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.hand import Hand

STEPS: Final = 10.0
"""Number of steps from standstill to the greatest speed."""
CHAMBER_STEP_K: Final = 1.0


class TrackHand(Hand):
    """Turns a person's steps into demands."""

    def __init__(self, rig: TrackConfig) -> None:
        """Begin at rest, raised, with the chamber off."""
        super().__init__()
        self.rig = rig
        self.track_m_s = 0.0
        self.lowered = False
        self.chamber_c = nan

    def demand(self, ctx: TrackContext) -> None:
        """Write the demand of the steps so far."""
        demand = ctx.demand
        demand.track_m_s, demand.lowered, demand.chamber_c = self.track_m_s, self.lowered, self.chamber_c

    def zero(self, ctx: TrackContext) -> str:
        """Return the zero of the force."""
        return f"{ctx.devices.cell.tare[0]:.2f} N"

    def tare(self, ctx: TrackContext) -> str:
        """Begin a tare; return "", or the reason for refusing."""
        if self.lowered or not ctx.readings.raised:
            return "the arm is not raised"
        if self.track_m_s or abs(ctx.readings.track_now_m_s) > still_m_s(ctx):
            return "the track moves: stop it first"
        self.taring = TakeTrackTare("repeat")
        return ""

    def step(self, ctx: TrackContext, axis: str, sign: float) -> str:
        """Take one step of an axis; return "", or the reason for refusing."""
        limits = self.rig.limits
        if axis == "track":
            if self.lowered or not ctx.readings.raised:
                return "the track moves by hand only with the arm raised"
            most = limits.track_speed_m_s
            self.track_m_s = round(min(max(self.track_m_s + sign * most / STEPS, -most), most), 9)
        elif axis == "arm":
            if self.rig.axes.lift is None:
                return "this arm has no drive: move it with your hand"
            if self.track_m_s or abs(ctx.readings.track_now_m_s) > still_m_s(ctx):
                return "the track moves: stop it first"
            self.lowered = sign < 0.0
        elif axis == "chamber":
            if not self.rig.chamber:
                return "this rig has no chamber"
            from_c = self.chamber_c if isfinite(self.chamber_c) else float(round(ctx.readings.air_c))
            self.chamber_c = min(max(from_c + sign * CHAMBER_STEP_K, limits.air_low_c), limits.air_high_c)
        return ""
