"""This machine's devices: servo drives on CAN; load cell, thermometer and jacket, and further sensors, on Modbus.

``fill`` copies readings into the process image, ``apply`` hands setpoints to the drivers. No decisions are made here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Final

from drivers.joined_cell import JoinedCell, LoadCell, links_of
from drivers.sensor import Sensor
from drivers.servo import ServoDrive
from drivers.temperature_controller import TemperatureController
from tester.kinds.wheel_on_belt.image.process_image import NEVER, Readings, Setpoints
from tester.kinds.wheel_on_belt.image.ring_watch import SlipRingWatch
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.sections import VELOCITY_AXES
from tester.machine.devices import DeviceList
from tester.machine.rig_drivers import RigDrivers, load_cell_of
from tester.machine.rig_ports import Ports
from tester.store.recorder import Recorder


@dataclass(frozen=True, slots=True)
class CellSkew:
    """The time skew of the load cell's parts, stored with the bus counters at the end of a run or of its part."""

    cell: JoinedCell

    def store(self, recorder: Recorder, now_s: float) -> None:
        """Store the greatest skew of a whole reading (ms), and how often parts were too far apart to join."""
        cell = self.cell
        recorder.bus_statistic(now_s, "load cell", "", "greatest skew ms", 1e3 * cell.greatest_skew_s)
        recorder.bus_statistic(now_s, "load cell", "", "parts too far apart", cell.apart)


CELL_CHANNELS: Final = ("fx", "fy", "fz", "mz")
"""Longitudinal, lateral and normal force (N), moment about the vertical (N m), in the wheel's frame."""
SURFACE_CHANNELS: Final = ("surface",)
"""Temperature of the rubber's surface (degC)."""

INPUT_CONTACTOR: Final = 1 << 18
OUTPUT_CONTACTOR: Final = 1 << 16
"""Bits of the press drive's digital inputs 0x60FD and outputs 0x60FE, beside those of every machine's safety inputs
(tester.machine.devices)."""

_RADIANS_PER_DEGREE: Final = pi / 180.0
_TURN: Final = 2.0 * pi


@dataclass(slots=True)
class WheelDrives:
    """The drives: three for speeds, and by name those that hold a position; an axis that a person sets has no drive."""

    wheel: ServoDrive
    belt: ServoDrive
    press: ServoDrive
    positioned: Mapping[str, ServoDrive]


