"""Heat that the temperatures do not show: beliefs off by 30 % never add up, sensors off by more do."""

from __future__ import annotations

import math
from itertools import product

import pytest

from sim.thermal import ThermalModel
from tester.control.observer import ThermalObserver
from tester.interlocks.heat_balance import HeatBalance
from tester.rig import RigConfig, load_rig

DT = 0.05
TOLD_K = 5.0
HOT_C = 150.0


@pytest.fixture(scope="module")
def rig() -> RigConfig:
    return load_rig("sim")


def heat_up(
    rig: RigConfig, *, gain: float = 1.0, capacity: float = 1.0, friction: float = 1.0, losses: float = 1.0,
    ambient_k: float = 0.0, share: float = 0.3, seconds: float = 2400.0, told_k: float = math.inf,
) -> tuple[float, float]:  # fmt: skip
    """Heat to a hub shown at 112 degC with bursts of friction; return the greatest unseen heat (K) and the true hub
    temperature (degC) when it first was above ``told_k``, or at the end.

    ``gain``: of the sensor above ambient. ``capacity``, ``friction``, ``losses``: the wheel's over those believed.
    """
    sim, thermal = rig.sim, rig.sim.thermal
    plant = ThermalModel(
        sim.wheel,
        _scaled(thermal, capacity, losses),
        friction * sim.friction_heat_fraction,
        losses * sim.belt_conductance,
    )
    air_c = rig.ambient_c + ambient_k
    state, observer = plant.state(air_c), ThermalObserver(rig)
    believed = rig.observer.thermal
    balance = HeatBalance(
        believed.hub_capacity, believed.hub_to_shaft, believed.jacket_power, rig.ambient_c, share, 5.0
    )
    most_k = output = integral = 0.0
    for i in range(round(seconds / DT)):
        now = i * DT
        shown_c = air_c + gain * (state.hub_c - air_c)
        error = 112.0 - shown_c
        if 0.0 < output < 100.0:
            integral += error * DT / 60.0
        output = min(max(40.0 * (error + integral), 0.0), 100.0)
        friction_w = 300.0 if now % 60.0 < 10.0 and now > 600.0 else 0.0
        plant.step(state, DT, 2.0 * output, friction_w, air_c, 1.0, True)
        observer.rub(friction_w, DT)
        if now >= observer.due_s:
            observer.step(now, shown_c, 0.8, state.surface_c)
            balance.update(now, shown_c, output, observer.given_j)
            most_k = max(most_k, balance.unseen_k)
            if most_k > told_k:
                break
    return most_k, state.hub_c


def _scaled(thermal: object, capacity: float, losses: float) -> object:
    from dataclasses import replace

    changed = {"hub_capacity": capacity, "heat_capacity": capacity} | dict.fromkeys(
        ("film_stopped", "film_rotating", "film_sides", "hub_to_shaft"), losses
    )
    return replace(thermal, **{key: factor * getattr(thermal, key) for key, factor in changed.items()})  # type: ignore[type-var]


@pytest.mark.parametrize(("capacity", "losses", "friction"), [(1.0, 1.0, 1.0), *product((0.7, 1.3), repeat=3)])
def test_beliefs_off_by_30_percent_are_not_told(
    rig: RigConfig, capacity: float, losses: float, friction: float
) -> None:
    assert heat_up(rig, capacity=capacity, losses=losses, friction=friction)[0] < TOLD_K
