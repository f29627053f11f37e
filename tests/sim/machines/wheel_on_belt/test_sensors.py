"""The load cell: the truth at noise 0, the stated imperfections otherwise."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace

import pytest

from sim.machines.wheel_on_belt.sensors import LoadCellSensor
from sim.physics.parameters import SensorParameters

PERFECT = SensorParameters(
    force_rms=0.0,
    linearity=0.0,
    zero_drift=0.0,
    crosstalk=0.0,
    misalignment_least=0.0,
    misalignment_most=0.0,
    moment_rms=0.0,
)
FORCES = (146.0, 45.0, 200.0, 0.05)


def cell(parameters: SensorParameters, noise: float = 1.0, seed: int = 1) -> LoadCellSensor:
    return LoadCellSensor(parameters, noise, seed, 23.0)


def test_cell_without_noise_reads_the_truth() -> None:
    sensor = cell(SensorParameters(), noise=0.0)
    sensor.set_temperature(60.0)
    assert sensor.measure(*FORCES) == FORCES


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_cell_is_cut_off_at_its_ranges(noise: float) -> None:
    x, y, z, _ = cell(SensorParameters(), noise).measure(-2000.0, 1500.0, 800.0, 0.0)
    assert (x, y, z) == (-1000.0, 1000.0, 600.0)


def test_cell_noise_is_white_with_its_rms() -> None:
    sensor = cell(replace(PERFECT, force_rms=0.25, moment_rms=0.02))
    readings = [sensor.measure(*FORCES) for _ in range(4000)]
    for channel, rms in enumerate((0.25, 0.25, 0.25, 0.02)):
        values = [reading[channel] for reading in readings]
        assert statistics.fmean(values) == pytest.approx(FORCES[channel], abs=0.05 * rms)
        assert statistics.stdev(values) == pytest.approx(rms, rel=0.06)


def test_linearity_is_off_by_at_most_a_thousandth_of_the_range_and_not_at_its_ends() -> None:
    worst = 0.0
    for seed in range(60):
        sensor = cell(replace(PERFECT, linearity=0.001), seed=seed)
        worst = max(worst, *(abs(sensor.measure(0.0, 0.0, f, 0.0)[2] - f) for f in (-450.0, 150.0, 300.0)))
        assert sensor.measure(0.0, 0.0, 0.0, 0.0)[2] == 0.0
        assert sensor.measure(1000.0, -1000.0, 600.0, 0.0)[:3] == pytest.approx((1000.0, -1000.0, 600.0))
    assert 0.5 < worst <= 0.6


def test_zero_drifts_with_the_cells_temperature() -> None:
    sensor = cell(replace(PERFECT, zero_drift=0.1))
    sensor.set_temperature(33.0)
    assert [abs(f) for f in sensor.measure(0.0, 0.0, 0.0, 0.0)[:3]] == pytest.approx([1.0, 1.0, 1.0])


def test_cell_follows_half_of_the_belts_excess_slowly() -> None:
    sensor = cell(SensorParameters())
    for _ in range(6000):
        sensor.warm(0.1, 33.0)
    assert sensor.cell_c == pytest.approx(23.0 + 5.0 * (1.0 - math.exp(-1.0)), abs=0.01)


def test_crosstalk_shows_at_most_half_a_percent_of_another_channel() -> None:
    seen = [cell(replace(PERFECT, crosstalk=0.005), seed=seed).measure(0.0, 0.0, 400.0, 0.0) for seed in range(80)]
    assert all(reading[2] == pytest.approx(400.0) for reading in seen)
    assert 1.8 < max(abs(f) for reading in seen for f in reading[:2]) <= 2.0


def test_misalignment_turns_load_into_friction_by_its_angle() -> None:
    parameters = replace(PERFECT, misalignment_least=0.2, misalignment_most=0.5)
    angles: list[float] = []
    for seed in range(60):
        x, y, z, _ = cell(parameters, seed=seed).measure(0.0, 0.0, 400.0, 0.0)
        angles += [math.degrees(math.atan2(x, z)), math.degrees(math.atan2(y, z))]
        assert math.hypot(x, y, z) == pytest.approx(400.0)
    sizes = [abs(angle) for angle in angles]
    assert 0.199 < min(sizes) < 0.22
    assert 0.48 < max(sizes) < 0.501
    assert min(angles) < 0.0 < max(angles)


def test_each_channel_shows_more_or_less_by_the_error_of_its_sensitivity() -> None:
    shares: list[float] = []
    for seed in range(60):
        shown = cell(replace(PERFECT, cell_sensitivity=0.005), seed=seed).measure(*FORCES)
        shares += [seen / true - 1.0 for seen, true in zip(shown[:3], FORCES, strict=False)]
        back = cell(replace(PERFECT, cell_sensitivity=0.005), seed=seed).measure(*(-force for force in FORCES))
        assert back[:3] == pytest.approx([-force for force in shown[:3]])
    assert min(shares) < -0.0045 and 0.0045 < max(shares) <= 0.005


def test_a_mirrored_session_is_off_by_as_much_the_other_way() -> None:
    still = replace(SensorParameters(), force_rms=0.0, moment_rms=0.0, cell_sensitivity=0.005)
    both = (LoadCellSensor(still, 1.0, 5, 23.0, sign).measure(*FORCES) for sign in (1.0, -1.0))
    for true, one, other in zip(FORCES, *both, strict=True):
        assert one + other == pytest.approx(2.0 * true, rel=3e-4) and (one != other or true == one)


def test_an_error_of_sensitivity_shifts_no_other_draw_of_a_session() -> None:
    still = replace(SensorParameters(), force_rms=0.0, moment_rms=0.0, linearity=0.0)
    without = cell(still, seed=5).measure(*FORCES)
    nearly = cell(replace(still, cell_sensitivity=1e-12), seed=5).measure(*FORCES)
    assert nearly == pytest.approx(without, rel=1e-11)


def test_imperfections_of_a_session_come_from_the_seed_alone() -> None:
    still = replace(SensorParameters(), force_rms=0.0, moment_rms=0.0)
    assert cell(still, seed=5).measure(*FORCES) == cell(still, seed=5).measure(*FORCES)
    assert cell(still, seed=5).measure(*FORCES) != cell(still, seed=6).measure(*FORCES)


@pytest.mark.parametrize("scale", [0.5, 2.0])
def test_noise_scales_every_imperfection_of_the_cell(scale: float) -> None:
    unit, scaled = cell(SensorParameters()), cell(SensorParameters(), scale)
    for sensor in (unit, scaled):
        sensor.set_temperature(30.0)
    a, b = unit.measure(*FORCES), scaled.measure(*FORCES)
    for true, one, other in zip(FORCES, a, b, strict=True):
        assert other - true == pytest.approx(scale * (one - true), rel=0.05, abs=0.02)