class Devices(DeviceList):
    """The devices of this machine.

    ``cell`` reads CELL_CHANNELS and ``thermometer`` the surface; ``jacket`` heats the hub.
    """

    # Slots: CPython 3.11 looks the methods of an object with more than 30 attributes up anew in every scan.
    __slots__ = (
        "_contactor_asked", "_contactor_closed", "_cos", "_last_angle_s", "_positioned", "_sideslip_deg", "_sin",
        "axes", "cell", "jacket", "slip_ring", "thermometer",
    )  # fmt: skip

    def __init__(self, rig: RigConfig, ports: Ports) -> None:
        """Build the drivers of the rig file on these wires; nothing is sent."""
        drivers = RigDrivers(rig, ports)
        positioned = dict(drivers.drives)
        wheel, belt, press = (positioned.pop(name) for name in VELOCITY_AXES)
        self.axes = WheelDrives(wheel, belt, press, positioned)
        cell, transmitters = load_cell_of(rig, drivers.links, CELL_CHANNELS, rig.interlocks.cell_skew_s)
        drivers.devices |= transmitters
        self.cell: LoadCell = cell
        thermometer = drivers.sensor("ir_thermometer", SURFACE_CHANNELS)
        assert thermometer is not None  # a rig file without it is refused
        self.thermometer: Sensor = thermometer
        self.jacket: TemperatureController = drivers.controller("jacket")
        # A quick-stopped press would stay in contact, so it keeps retracting as long as it is to have power.
        super().__init__(drivers, links_of(cell), press, wheel)
        self.slip_ring = SlipRingWatch(self.jacket)
        self.counted.append(self.slip_ring)
        if isinstance(cell, JoinedCell):
            self.counted.append(CellSkew(cell))
        self._positioned = tuple(positioned.items())
        self._contactor_asked = False
        self._contactor_closed = False  # its last feedback
        self._last_angle_s: float = NEVER
        self._sideslip_deg, self._cos, self._sin = 0.0, 1.0, 0.0

    def fill(self, r: Readings, now: float) -> None:
        """Update the process image; ``WheelLife.show`` has already updated the wheel's diameters."""
        r.now_s = now
        self._fill_motion(r, self.axes)
        self.fill_common(r, now)
        if self.news:
            r.contactor_closed = self._contactor_closed = self.io.inputs & INPUT_CONTACTOR != 0
        cell = self.cell
        r.force_x_n, r.force_y_n, r.force_z_n, r.moment_z_nm = cell.values
        r.cell_valid, r.cell_at_s, r.cell_changed_s = cell.valid, cell.stamp_s, cell.changed_s
        r.cell_silent = not cell.ready
        thermometer = self.thermometer
        r.surface_c = thermometer.values[0]
        r.surface_valid, r.surface_at_s = thermometer.valid, thermometer.stamp_s
        r.surface_changed_s = thermometer.changed_s
        r.surface_silent = not thermometer.ready
        jacket = self.jacket
        r.hub_c, r.heat_percent = jacket.measured_c, jacket.output_percent
        r.jacket_valid, r.jacket_at_s, r.jacket_silent = jacket.valid, jacket.stamp_s, not jacket.ready
        self.slip_ring.look(r.wheel_angle_rev, r.wheel_rad_s)

    def _fill_motion(self, r: Readings, axes: WheelDrives) -> None:
        wheel, belt, press = axes.wheel, axes.belt, axes.press
        r.wheel_rad_s = wheel_rad_s = wheel.actual
        r.wheel_speed_m_s = wheel_m_s = wheel_rad_s * r.diameter_mm * 0.5e-3
        r.drive_torque_nm = wheel.torque_nm
        r.wheel_at_s = stamp_s = wheel.stamp_s
        r.wheel_changed_s = wheel.changed_s
        if stamp_s > self._last_angle_s:
            if self._last_angle_s != NEVER:
                r.wheel_angle_rev += wheel_rad_s * (stamp_s - self._last_angle_s) / _TURN
            self._last_angle_s = stamp_s
        r.belt_speed_m_s = belt_m_s = belt.actual
        r.belt_torque_nm, r.belt_at_s = belt.torque_nm, belt.stamp_s
        r.press_mm, r.press_torque_nm, r.press_at_s = press.actual, press.torque_nm, press.stamp_s
        positions, oldest_s, reached = r.positions, r.now_s, True
        for name, drive in self._positioned:
            positions[name] = drive.actual
            if drive.stamp_s < oldest_s:
                oldest_s = drive.stamp_s
            if not drive.reached():
                reached = False
        r.positions_at_s, r.yaw_reached = oldest_s, reached
        sideslip_deg = positions["sideslip"]
        if sideslip_deg != self._sideslip_deg:
            angle = sideslip_deg * _RADIANS_PER_DEGREE
            self._sideslip_deg, self._cos, self._sin = sideslip_deg, cos(angle), sin(angle)
        along = wheel_m_s - belt_m_s * self._cos
        across = belt_m_s * self._sin
        r.slip_m_s = (along * along + across * across) ** 0.5

    def apply(self, out: Setpoints) -> None:
        """Hand the setpoints to the drivers; the frames leave with ``transmit``."""
        self.apply_common(out)
        axes = self.axes
        wheel, belt, press = axes.wheel, axes.belt, axes.press
        if out.wheel_rad_s != wheel.aimed:
            wheel.aim(out.wheel_rad_s)
        if out.belt_m_s != belt.aimed:
            belt.aim(out.belt_m_s)
        if out.press_mm_s != press.aimed:
            press.aim(out.press_mm_s)
        for name, drive in self._positioned:
            position = out.positions[name]
            if position != drive.aimed:
                drive.aim(position)
        if out.contactor is not self._contactor_asked or self.news:
            self._contactor_asked = out.contactor
            press.outputs = OUTPUT_CONTACTOR if out.contactor else 0
        press.outputs_unanswered = out.contactor is not self._contactor_closed
        jacket = self.jacket
        jacket.enable(out.heat)
        if not out.jacket_silent:
            jacket.set_setpoint(out.hub_c)
