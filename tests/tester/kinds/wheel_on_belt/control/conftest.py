"""A rig in good order: every test breaks exactly one thing of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import cos, inf, pi, radians, sin

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.control.loops import WheelState
from tester.kinds.wheel_on_belt.control.step import WheelControl
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.state import ControlEvent, Mode

STAMPS = ("wheel_at_s", "belt_at_s", "press_at_s", "positions_at_s", "cell_at_s", "surface_at_s",
          "jacket_at_s", "cell_changed_s", "surface_changed_s", "inputs_at_s",
          "can_heard_s", "wheel_changed_s")  # fmt: skip
"""Times of each source's latest report and latest new value."""


@pytest.fixture(scope="session")
def rig() -> RigConfig:
    return load_rig("sim")


@dataclass
class Bench:
    """Control with readings that can be advanced."""

    control: WheelControl
    readings: Readings
    demand: Demand
    stale: set[str] = field(default_factory=set[str])
    """Stamps that do not advance."""
    screws: bool = True
    """The press's torque follows from the force, between the least and the most of its friction."""
    shafts: bool = True
    """The torques of wheel and belt follow from the friction."""
    journal: list[ControlEvent] = field(default_factory=list[ControlEvent])
    """Every event so far."""

    @property
    def state(self) -> WheelState:
        return self.control.state

    def scan(self, dt: float = 0.01) -> Setpoints:
        r = self.readings
        r.now_s += dt
        screw = self.control.rig.axes.press.screw
        if self.screws and screw is not None:
            r.press_torque_nm = screw.lead_mm / (2000.0 * pi) * (r.force_z_n + screw.spring_n)
        if self.shafts:
            angle = radians(r.positions["sideslip"])
            belt_n = r.force_x_n * cos(angle) - r.force_y_n * sin(angle)
            r.drive_torque_nm = 0.5e-3 * r.diameter_mm * r.force_x_n
            r.wheel_rad_s = 2000.0 * r.wheel_speed_m_s / r.diameter_mm
            r.belt_torque_nm = -0.5e-3 * self.control.rig.geometry.belt_roller_diameter_mm * belt_n
        for stamp in STAMPS:
            if stamp not in self.stale:
                setattr(r, stamp, r.now_s)
        powered = not self.state.setpoints.voltage_off
        self.control.step(self.demand, r, dt)
        self.journal += self.state.events
        self.state.events.clear()
        if powered and self.state.setpoints.voltage_off:
            r.drives_enabled, r.drives_disabled = False, True
        return self.state.setpoints

    def scans(self, seconds: float, dt: float = 0.01) -> Setpoints:
        """Scan for a while; return the last setpoints."""
        out = self.state.setpoints
        for _ in range(round(seconds / dt)):
            out = self.scan(dt)
        return out

    def until_trip(self, at_most_s: float, dt: float = 0.01) -> float:
        """Scan until a row trips; return the seconds it took (inf: no trip)."""
        began = self.readings.now_s
        while self.readings.now_s - began < at_most_s:
            self.scan(dt)
            if self.state.trip is not None:
                return self.readings.now_s - began
        return inf

    def texts(self, kind: str) -> list[str]:
        """Return the texts of the journal's events of a kind."""
        return [event.text for event in self.journal if event.kind == kind]


def healthy_readings() -> Readings:
    return Readings(
        wheel_speed_m_s=0.8, wheel_rad_s=0.8 / 0.045, belt_speed_m_s=0.5, press_mm=11.8, slip_m_s=0.3,
        drive_torque_nm=6.0, drives_enabled=True, drives_disabled=False, yaw_reached=True, safety_chain=True,
        guard_closed=True, contactor_closed=False, force_x_n=146.0, force_y_n=0.0, force_z_n=200.0, moment_z_nm=0.0,
        cell_valid=True, surface_c=40.0, surface_valid=True, hub_c=50.0, heat_percent=20.0, jacket_valid=True,
        cold_mm=90.0, diameter_mm=90.0,
    )  # fmt: skip


def make_bench(rig: RigConfig) -> Bench:
    """Return the rig in RUN, sliding under load with the heat on, everything in order."""
    control = WheelControl(rig)
    state = control.state
    readings = healthy_readings()
    demand = Demand(
        enabled=True, wheel_speed_m_s=0.8, belt_speed_m_s=0.5, press=Press.LOAD, load_n=200.0, surface_c=40.0
    )
    made = Bench(control, readings, demand)
    readings.contactor_closed = False
    readings.heat_percent = 0.0
    readings.wheel_at_s = readings.belt_at_s = readings.jacket_at_s = readings.surface_at_s = readings.now_s
    readings.cell_at_s = readings.surface_changed_s = readings.inputs_at_s = readings.can_heard_s = readings.now_s
    readings.wheel_speed_m_s = readings.belt_speed_m_s = readings.force_z_n = readings.force_x_n = 0.0
    assert control.start(readings) == ""
    # The rig after a while in this step: rubber in balance with surface and hub.
    readings.wheel_speed_m_s, readings.belt_speed_m_s, readings.force_z_n, readings.force_x_n = 0.8, 0.5, 200.0, 146.0
    made.scans(2.0)
    assert state.mode is Mode.RUN and state.trip is None, state.trip
    readings.contactor_closed = True
    readings.heat_percent = 20.0
    made.scan()
    made.journal.clear()
    return made


@pytest.fixture
def bench(rig: RigConfig) -> Bench:
    return make_bench(rig)
