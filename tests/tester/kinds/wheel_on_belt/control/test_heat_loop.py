"""The outer heat loop: clamped, slow, and at rest when the surface is where it should be."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.control.heat_loop import HeatLoop
from tester.kinds.wheel_on_belt.rig import RigConfig


def test_at_the_target_the_hub_setpoint_is_the_feed_forward(rig: RigConfig) -> None:
    loop = HeatLoop()
    assert loop.update(0.0, 40.0, 40.0, 23.0, 0.8, rig.loops.heat) == pytest.approx(40.0 + 17.0 * 0.8)


def test_the_hub_setpoint_never_leaves_its_clamp(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    for now, surface in enumerate([-40.0, 20.0, 150.0, 85.0]):
        hub = loop.update(float(now) * 2.0, 85.0, surface, 23.0, 0.8, heat)
        assert heat.hub_min_c <= hub <= heat.hub_max_c


def test_it_is_computed_once_a_period(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    first = loop.update(0.0, 40.0, 30.0, 23.0, 0.8, heat)
    assert loop.update(0.5 * heat.period_s, 40.0, 39.0, 23.0, 0.8, heat) == first
    assert loop.update(heat.period_s, 40.0, 39.0, 23.0, 0.8, heat) < first


def test_a_missing_surface_temperature_changes_nothing(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    first = loop.update(0.0, 40.0, 30.0, 23.0, 0.8, heat)
    assert loop.update(5.0, 40.0, math.nan, 23.0, 0.8, heat) == first


def test_the_integral_removes_a_lasting_error_and_is_bounded(rig: RigConfig) -> None:
    loop, heat = HeatLoop(), rig.loops.heat
    values = [loop.update(t * heat.period_s, 40.0, 39.5, 23.0, 0.8, heat) for t in range(20_000)]
    assert values[100] > values[0]
    assert values[-1] <= 40.0 + 17.0 * 0.8 + heat.outer_gain * 0.5 + heat.integral_limit_k + 1e-9
