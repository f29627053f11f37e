"""The sensors that come as ready profiles, against the bytes of their makers' maps."""

from __future__ import annotations

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from sim.nodes.sensor_slave import SensorSlave
from tests.drivers.modbus_bench import Bench, reply
from tests.drivers.modbus_rig import Rig


def first_reading(profile: str, *registers: int, function: int = 3) -> tuple[Bench, Sensor]:
    """Return a sensor that was answered with these registers."""
    bench = Bench()
    sensor = Sensor(load_profile(profile), 1, bench.link)
    bench.serve(0.0)
    bench.serve(0.03, (0.025, reply(*registers, function=function)))
    return bench, sensor


@pytest.mark.parametrize(
    ("registers", "degc", "percent"), [((0x0131, 0x0222), 30.5, 54.6), ((0xFF33, 0), -20.5, 0.0)]
)
def test_the_hygrometer_s_own_example_is_read(registers: tuple[int, int], degc: float, percent: float) -> None:
    bench, sensor = first_reading("hygrometer_sht20", *registers, function=4)
    assert bench.frames[0] == with_crc(bytes.fromhex("010400010002"))
    assert sensor.channels == ("ambient_c", "humidity_percent")
    assert sensor.values == pytest.approx([degc, percent])
    assert sensor.valid


@pytest.mark.parametrize("registers", [(0x0131, 1001), (601, 0x0222), (0x8000, 0)])
def test_values_that_the_hygrometer_cannot_measure_are_invalid(registers: tuple[int, int]) -> None:
    assert not first_reading("hygrometer_sht20", *registers, function=4)[1].valid


def test_the_torque_transducer_has_both_signs_and_a_tare() -> None:
    bench, sensor = first_reading("torque_dat_400", 0, 0xFFFF, 0xFB2E)
    assert bench.frames[0] == with_crc(bytes.fromhex("010300000003"))
    assert sensor.values == [pytest.approx(-12.34)]
    sensor.set_tare((-12.0,))
    assert sensor.values == [pytest.approx(-0.34)]


@pytest.mark.parametrize("bit", [4, 5, 6])
def test_a_torque_beyond_its_range_is_invalid(bit: int) -> None:
    assert not first_reading("torque_dat_400", 1 << bit, 0, 100)[1].valid


def test_the_torque_transducer_saturates_at_98_percent_of_its_range() -> None:
    assert first_reading("torque_dat_400", 0, 0, 4899)[1].valid
    assert not first_reading("torque_dat_400", 0, 0, 4900)[1].valid


@pytest.mark.parametrize(
    ("profile", "shows"),
    [
        ("hygrometer_sht20", {"ambient_c": 23.4, "humidity_percent": 45.6}),
        ("torque_dat_400", {"torque_nm": -7.89}),
        ("moxa_e1240", {"input_0": 4.0, "input_1": 20.0, "input_2": 12.5, "input_3": -1.0}),
        ("flintec_dad141", {"force": -123.5}),
        ("seneca_z_sg", {"force": 250.25}),
        ("raytek_mi3", {"surface": 85.3, "sensor": 31.0}),
    ],
)
def test_the_simulated_one_answers_on_the_wire(profile: str, shows: dict[str, float]) -> None:
    data = load_profile(profile)
    made = Rig(data.line.baud, SensorSlave(data, 1, shows))
    sensor = Sensor(data, 1, made.link)
    made.run(3.0)
    assert sensor.valid
    step = max(1e-4 if data.signal(name).type == "f32" else data.signal(name).scale for name in sensor.channels)
    assert sensor.values == pytest.approx(list(shows.values()), abs=step)
    assert sensor.station.counters.timeouts == 0
