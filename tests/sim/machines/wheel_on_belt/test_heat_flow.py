"""Short explicit and long implicit steps of the plant's heat: together one course of temperatures."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest

from sim.machines.wheel_on_belt.heat_flow import CALM_AFTER_S, HeatFlow
from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.noise import NormalStream
from sim.physics.parameters import SensorParameters, ThermalParameters, WheelParameters
from sim.physics.thermal import CALM_STEP_S, ThermalModel
from sim.sensors import TemperatureSensor
from tests.sim.physics.test_thermal import LOSSLESS, stored_j
from tests.sim.physics.thermal_example import surface_temperature

AMBIENT_C = 25.0

Phase = tuple[float, float, float, float, bool, bool]
"""Seconds, tick, heater and friction in W, touching, rotating."""

NIGHT: tuple[Phase, ...] = (
    (240.0, 0.1, 0.0, 0.0, False, False),
    (300.0, 0.05, 200.0, 0.0, False, True),
    (60.0, 0.05, 60.0, 0.2, True, True),
    (5.0, 0.01, 40.0, 90.0, True, True),
    (40.0, 0.05, 80.0, 0.2, True, True),
    (3.0, 0.01, 40.0, 150.0, True, True),
    (60.0, 0.05, 0.0, 0.0, False, True),
    (300.0, 0.1, 0.0, 0.0, False, False),
)
"""Rest, heating up, rolling, two slip pulses, lifted, standing."""


def build(share: float = 0.06, belt_w_k: float = 0.06, thermal: ThermalParameters | None = None) -> HeatFlow:
    model = ThermalModel(WheelParameters(), thermal or ThermalParameters(), share, belt_w_k)
    sensor = TemperatureSensor(1.0, 0.0, 0.0, NormalStream(1, "hub"))
    return HeatFlow(model, AMBIENT_C, sensor, LoadCellSensor(SensorParameters(), 0.0, 1, AMBIENT_C))


@pytest.mark.parametrize(("share", "belt_w_k"), [(0.06, 0.06), (0.5, 0.3)])
def test_temperatures_after_each_calm_step_are_those_of_fine_ones(share: float, belt_w_k: float) -> None:
    """Calm rig and hot rig; in the seconds after a sudden change the steps are short ones."""
    flow, reference = build(share, belt_w_k), ThermalModel(WheelParameters(), ThermalParameters(), share, belt_w_k)
    expected = reference.state(AMBIENT_C)
    compared, greatest_c, last = 0, AMBIENT_C, flow.state.cells_c
    for seconds, dt, heater_w, friction_w, touching, rotating in NIGHT:
        for tick in range(round(seconds / dt)):
            surface_c = flow.advance(dt, heater_w, friction_w, touching, rotating)
            for _ in range(round(dt / 0.01)):
                reference.step(expected, 0.01, heater_w, friction_w, AMBIENT_C, float(touching), rotating)
            if tick * dt < CALM_AFTER_S or flow.state.cells_c is last:
                continue
            compared, last = compared + 1, flow.state.cells_c
            expected_c = surface_temperature(reference, expected, friction_w, AMBIENT_C, float(touching), rotating)
            greatest_c = max(greatest_c, surface_c)
            assert surface_c == pytest.approx(expected_c, abs=0.02)
            assert flow.state.hub_c == pytest.approx(expected.hub_c, abs=0.02)
            assert flow.state.belt_c == pytest.approx(expected.belt_c, abs=0.02)
    assert greatest_c > 45.0
    assert compared == pytest.approx(sum(seconds for seconds, *_ in NIGHT) / CALM_STEP_S, rel=0.1)


def test_no_heat_is_lost_between_long_and_short_steps() -> None:
    flow, given_j = build(0.3, 0.2, LOSSLESS), 0.0
    for seconds, dt, heater_w, friction_w, touching, rotating in (*NIGHT, (60.0, 0.1, 0.0, 0.0, False, False)):
        for _ in range(round(seconds / dt) + 1):  # one more: phases do not end with a step
            flow.advance(dt, heater_w, friction_w, touching, rotating)
            given_j += dt * (heater_w + friction_w)
    model = ThermalModel(WheelParameters(), replace(LOSSLESS), 0.3, 0.2)
    assert stored_j(model, flow.state) == pytest.approx(given_j, rel=1e-9)


@pytest.mark.parametrize("event", [(0.0, True, True), (0.0, False, False), (50.0, False, True)])
def test_a_disturbance_ends_the_calm_at_once(event: tuple[float, bool, bool]) -> None:
    flow = build()
    for _ in range(2 * round(CALM_AFTER_S / 0.05) + 3):
        flow.advance(0.05, 100.0, 0.0, False, True)
    before_c = flow.state.hub_c
    flow.advance(0.01, 100.0, *event)
    assert flow.state.hub_c > before_c  # what was pending has flowed
    before_c = flow.state.hub_c
    for _ in range(4):
        flow.advance(0.01, 100.0, *event)
    assert flow.state.hub_c == pytest.approx(before_c + 0.05 * 100.0 / 420.0, rel=1e-4)


def test_a_copy_continues_identically_and_independently() -> None:
    flow = build()
    for _ in range(33):
        flow.advance(0.1, 150.0, 0.0, False, True)
    twin = copy.deepcopy(flow)
    ahead = [flow.advance(0.1, 150.0, 0.0, False, True) for _ in range(100)]
    assert [twin.advance(0.1, 150.0, 0.0, False, True) for _ in range(100)] == ahead
