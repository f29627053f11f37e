"""The live gates: each closes on its own quantity, opens when it returns, and stays closed while it is unknown."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.image.process_image import Readings
from tester.kinds.wheel_on_belt.procedures.gates import GATES, Average, Gates, SurfaceTrend
from tester.kinds.wheel_on_belt.rig.loop_sections import GatesConfig

CONFIG = GatesConfig(
    load_percent=2.0, load_filter_s=1.0, speed_percent=1.0, slip_percent=2.0, slip_floor_mm_s=2.0, slip_filter_s=0.2,
    ir_lag_s=0.3, contact_transient_s=1.0,
)  # fmt: skip


class Bench:
    def __init__(self) -> None:
        self.gates = Gates(CONFIG)
        target = self.gates.target
        target.load_n, target.wheel_speed_m_s, target.belt_speed_m_s = 200.0, 0.8, 0.5
        target.slip_m_s, target.temperature_c, target.band_k = 0.3, 40.0, 2.0
        self.gates.touched_s = -10.0
        self.readings = Readings(
            force_z_n=200.0, wheel_speed_m_s=0.8, belt_speed_m_s=0.5, slip_m_s=0.3, surface_c=40.0, surface_at_s=0.0
        )

    def run(self, seconds: float) -> int:
        mask = -1
        for _ in range(round(seconds / 0.01)):
            self.readings.now_s += 0.01
            self.readings.surface_at_s = self.readings.now_s
            mask = self.gates.update(self.readings, 0.01)
        return mask


@pytest.fixture
def bench() -> Bench:
    made = Bench()
    assert made.run(3.0) == 0
    return made


@pytest.mark.parametrize(
    "field, value, bit",
    [
        ("force_z_n", 205.0, GATES["load"]),
        ("force_z_n", math.nan, GATES["load"]),
        ("wheel_speed_m_s", 0.809, GATES["speed"]),
        ("belt_speed_m_s", 0.494, GATES["speed"]),
        ("wheel_speed_m_s", math.nan, GATES["speed"]),
        ("slip_m_s", 0.307, GATES["slip"]),
        ("slip_m_s", math.nan, GATES["slip"]),
        ("surface_c", 42.2, GATES["temperature"]),
        ("surface_c", 37.8, GATES["temperature"]),
    ],
)
def test_each_quantity_closes_its_own_gate_only(bench: Bench, field: str, value: float, bit: int) -> None:
    setattr(bench.readings, field, value)
    assert bench.run(12.0) == bit


def test_a_gate_opens_again_when_its_quantity_is_back(bench: Bench) -> None:
    bench.readings.force_z_n = 240.0
    assert bench.run(1.0) == GATES["load"]
    bench.readings.force_z_n = 200.0
    assert bench.run(0.05) == 0


def test_the_runout_of_the_wheel_does_not_close_the_load_gate(bench: Bench) -> None:
    closed = 0
    for i in range(500):
        bench.readings.force_z_n = 200.0 + 5.0 * math.sin(2.0 * math.pi * 2.83 * i * 0.01)
        closed += bench.run(0.01) != 0
    assert closed == 0


def test_samples_settle_for_a_second_after_touching(bench: Bench) -> None:
    bench.gates.touched_s = bench.readings.now_s
    assert bench.run(0.98) == GATES["settling"]
    assert bench.run(0.03) == 0


def test_a_warming_surface_closes_the_gate_before_it_reads_too_warm(bench: Bench) -> None:
    mask = 0
    while mask == 0 and bench.readings.surface_c < 43.0:
        bench.readings.surface_c += 0.01
        mask = bench.run(0.01)
    assert mask == GATES["temperature"]
    # 1 K/s and a lag of 0.3 s: 0.3 K before the edge, within what the filters leave.
    assert 41.3 < bench.readings.surface_c < 42.0


def test_small_slip_is_gated_by_the_floor() -> None:
    bench = Bench()
    bench.gates.target.slip_m_s = 0.0
    bench.gates.target.belt_speed_m_s = bench.readings.belt_speed_m_s = 0.8
    bench.readings.slip_m_s = 0.0019
    assert bench.run(3.0) == 0
    bench.readings.slip_m_s = 0.0021
    assert bench.run(3.0) == GATES["slip"]


def test_an_average_starts_again_after_a_jump() -> None:
    average = Average(1.0, 10.0)
    for _ in range(100):
        average.update(0.0, 200.0, 0.01)
    assert average.update(200.0, 200.0, 0.01) == pytest.approx(200.0)


def test_an_average_that_was_never_fed_is_unknown() -> None:
    assert math.isnan(Average(1.0, 10.0).value)


def test_the_rate_of_the_surface_is_found_from_its_readings() -> None:
    trend = SurfaceTrend()
    for i in range(60):
        trend.update(20.0 + 0.5 * 0.2 * i, 0.2 * i, 0.3)
    assert trend.rate_k_s == pytest.approx(0.5, rel=0.05)


def test_a_repeated_reading_is_not_taken_twice() -> None:
    trend = SurfaceTrend()
    for _ in range(10):
        trend.update(20.0, 1.0, 0.3)
    trend.update(30.0, 1.0, 0.3)
    assert trend.fast_c == 20.0
