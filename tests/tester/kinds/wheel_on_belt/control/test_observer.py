"""The thermal observer against the simulator's finer wheel, with its parameters off by 30 %."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import pytest

from sim.physics.thermal import ThermalModel
from tester.kinds.wheel_on_belt.control.observer import ThermalObserver
from tester.kinds.wheel_on_belt.rig import RigConfig

DT = 0.05


def greatest_error_k(rig: RigConfig, phi: float, belt: float, hub: float, *, offset_k: float = 0.0) -> float:
    """Heat to a hub of 120 degC in rolling contact with slip pulses, 40 min; return the greatest |surface - model|.

    ``phi``, ``belt``, ``hub``: factors on the true wheel's share of friction heat, its conductance to the belt and its
    hub's heat capacity. ``offset_k``: by how much the thermometer reads low.
    """
    sim = rig.sim
    thermal = replace(sim.thermal, hub_capacity=hub * sim.thermal.hub_capacity)
    model = ThermalModel(sim.wheel, thermal, phi * sim.friction_heat_fraction, belt * sim.belt_conductance)
    state, observer = model.state(sim.ambient), ThermalObserver(rig)
    worst = 0.0
    for i in range(round(2400.0 / DT)):
        now = i * DT
        heater_w = 200.0 if state.hub_c < 120.0 else 0.0
        friction_w = 120.0 if now % 60.0 < 6.0 and now > 600.0 else 0.0
        model.step(state, DT, heater_w, friction_w, sim.ambient, 1.0, True)
        observer.rub(friction_w, DT)
        if now >= observer.due_s:
            observer.step(now, state.hub_c, 0.8, state.surface_c)
            worst = max(worst, abs(state.surface_c - offset_k - observer.surface_c))
    return worst


@pytest.mark.parametrize(("phi", "belt", "hub"), [(1.0, 1.0, 1.0), *product((0.7, 1.3), (0.7, 1.3), (0.7, 1.3))])
def test_it_stays_well_within_the_interlock_with_its_beliefs_off_by_30_percent(
    rig: RigConfig, phi: float, belt: float, hub: float
) -> None:
    assert greatest_error_k(rig, phi, belt, hub) < 0.75 * rig.interlocks.model_k


def test_a_thermometer_that_reads_15_k_low_is_found(rig: RigConfig) -> None:
    assert greatest_error_k(rig, 1.0, 1.0, 1.0, offset_k=15.0) > rig.interlocks.model_k


def test_it_knows_nothing_before_hub_and_surface_were_read(rig: RigConfig) -> None:
    observer = ThermalObserver(rig)
    observer.step(0.0, float("nan"), 0.8, 25.0)
    observer.step(0.5, 40.0, 0.8, float("nan"))
    assert observer.surface_c != observer.surface_c


def test_a_new_wheel_begins_at_ambient_with_the_hub_as_it_was(rig: RigConfig) -> None:
    observer = ThermalObserver(rig)
    for i in range(600):
        observer.step(0.5 * i, 100.0, 0.8, 60.0)
    observer.new_wheel()
    assert observer.surface_c == rig.ambient_c
    for i in range(600, 2000):
        observer.step(0.5 * i, 100.0, 0.8, 0.0)
    assert observer.surface_c > 50.0
