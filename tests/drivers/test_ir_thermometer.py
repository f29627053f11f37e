"""The sensor driver with a thermometer's profile: bytes of the Calex register map, and the simulated line."""

from __future__ import annotations

from math import inf, isnan, nan

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import DeviceProfile, ProfileError, load_profile, read_profile
from drivers.sensor import Sensor
from sim.nodes.sensor_slave import IrSlave
from tests.drivers.modbus_bench import Bench, reply
from tests.drivers.modbus_rig import Quantities, Rig

PROFILE = load_profile("calex_pyrominibus")
EMISSIVITY = with_crc(bytes.fromhex("02060017251C"))
"""0.95 in steps of 0.0001 to the volatile register 0x17."""


def connected() -> tuple[Bench, Sensor]:
    """Return a thermometer that has been set up; its first read is under way."""
    bench = Bench(baud=38400)
    thermometer = Sensor(PROFILE, 2, bench.link, parameters={"emissivity": 0.95})
    bench.serve(0.0)
    bench.serve(0.03, (0.02, reply(17, unit_id=2)))
    bench.serve(0.06, (0.05, EMISSIVITY))
    bench.serve(0.09, (0.08, reply(9500, unit_id=2)))
    return bench, thermometer


def test_type_emissivity_and_its_read_back_come_before_the_first_reading() -> None:
    bench, thermometer = connected()
    assert [frame[:6].hex() for frame in bench.frames] == [
        "020300000001",
        "02060017251c",
        "020300170001",
        "0203000e0004",
    ]
    assert thermometer.ready
    assert thermometer.stamp_s == -inf
    assert isnan(thermometer.values[0])


def test_an_emissivity_that_is_not_kept_is_refused() -> None:
    bench = Bench(baud=38400)
    thermometer = Sensor(PROFILE, 2, bench.link)
    bench.serve(0.0)
    bench.serve(0.03, (0.02, reply(17, unit_id=2)))
    bench.serve(0.06, (0.05, EMISSIVITY))
    bench.serve(0.09, (0.08, reply(10000, unit_id=2)))
    assert thermometer.refused == "emissivity: register holds 10000, expected 9500"


@pytest.mark.parametrize("emissivity", [0.19, 1.01, nan])
def test_an_emissivity_outside_the_device_is_refused(emissivity: float) -> None:
    with pytest.raises(ValueError, match=r"emissivity is 0\.2 to 1"):
        Sensor(PROFILE, 2, Bench().link, parameters={"emissivity": emissivity})


def test_temperatures_are_tenths_of_a_degree_with_sign() -> None:
    bench, thermometer = connected()
    bench.serve(0.12, (0.11, reply(0xFFF6, 0xFFF5, 251, 0, unit_id=2)))
    assert thermometer.values[0] == pytest.approx(-1.0)
    assert thermometer.values[2] == pytest.approx(25.1)
    assert (thermometer.counts[0], thermometer.valid, thermometer.stamp_s) == (-10, True, 0.11)


@pytest.mark.parametrize("bit", range(5))
def test_a_status_bit_makes_the_reading_invalid(bit: int) -> None:
    bench, thermometer = connected()
    bench.serve(0.12, (0.11, reply(400, 400, 250, 1 << bit, unit_id=2)))
    assert not thermometer.valid


def test_a_temperature_beyond_the_device_is_invalid() -> None:
    bench, thermometer = connected()
    bench.serve(0.12, (0.11, reply(0x7FFF, 0x7FFF, 250, 0, unit_id=2)))
    assert not thermometer.valid


def test_five_readings_a_second_or_more() -> None:
    source = Quantities()
    rig = Rig(38400, IrSlave(PROFILE, 2, source), period_s=0.05)
    thermometer = Sensor(PROFILE, 2, rig.link)
    rig.run(10.0)
    assert len(source.asked) >= 50
    assert thermometer.values[0] == pytest.approx(40.0, abs=0.11)
    assert thermometer.valid


def test_emissivity_is_written_again_after_the_device_was_gone() -> None:
    slave = IrSlave(PROFILE, 2, Quantities())
    rig = Rig(38400, slave)
    Sensor(PROFILE, 2, rig.link, parameters={"emissivity": 0.9})
    rig.run(0.5)
    slave.powered = False
    rig.run(2.0)
    slave.power(True)
    rig.run(2.0)
    assert slave.emissivity == pytest.approx(0.9)


def test_a_thermometer_takes_no_tare() -> None:
    with pytest.raises(ValueError, match="no tare"):
        Sensor(PROFILE, 2, Bench().link).set_tare((0.0, 0.0, 0.0))


def test_only_the_requested_channels_count_as_a_change() -> None:
    bench = Bench(baud=38400)
    thermometer = Sensor(PROFILE, 2, bench.link, ("surface",))
    bench.serve(0.0)
    bench.serve(0.03, (0.02, reply(17, unit_id=2)))
    bench.serve(0.06, (0.05, EMISSIVITY))
    bench.serve(0.09, (0.08, reply(9500, unit_id=2)))
    bench.serve(0.12, (0.11, reply(400, 400, 250, 0, unit_id=2)))
    bench.serve(0.36, (0.35, reply(400, 401, 251, 0, unit_id=2)))
    assert (thermometer.values, thermometer.changed_s) == ([40.0], 0.11)


