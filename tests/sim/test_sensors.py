"""Sensors: the truth at noise 0, the stated imperfections otherwise."""

from __future__ import annotations

import math
import statistics

import pytest

from sim.noise import NormalStream
from sim.sensors import SpeedSensor, TemperatureSensor


def thermometer(rms_k: float, bias_k: float) -> TemperatureSensor:
    sensor = TemperatureSensor(0.15, rms_k, bias_k, NormalStream(1, "ir", 1))
    sensor.reset(25.0)
    return sensor


def test_thermometer_lags_by_its_time_constant_at_any_step() -> None:
    for dt, steps in ((0.001, 150), (0.01, 15), (0.05, 3)):
        sensor = thermometer(0.0, 0.0)
        sensor.retime(dt)
        for _ in range(steps):
            sensor.follow(35.0)
        assert sensor.measure() == pytest.approx(25.0 + 10.0 * (1.0 - math.exp(-1.0)))


def test_thermometer_reads_its_bias_and_noise() -> None:
    sensor = thermometer(0.1, -0.7)
    readings = [sensor.measure() for _ in range(3000)]
    assert statistics.fmean(readings) == pytest.approx(24.3, abs=0.01)
    assert statistics.stdev(readings) == pytest.approx(0.1, rel=0.06)


def test_thermometer_without_noise_reads_its_lagged_value_and_its_bias() -> None:
    assert thermometer(0.0, 0.0).measure() == 25.0
    assert thermometer(0.0, 0.4).measure() == 25.4


def test_encoder_has_a_scale_and_white_noise() -> None:
    sensor = SpeedSensor(1.001, 0.0005, NormalStream(1, "belt speed", 1))
    readings = [sensor.measure(0.5) for _ in range(3000)]
    assert statistics.fmean(readings) == pytest.approx(0.5005, abs=5e-5)
    assert statistics.stdev(readings) == pytest.approx(0.0005, rel=0.06)


def test_encoder_without_noise_reads_the_truth() -> None:
    assert SpeedSensor(1.0, 0.0, NormalStream(1, "belt speed", 1)).measure(0.8) == 0.8
