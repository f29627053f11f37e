"""The commands of this machine in each mode, and their bounds. No I/O, no clock.

A stop brings the track to standstill and leaves the arm where it is: weights on a track at rest do no harm, and
the next connection raises the arm before anything else moves.
"""

from __future__ import annotations

from math import inf, isfinite

from tester.kinds.specimen_on_track.interlocks.chamber import CHAMBER_OFF_S
from tester.kinds.specimen_on_track.interlocks.force import STALE_CELL_DELAY_S, STALE_CELL_S
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs, TrackLimits, WayMonitor, standing
from tester.kinds.specimen_on_track.interlocks.stops import HOLD_AT_MOST_S, STOP_TIMEOUT_S
from tester.kinds.specimen_on_track.process import TrackDemand, TrackReadings, TrackSetpoints
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.mode_commands import bounded
from tester.machine.safety_inputs import table_on
from tester.machine.standstill import StandstillControl
from tester.machine.state import ControlState, Mode

ARRIVED_K = 2.0
"""The air has reached the chamber's setpoint within this difference, K [A]."""


OUTPUT_S = 30.0
"""Filter time of the chamber's output, s [A]: some chambers switch theirs on and off."""
FULL_PERCENT = 90.0
MOVED_K = 0.3
"""Output that counts as full, and a change of the air beyond the noise of its reading [A]."""
SETTLE_S = 6.0 * OUTPUT_S
USUAL_S = 600.0
"""Time in which an output becomes the usual one of an air that stays as it is, s [A]: walls take so long."""
LATE_S = 0.1
"""Longest time from the end of a row's delay to its trip, s: two slow scans."""


TrackState = ControlState[TrackSetpoints]


