"""A rig in good order: every test breaks exactly one thing of it."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from tester.control.heat_loop import HeatLoop
from tester.control.load_loop import LoadLoop
from tester.control.state import ControlState
from tester.control.step import Control
from tester.process import Demand, Press, Readings, Setpoints
from tester.rig import RigConfig, load_rig


@pytest.fixture(scope="session")
def rig() -> RigConfig:
    return load_rig("sim")


@dataclass
class Bench:
    """Control with readings that can be advanced."""

    control: Control
    readings: Readings
    demand: Demand

    @property
    def state(self) -> ControlState:
        return self.control.state

    def scan(self, dt: float = 0.01, *, fresh: bool = True) -> Setpoints:
        r = self.readings
        r.now_s += dt
        if fresh:
            r.wheel_at_s = r.belt_at_s = r.press_at_s = r.sideslip_at_s = r.camber_at_s = r.now_s
            r.cell_at_s = r.surface_at_s = r.jacket_at_s = r.now_s
        self.state.events.clear()
        return self.control.step(self.demand, r, dt)


def healthy_readings() -> Readings:
    return Readings(
        wheel_speed_m_s=0.8, wheel_rad_s=0.8 / 0.045, belt_speed_m_s=0.5, press_mm=11.8, slip_m_s=0.3,
        drive_torque_nm=6.0, drives_enabled=True, drives_disabled=False, yaw_reached=True, safety_chain=True,
        guard_closed=True, contactor_closed=True, force_x_n=146.0, force_y_n=0.0, force_z_n=200.0, moment_z_nm=0.0,
        cell_valid=True, surface_c=40.0, surface_valid=True, hub_c=60.0, heat_percent=20.0, jacket_valid=True,
        diameter_mm=90.0,
    )  # fmt: skip


@pytest.fixture
def bench(rig: RigConfig) -> Bench:
    """The rig in RUN, sliding under load with the heat on, everything in order."""
    state = ControlState(Setpoints(), LoadLoop(), HeatLoop())
    control = Control(rig, state, (0.56, 0.81))
    readings = healthy_readings()
    demand = Demand(
        enabled=True, wheel_speed_m_s=0.8, belt_speed_m_s=0.5, press=Press.LOAD, load_n=200.0, surface_c=40.0
    )
    made = Bench(control, readings, demand)
    assert control.start(0.0) == ""
    for _ in range(100):
        made.scan()
    return made
