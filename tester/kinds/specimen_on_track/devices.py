"""This machine's devices: track and lift on CAN; load cell, chamber, pyrometer and thermometer on Modbus.

Inputs fill the process image from the drivers, outputs hand setpoints to them. Nothing here decides.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from math import inf, nan
from typing import Final

from drivers.canopen.master import CanMaster
from drivers.canopen.sensor_node import SensorNode
from drivers.chamber import ClimateChamber
from drivers.cia402 import Goal
from drivers.modbus import ModbusLink
from drivers.ports import CanPort, LinePort
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from tester.kinds.specimen_on_track.process import NEVER, TrackReadings, TrackSetpoints
from tester.kinds.specimen_on_track.rig import ArmConfig
from tester.machine.devices import DeviceList
from tester.machine.field_device import FieldDevice

CELL_CHANNELS: Final = ("fx",)
"""Tangential force (N)."""
SURFACE_CHANNELS: Final = ("surface",)
"""Temperature of what a pyrometer looks at (degC)."""
SPEED_S: Final = 0.5
"""The speed of a track that tells its position is taken over this, s [A]: 500 increments at 1 um/s."""

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_ENABLED: Final = Goal.ENABLED
_DISABLED: Final = Goal.DISABLED
_QUICK_STOP: Final = Goal.QUICK_STOP
_FREE: Final = Goal.FREE


class TrackDevices(DeviceList):
    """The devices of this machine; ``metres``: in the unit of length of the track's drive.

    ``by_hand_mm``: where a person was asked to bring an arm without a drive; NaN before that.
    """

    def __init__(
        self,
        can: CanPort,
        master: CanMaster,
        track: ServoDrive,
        lift: ServoDrive | None,
        lines: Sequence[tuple[LinePort, ModbusLink]],
        cell: Sensor,
        chamber: ClimateChamber | None,
        thermometer: Sensor | None,
        pyrometer: Sensor | None,
        modbus: Sequence[FieldDevice],
        sensors: Sequence[Sensor],
        nodes: Sequence[SensorNode],
        arm: ArmConfig,
        metres: float,
    ) -> None:
        """Take the drivers; ``modbus``: every device on the lines, ``sensors`` and ``nodes``: further ones."""
        drives = (track,) if lift is None else (track, lift)
        super().__init__(can, master, drives, lines, modbus, sensors, nodes, (cell.link,))
        self.track, self.lift = track, lift
        self.cell = cell
        self.chamber, self.thermometer, self.pyrometer = chamber, thermometer, pyrometer
        self.arm = arm
        self.metres = metres
        self.by_hand_mm = nan
        self._places = track.config.feedback == "position"
        self._seen: deque[tuple[float, float]] = deque()
        self._way_m = 0.0
        self._speed_m_s = self._now_m_s = self._track_mm = nan
        self._track_s: float = NEVER
        self._withheld = False
        self._goal: Goal = Goal.DISABLED

    def receive(self, now: float) -> None:
        """Take in everything that arrived; the track is followed from the first reading on, while connecting, too."""
        super().receive(now)
        track = self.track
        if track.stamp_s > self._track_s:
            self._follow_track(track.stamp_s, track.actual * self.metres)

    def fill(self, r: TrackReadings, now: float) -> None:
        """Bring the process image up to date."""
        r.now_s = now
        track = self.track
        r.track_m_s, r.track_now_m_s, r.track_mm = self._speed_m_s, self._now_m_s, self._track_mm
        r.way_m, r.track_at_s = self._way_m, self._track_s
        self._fill_arm(r, now)
        self.news = False
        for drive in self.drives:
            if drive.news:
                drive.news = drive.stands = False
                self.news = True
        if self.news:
            self.fill_status(r, track)
        r.inputs_at_s = track.inputs_stamp_s
        r.can_heard_s = self._can_heard_s
        self.fill_unheard(r)
        self.fill_silent(r)
        if self.lost:
            r.bus_fault = self.lost
        if self.master.foreign_master:
            r.foreign_master = self.master.foreign_frame
        cell = self.cell
        r.force_n = cell.values[0]
        r.cell_valid, r.cell_at_s, r.cell_changed_s = cell.valid, cell.stamp_s, cell.changed_s
        r.cell_silent = not cell.ready
        self._fill_temperatures(r)
        if r.channels:
            self.fill_channels(r.channels, now)
        inspector = self.inspector
        if now >= inspector.due_s:
            inspector.inspect(now)
            r.device_fault, r.line_errors, r.line_fault = inspector.fault, inspector.line_errors, inspector.noisy

    def _follow_track(self, stamp_s: float, actual: float) -> None:
        """Take in a reading of the track: its place (m), or its speed (m/s)."""
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
            r.air_c, r.air_valid, r.air_at_s = chamber.air_c, chamber.valid, chamber.stamp_s
            r.air_silent = not chamber.ready
            r.chamber_percent = chamber.output_percent
            r.chamber_alarm = chamber.out_of_range or chamber.lease_expired
        elif thermometer is not None:
            r.air_c, r.air_valid, r.air_at_s = thermometer.values[0], thermometer.valid, thermometer.stamp_s
            r.air_silent = not thermometer.ready
        r.contact_c = r.air_c
        if pyrometer is not None:
            r.exit_c, r.exit_valid, r.exit_at_s = pyrometer.values[0], pyrometer.valid, pyrometer.stamp_s
            r.exit_silent = not pyrometer.ready
            r.contact_c = r.exit_c

    def apply(self, out: TrackSetpoints) -> None:
        """Hand the setpoints to the drivers; the frames leave with ``transmit``."""
        wanted = _ENABLED if out.enable else _DISABLED
        goal = _FREE if out.power_off else _QUICK_STOP if out.quick_stop else wanted
        if goal is not self._goal or self.news:
            self._goal = goal
            for drive in self.drives:
                drive.goal = goal
        track, lift, chamber = self.track, self.lift, self.chamber
        speed = out.track_m_s / self.metres
        if speed != track.aimed:
            track.aim(speed)
        if lift is not None and out.lift_mm != lift.aimed:
            lift.aim(out.lift_mm)
        if out.power_off is not self._withheld:
            # The last resort reaches a drive that takes no commands, too: each stops without our heartbeat.
            self._withheld = self.master.withhold_heartbeat = out.power_off
        if chamber is not None:
            chamber.enable(out.chamber)
            if not out.chamber_silent and -inf < out.chamber_c < inf:
                chamber.set_setpoint(out.chamber_c)
