"""This machine's devices: track and lift on CAN; load cell, chamber, thermometers and the arm's height on Modbus.

``fill`` copies readings into the process image, ``apply`` hands setpoints to the drivers. No decisions are made here.
"""

from __future__ import annotations

from collections import deque
from math import inf, nan
from typing import Final

from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from drivers.temperature_controller import TemperatureController
from tester.kinds.specimen_on_track.process import NEVER, TrackReadings, TrackSetpoints
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.devices import DeviceList
from tester.machine.rig_drivers import RigDrivers
from tester.machine.rig_ports import Ports

CELL_CHANNELS: Final = ("fx",)
"""Tangential force (N)."""
SURFACE_CHANNELS: Final = ("surface",)
"""Temperature of the pyrometer's target (degC)."""
HEIGHT_CHANNELS: Final = ("height",)
"""Height of the arm (mm)."""
REPEATED_S: Final = 0.002
"""A place that arrives this soon after another is the same frame again, s [A]: it would show a track at rest."""
SPEED_S: Final = 0.5
"""Averaging time of the speed of a track with position feedback, s [A]: 500 increments at 1 um/s."""


class TrackDevices(DeviceList):
    """The devices of this machine; ``metres``: of the track drive's unit of length.

    ``by_hand_mm``: requested place of an arm without a drive; NaN before the first request.
    """

    def __init__(self, rig: TrackConfig, ports: Ports) -> None:
        """Build the drivers of the rig file on these wires; nothing is sent."""
        drivers = RigDrivers(rig, ports)
        cell = drivers.sensor("load_cell", CELL_CHANNELS)
        assert cell is not None  # a rig file without a cell is refused
        self.cell: Sensor = cell
        self.thermometer: Sensor | None = drivers.sensor("thermometer", SURFACE_CHANNELS)
        self.pyrometer: Sensor | None = drivers.sensor("pyrometer", SURFACE_CHANNELS)
        self.height: Sensor | None = drivers.sensor("height_sensor", HEIGHT_CHANNELS)
        self.chamber: TemperatureController | None = drivers.controller("chamber") if rig.chamber else None
        super().__init__(drivers, (cell.link,))
        self.track: ServoDrive = drivers.drives["track"]
        self.lift: ServoDrive | None = drivers.drives.get("lift")
        self.arm = rig.arm
        self.metres = rig.metres
        self.by_hand_mm = nan
        self._places = rig.axes.track.feedback == "position"
        self._repeated_s = REPEATED_S if self._places else 0.0
        self._seen: deque[tuple[float, float]] = deque()
        self._way_m = 0.0
        self._speed_m_s = self._now_m_s = self._track_mm = nan
        self._track_s: float = NEVER

    def receive(self, now: float) -> None:
        """Process all arrived data; count the track's way from its first reading, also while connecting."""
        super().receive(now)
        track = self.track
        if track.stamp_s > self._track_s + self._repeated_s:
            self._follow_track(track.stamp_s, track.actual * self.metres)

    def fill(self, r: TrackReadings, now: float) -> None:
        """Bring the process image up to date."""
        r.now_s = now
        r.track_m_s, r.track_now_m_s, r.track_mm = self._speed_m_s, self._now_m_s, self._track_mm
        r.way_m, r.track_at_s = self._way_m, self._track_s
        self._fill_arm(r, now)
        self.fill_common(r, now)
        cell = self.cell
        r.force_n = cell.values[0]
        r.cell_valid, r.cell_at_s, r.cell_changed_s = cell.valid, cell.stamp_s, cell.changed_s
        r.cell_silent = not cell.ready
        height = self.height
        if height is not None:
            r.height_mm = height.values[0] if height.valid else nan
            r.height_at_s, r.height_changed_s, r.height_silent = height.stamp_s, height.changed_s, not height.ready
        self._fill_temperatures(r)

    def _follow_track(self, stamp_s: float, actual: float) -> None:
        """Update way and speed from a reading of the track: its place (m), or its speed (m/s)."""
        before_s, self._track_s = self._track_s, stamp_s
        if not self._places:
            if before_s != NEVER:
                self._way_m += actual * (stamp_s - before_s)
            self._speed_m_s = self._now_m_s = actual
            return
        seen = self._seen
        if seen:
            _, place_m = seen[-1]
            self._way_m += actual - place_m
            self._now_m_s = (actual - place_m) / (stamp_s - before_s)
        seen.append((stamp_s, actual))
        while len(seen) > 2 and seen[1][0] <= stamp_s - SPEED_S:
            seen.popleft()
        first_s, place_m = seen[0]
        if stamp_s > first_s:
            self._speed_m_s = (actual - place_m) / (stamp_s - first_s)
        self._track_mm = 1e3 * actual

    def _fill_arm(self, r: TrackReadings, now: float) -> None:
        lift, arm = self.lift, self.arm
        if lift is not None:
            r.lift_mm, r.lift_at_s = lift.actual, lift.stamp_s
        else:
            r.lift_mm, r.lift_at_s = self.by_hand_mm, now
        r.lowered = r.lift_mm <= arm.within_mm
        r.raised = r.lift_mm >= arm.raised_mm - arm.within_mm

    def _fill_temperatures(self, r: TrackReadings) -> None:
        chamber, thermometer, pyrometer = self.chamber, self.thermometer, self.pyrometer
        if chamber is not None:
            r.air_c, r.air_valid, r.air_at_s = chamber.measured_c, chamber.valid, chamber.stamp_s
            r.air_silent = not chamber.ready
            r.chamber_percent = chamber.output_percent
            r.chamber_alarm = chamber.out_of_range or chamber.lease_expired
        elif thermometer is not None:
            r.air_c, r.air_valid, r.air_at_s = thermometer.values[0], thermometer.valid, thermometer.stamp_s
            r.air_silent = not thermometer.ready
        r.contact_c = r.air_c
        if pyrometer is not None:
            r.exit_c, r.exit_at_s = pyrometer.values[0], pyrometer.stamp_s
            r.exit_silent = not pyrometer.ready
            r.contact_c = r.exit_c

    def apply(self, out: TrackSetpoints) -> None:
        """Hand the setpoints to the drivers; the frames leave with ``transmit``."""
        self.apply_common(out)
        track, lift, chamber = self.track, self.lift, self.chamber
        speed = out.track_m_s / self.metres
        if speed != track.aimed:
            track.aim(speed)
        if lift is not None and out.lift_mm != lift.aimed:
            lift.aim(out.lift_mm)
        if chamber is not None:
            chamber.enable(out.chamber)
            if not out.chamber_silent and -inf < out.chamber_c < inf:
                chamber.set_setpoint(out.chamber_c)