FLOATS = """
kind = "ir_thermometer"
title = "thermometer with floats"
functions = [3, 6, 16]
word_order = "{order}"
byte_order = "{in_words}"
line = {{ baud = 38400, parity = "N" }}
timing = {{ turnaround_ms = 5.0, reply_max_ms = 60.0, retries = 1 }}
[signals]
surface = {{ address = 0, type = "f32", unit = "degC", least = -40.0, greatest = 1000.0 }}
status = {{ address = 2, type = "u16" }}
[[reads]]
signals = ["surface", "status"]
period_ms = 100
[writes]
emissivity = {{ address = 10, type = "{type}", scale = {scale}, least = 0.1, greatest = 1.0, default = 1.0 }}
[status]
error = 0
invalid = [0]
"""


def profile_of(
    type_: str, scale: float = 1.0, order: str = "high_first", in_words: str = "high_first", more: str = ""
) -> DeviceProfile:
    return read_profile("floats", FLOATS.format(type=type_, scale=scale, order=order, in_words=in_words) + more)


@pytest.mark.parametrize("order", ["high_first", "low_first"])
@pytest.mark.parametrize("in_words", ["high_first", "low_first"])
@pytest.mark.parametrize(
    ("type_", "scale"), [("f32", 1.0), ("f32", 0.01), ("u32", 1e-6), ("i32", 1e-6), ("u16", 1e-4), ("i16", 1e-4)]
)
@pytest.mark.parametrize("emissivity", [0.95, 0.8125, 0.1])
def test_an_emissivity_arrives_as_it_was_stated_whatever_its_type(
    type_: str, scale: float, emissivity: float, order: str, in_words: str
) -> None:
    profile = profile_of(type_, scale, order, in_words)
    slave = IrSlave(profile, 2, Quantities())
    rig = Rig(38400, slave)
    thermometer = Sensor(profile, 2, rig.link, parameters={"emissivity": emissivity})
    rig.run(1.0)
    assert slave.emissivity == pytest.approx(emissivity, rel=1e-6 if type_ == "f32" else 0.0, abs=0.5 * scale * 1.001)
    assert thermometer.ready and thermometer.refused is None


def test_a_float_that_is_kept_in_its_first_register_alone_is_refused() -> None:
    profile = profile_of("f32")
    slave = IrSlave(profile, 2, Quantities())
    put = slave.put

    def lossy(address: int, data: bytes) -> None:
        put(address, bytes(2) if address == 11 else data)

    slave.put = lossy  # type: ignore[method-assign]
    rig = Rig(38400, slave)
    thermometer = Sensor(profile, 2, rig.link, parameters={"emissivity": 0.95})
    rig.run(1.0)
    assert thermometer.refused == "emissivity: register holds 3f 73 00 00, expected 3f 73 33 33"


@pytest.mark.parametrize(
    ("type_", "scale", "functions", "message"),
    [
        ("u16", 1.0, "[3, 6, 16]", "scale: 1 is coarser than the range, 0.1 to 1"),
        ("f32", 1.0, "[3, 6]", "type: f32 takes 2 registers, which only function 16 writes"),
    ],
)
def test_a_register_that_cannot_hold_its_range_is_refused(
    type_: str, scale: float, functions: str, message: str
) -> None:
    text = FLOATS.format(type=type_, scale=scale, order="high_first", in_words="high_first").replace(
        "[3, 6, 16]", functions
    )
    with pytest.raises(ProfileError, match=message):
        read_profile("floats", text)


WAITS = """
[[setup]]
name = "password"
address = 20
value = 1234

[[setup]]
name = "range"
address = 22
type = "f32"
value = 12.5

[[setup]]
name = "self-test done"
address = 24
value = 3
write = false
within_ms = 1000
"""


def waiting(holds_after_s: float) -> tuple[Rig, Sensor, IrSlave]:
    """Return a thermometer whose self-test ends after a time."""
    profile = profile_of("f32", more=WAITS)
    slave = IrSlave(profile, 2, Quantities())
    slave.put(24, bytes(2))
    rig = Rig(38400, slave)
    thermometer = Sensor(profile, 2, rig.link)
    rig.run(holds_after_s)
    assert not thermometer.ready
    return rig, thermometer, slave


def test_a_set_up_waits_until_a_register_holds_its_value() -> None:
    rig, thermometer, slave = waiting(0.7)
    slave.put(24, (3).to_bytes(2, "big"))
    rig.run(1.2)
    assert thermometer.ready and slave.get(20) == 1234 and (slave.get(22), slave.get(23)) == (0x4148, 0)


def test_a_set_up_that_waits_in_vain_refuses_the_device() -> None:
    rig, thermometer, _ = waiting(0.7)
    rig.run(2.5)
    assert thermometer.refused == "self-test done: register holds 0, expected 3"


@pytest.mark.parametrize(
    ("type_", "value", "message"),
    [
        ("u16", "70000", "whole number 0..65535 for u16, not 70000"),
        ("i16", "1.5", "whole number -32768..32767 for i16, not 1.5"),
        ("u16", "inf", "whole number 0..65535"),
        ("f32", "1e39", "does not fit into its register"),
    ],
)
def test_a_set_up_value_that_its_register_cannot_hold_is_refused(type_: str, value: str, message: str) -> None:
    step = f'[[setup]]\nname = "range"\naddress = 22\ntype = "{type_}"\nvalue = {value}\n'
    with pytest.raises(ProfileError, match=message):
        profile_of("f32", more=step)