class TrackControl(StandstillControl[TrackState, TrackReadings, TrackDemand, TrackInputs]):
    """The control of a specimen on a track."""

    def __init__(self, rig: TrackConfig, most_m_s: float = inf) -> None:
        """``most_m_s``: greatest speed in the recipe; commands stay within it and the rig's own bound."""
        state, view = TrackState(TrackSetpoints(lift_mm=rig.arm.raised_mm)), TrackInputs()
        view.setpoints = state.setpoints
        view.limits = _limits(rig)
        view.track = WayMonitor(rig.axes.track.acceleration * rig.metres)
        super().__init__(rig, state, view, table_on(rig, rig.table), (TrackDemand(), TrackDemand()), HOLD_AT_MOST_S)
        p = view.parameters
        self.rig = rig
        self.bound_m_s = min(rig.limits.track_speed_m_s, most_m_s)
        self._cell_s = p[STALE_CELL_S] + p[STALE_CELL_DELAY_S]

    # -- the inputs of the rows -----------------------------------------------------------------------------

    def look(self, demand: TrackDemand, readings: TrackReadings, scan_s: float, dt: float) -> None:
        """Update the inputs of the rows from this scan's demand and readings."""
        view, r, state = self.view, readings, self.state
        view.readings, view.demand = r, demand
        view.note_times(state, r.now_s, scan_s)
        view.attended = demand.attended
        view.loaded = demand.lowered or not r.raised
        if view.note_drives(state.mode, demand, r):
            view.track.begin(0.0)
        if view.confirmed:
            view.track.follow(r.now_s, r.way_m, state.setpoints.track_m_s, dt)
        self._look_at_arm(view, r)
        self._look_at_chamber(view, r, dt)

    def _look_at_arm(self, view: TrackInputs, r: TrackReadings) -> None:
        off = view.confirmed and self.rig.axes.lift is not None
        off = off and not abs(r.lift_mm - self.state.setpoints.lift_mm) <= self.rig.arm.within_mm
        view.arm_since_s = min(view.arm_since_s, r.now_s) if off else inf

    def _look_at_chamber(self, view: TrackInputs, r: TrackReadings, dt: float) -> None:
        if not view.limits.chamber:
            return
        out = self.state.setpoints
        if not out.chamber:
            view.arrived_c = view.full_c = inf
            view.chamber_mean_percent = view.unanswered_s = 0.0
            view.off_since_s = min(view.off_since_s, r.now_s) if r.chamber_percent != 0.0 else inf
            return
        view.off_since_s = inf
        if r.chamber_percent == r.chamber_percent:
            view.chamber_mean_percent += (r.chamber_percent - view.chamber_mean_percent) * min(dt / OUTPUT_S, 1.0)
        self._look_at_answer(view, r, dt)
        if view.arrived_c != out.chamber_c:
            view.arrived_c = out.chamber_c if abs(r.air_c - out.chamber_c) <= ARRIVED_K else inf

    def _look_at_answer(self, view: TrackInputs, r: TrackReadings, dt: float) -> None:
        """Add up the output that has not moved the air: full output, or what is more than usual for this air."""
        percent = view.chamber_mean_percent
        full = not -FULL_PERCENT < percent < FULL_PERCENT
        if view.full_c == inf or abs(r.air_c - view.full_c) > MOVED_K:
            # The first output finds an air at rest: all of it counts.
            first = view.full_c == inf
            view.settle_s = 0.0 if first else SETTLE_S
            view.usual_percent = 0.0 if first else percent
            view.full_c, view.excess_s, view.full_s = r.air_c, 0.0, 0.0
        if view.settle_s > 0.0:
            # After a move the filtered output is still that of the move.
            view.settle_s -= dt
            view.usual_percent = percent
        view.excess_s += 0.01 * (percent - view.usual_percent) * dt
        view.usual_percent += (percent - view.usual_percent) * min(dt / USUAL_S, 1.0)
        view.full_s = view.full_s + dt if full else 0.0
        view.unanswered_s = max(view.full_s, abs(view.excess_s))

    def detail(self, readings: TrackReadings) -> str:
        """Return force, speed, place of the arm and temperature of the air."""
        r = readings
        return (
            f"force {r.force_n:.2f} N, track {1e3 * r.track_now_m_s:.4g} mm/s, arm {r.lift_mm:.1f} mm,"
            f" air {r.air_c:.1f} degC"
        )

    # -- RUN and HOLD ---------------------------------------------------------------------------------------

    def keep(self, held: TrackDemand, demand: TrackDemand) -> None:
        """Stop the track, then raise the arm; keep the air's temperature and the cell's zero."""
        held.track_m_s, held.lowered, held.sliding_m = 0.0, False, 0.0
        held.tared, held.chamber_c = demand.tared, demand.chamber_c

    def run_outputs(self, demand: TrackDemand, readings: TrackReadings, dt: float) -> None:
        """Command the demand of track, arm and chamber within the bounds."""
        out, r = self.state.setpoints, readings
        self.enable(demand, r)
        out.track_m_s = bounded(demand.track_m_s, self.bound_m_s) if self._may_go(demand, r) else 0.0
        if not r.drives_enabled:
            out.lift_mm = r.lift_mm if isfinite(r.lift_mm) else out.lift_mm
        elif standing(self.view) and out.track_m_s == 0.0:
            out.lift_mm = 0.0 if demand.lowered else self.rig.arm.raised_mm
        wanted = self.rig.chamber and -inf < demand.chamber_c < inf
        out.chamber = wanted and not out.chamber_silent
        if wanted:
            limits = self.rig.limits
            out.chamber_c = min(max(demand.chamber_c, limits.air_low_c), limits.air_high_c)

    def _may_go(self, demand: TrackDemand, r: TrackReadings) -> bool:
        """Return whether the track may move: arm in place, force known, end of the travel not reached."""
        if demand.track_m_s == 0.0 or not r.drives_enabled:
            return False
        placed = (r.lowered and demand.tared) if demand.lowered else r.raised
        if not placed or (demand.lowered and not (r.cell_valid and r.now_s - r.cell_at_s <= self._cell_s)):
            return False
        if not self.rig.linear:
            return True
        limits = self.rig.limits
        return r.track_mm < limits.travel_high_mm if demand.track_m_s > 0.0 else r.track_mm > limits.travel_low_mm

    # -- stops ----------------------------------------------------------------------------------------------

    def stand(self) -> None:
        """Command zero to the track and standby to the chamber; the arm stays where it is."""
        out = self.state.setpoints
        out.track_m_s, out.chamber = 0.0, False

    def withdraw_escalation(self) -> None:
        """Resume heartbeats to the drives and setpoints to the chamber."""
        super().withdraw_escalation()
        self.state.setpoints.chamber_silent = False

    def end_lease(self, readings: TrackReadings) -> None:
        """Stop renewing the chamber's setpoint: its lease ends its output."""
        self.state.setpoints.chamber_silent = True

    def note_stop(self) -> None:
        """Record the track's speed at the start of a stop; the arm stays where it is."""
        lift_mm = self.view.readings.lift_mm
        if isfinite(lift_mm):
            self.state.setpoints.lift_mm = lift_mm
        start, limits = self.view.stop_start, self.view.limits
        start.speed_m_s = self._speed_m_s()
        rate_m_s2 = limits.deceleration_m_s2 if self.state.mode is Mode.STOPPING else limits.quick_stop_m_s2
        start.ramp_until_s = self.view.readings.now_s + abs(self.state.setpoints.track_m_s) / rate_m_s2

    def note_fast_stop(self) -> None:
        """Record the track's speed at the start of its quick stop."""
        self.view.stop_start.fast_speed_m_s = self._speed_m_s()

    def _speed_m_s(self) -> float:
        speed = abs(self.view.readings.track_now_m_s)
        most = self.rig.limits.track_speed_m_s
        return min(speed, most) if isfinite(speed) else most

    def motion_over(self) -> bool:
        """Return whether the track is known to stand; the arm stays where it is.

        A speed that reads 0 before the commanded one can have been ramped down is that of a drive that repeats itself.
        """
        return standing(self.view) and self.view.readings.now_s >= self.view.stop_start.ramp_until_s

    def stop_ended(self) -> bool:
        """Return whether the track is at rest with the chamber off, or the stop has timed out ("stop not ended")."""
        view = self.view
        since_s = view.readings.now_s - self.state.mode_since_s
        if since_s > view.parameters[STOP_TIMEOUT_S]:
            return True
        # After this time the row "chamber not off" has tripped, and the chamber's lease ends its output.
        off = not view.limits.chamber or view.readings.chamber_percent == 0.0
        late = since_s > view.parameters[CHAMBER_OFF_S] + LATE_S
        return self.motion_over() and (off or late)


def _limits(rig: TrackConfig) -> TrackLimits:
    limits, track, metres = rig.limits, rig.axes.track, rig.metres
    return TrackLimits(
        heartbeat_s=rig.can.drive_heartbeat_s,
        force_n=limits.force_n,
        track_m_s=limits.track_speed_m_s,
        fastest_m_s=track.max_speed * metres,
        deceleration_m_s2=track.deceleration * metres,
        quick_stop_m_s2=track.quick_stop_deceleration * metres,
        low_mm=limits.travel_low_mm if rig.linear else -inf,
        high_mm=limits.travel_high_mm if rig.linear else inf,
        air_low_c=limits.air_low_c,
        air_high_c=limits.air_high_c,
        chamber=rig.chamber,
        air=rig.chamber or "thermometer" in rig.devices,
        exit="pyrometer" in rig.devices,
        height="height_sensor" in rig.devices,
    )
