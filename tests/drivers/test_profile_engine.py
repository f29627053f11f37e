"""What a profile can describe: bits, several reads, floats, waits, a controller without a switch."""

from __future__ import annotations

from math import isnan

import pytest

from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink
from drivers.profiles import DeviceProfile, ProfileError, read_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.sensor_slave import SensorSlave
from sim.wires.modbus_wire import Impairment
from tests.drivers.modbus_bench import Bench, reply
from tests.drivers.modbus_rig import Quantities, Rig

HEAD = """
kind = "{kind}"
title = "a device"
functions = [1, 2, 3, 4, {writes}]
{top}
[line]
baud = 38400
parity = "N"
stop_bits = 2
[timing]
turnaround_ms = 2
reply_max_ms = 10
retries = 0
"""
TWO_READS = """
[signals]
force_n = { address = 80, type = "f32", unit = "N", least = -600, greatest = 600 }
status = { address = 5, type = "u8" }
[[reads]]
function = 4
signals = ["force_n"]
period_ms = 50
[[reads]]
function = 2
signals = ["status"]
period_ms = 50
[status]
broken = 3
invalid = [3]
"""
INPUTS = """
[signals]
door = { address = 7, type = "bit", bit = 2 }
air = { address = 7, type = "bit", bit = 9 }
[[reads]]
signals = ["door", "air"]
period_ms = 50
"""
GUARDED = """
[signals]
first_ma = { address = 8, type = "i16", scale = 0.1, unit = "mA" }
second_ma = { address = 9, type = "i16", scale = 0.1, unit = "mA" }
second_state = { address = 10, type = "u16", least = 0, greatest = 0, guards = "second_ma" }
[[reads]]
signals = ["first_ma", "second_ma", "second_state"]
period_ms = 50
"""
ANYWHERE = """
[signals]
pv = { address = 360, type = "f32", unit = "degC", least = -50, greatest = 300 }
output = { address = 1904, type = "f32", unit = "%" }
setpoint = { address = 2172, type = "f32", unit = "degC" }
[[reads]]
signals = ["pv"]
period_ms = 100
[[reads]]
signals = ["output"]
period_ms = 100
[[reads]]
signals = ["setpoint"]
period_ms = 100
[writes]
setpoint = { address = 2160, type = "f32", unit = "degC", least = 0, greatest = 150 }
"""


def profile(rest: str, kind: str = "sensor", top: str = "", writes: str = "5, 6, 15, 16") -> DeviceProfile:
    return read_profile("own", HEAD.format(kind=kind, top=top, writes=writes) + rest)


def sensor(found: DeviceProfile) -> tuple[Rig, Sensor, SensorSlave]:
    slave = SensorSlave(found, 1)
    made = Rig(found.line.baud, slave)
    return made, Sensor(found, 1, made.link), slave


def controller(top: str, rest: str = "") -> tuple[Rig, TemperatureController, ControllerSlave, Quantities]:
    found = profile(ANYWHERE + rest, "jacket", top)
    source = Quantities()
    slave = ControllerSlave(found, 1, source)
    made = Rig(found.line.baud, slave)
    return made, TemperatureController("jacket", found, 1, made.link), slave, source


def test_inputs_are_read_with_function_2_and_the_lowest_bit_is_the_first() -> None:
    bench = Bench()
    one = Sensor(profile(TWO_READS), 1, bench.link)
    bench.serve(0.0)
    for at in (0.02, 0.04):
        bench.serve(at, (at - 0.005, reply(0x4248, 0, function=4)))
    assert bench.frames[2] == with_crc(bytes.fromhex("010200050008"))
    assert not one.valid
    bench.serve(0.06, (0.06, with_crc(bytes.fromhex("01020110"))))
    assert (one.values, one.status, one.valid, one.stamp_s) == ([50.0], 0x10, True, 0.035)


def test_a_reading_is_as_old_as_its_oldest_read_and_invalid_by_the_status_of_another() -> None:
    made, one, slave = sensor(profile(TWO_READS))
    slave.show("force_n", 123.5)
    made.run(1.0)
    assert one.fresh(made.now) and one.values == [123.5]
    slave.status_bits = 1 << 3
    made.run(0.2)
    assert one.status == 8 and not one.valid


def test_bits_of_a_register_are_channels() -> None:
    made, one, slave = sensor(profile(INPUTS))
    slave.show("air", 1.0)
    made.run(0.5)
    assert one.valid and (one.channels, one.values) == (("door", "air"), [0.0, 1.0])
    assert slave.get(7) == 1 << 9


def test_a_number_that_guards_a_channel_is_none_and_its_bounds_make_the_channel_invalid() -> None:
    found = profile(GUARDED)
    bench = Bench()
    both = Sensor(found, 1, bench.link)
    first = Sensor(found, 2, bench.link, channels=("first_ma",))
    for device in (both, first):
        device.take(0, bytes.fromhex("0028 0000 0000"), 1.0)
        assert device.valid
        device.take(0, bytes.fromhex("0028 0000 0001"), 2.0)
    assert both.channels == ("first_ma", "second_ma") and both.values == [4.0, 0.0]
    assert (both.valid, first.valid) == (False, True)


def test_the_set_up_is_read_again_after_a_missing_reply() -> None:
    writes = '[writes]\ngain = { address = 30, type = "u16", default = 7 }\n'
    found = profile(TWO_READS + writes)
    slave = SensorSlave(found, 1)
    made = Rig(found.line.baud, slave)
    one = Sensor(found, 1, made.link)
    made.run(1.0)
    assert one.ready and slave.get(30) == 7
    made.wire.impair = Impairment("silence", count=1)
    made.run(0.5)
    assert one.fresh(made.now)
    slave.put(30, bytes((0, 9)))  # it has restarted
    made.run(0.5)
    assert one.fresh(made.now)
    made.wire.impair = Impairment("silence", count=1)
    made.run(0.5)
    assert not one.ready
    made.run(2.0)
    assert one.fresh(made.now) and slave.get(30) == 7


@pytest.mark.parametrize("guarded", ["third_ma", "second_state", "status"])
def test_a_guard_without_a_channel_is_refused(guarded: str) -> None:
    with pytest.raises(ProfileError, match=f"second_state guards '{guarded}', which is no channel"):
        profile(GUARDED.replace('guards = "second_ma"', f'guards = "{guarded}"'))


@pytest.mark.parametrize(("writes", "frame"), [("5", "01050003FF00"), ("15", "010F000300010101")])
def test_a_coil_is_written_and_read_back(writes: str, frame: str) -> None:
    coil = '[[setup]]\nname = "remote"\naddress = 3\ntype = "bit"\nvalue = 1\n'
    made, one, slave = sensor(profile(INPUTS + coil, writes=writes))
    made.run(0.5)
    assert one.ready and slave.bits[3] == 1
    assert [data for _, data in made.log.requests("01")][1:3] == [
        with_crc(bytes.fromhex(frame)), with_crc(bytes.fromhex("010100030001"))
    ]  # fmt: skip


def test_a_step_waits_for_some_bits_of_a_status() -> None:
    wait = '[[setup]]\nname = "at rest"\naddress = 30\nvalue = 4\nmask = 6\nwrite = false\nwithin_ms = 500\n'
    made, one, slave = sensor(profile(INPUTS + wait))
    slave.put(30, b"\x01\x02")
    made.run(0.3)
    assert not one.ready and one.refused is None
    slave.put(30, b"\x01\x05")
    made.run(0.3)
    assert one.ready


def test_a_controller_s_registers_may_be_anywhere_and_its_status_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    made, jacket, slave, source = controller("standby_c = 0.0")
    made.run(1.0)
    assert jacket.valid and jacket.measured_c == pytest.approx(source.hub_c)
    answer = slave.answer
    output = (1904).to_bytes(2, "big")
    monkeypatch.setattr(slave, "answer", lambda frame, t: None if frame[2:4] == output else answer(frame, t))
    made.run(1.5)
    assert jacket.valid
    made.run(1.5)
    assert not jacket.valid and made.now - jacket.stamp_s < 0.5


def test_without_a_switch_a_setpoint_without_heat_takes_its_place() -> None:
    made, jacket, slave, _ = controller("standby_c = 5.0")
    made.run(0.5)
    assert slave.setpoint_c == 5.0 and not slave.running

    def command() -> None:
        jacket.enable(True)
        jacket.set_setpoint(60.5)

    made.run(1.0, command)
    assert slave.setpoint_c == 60.5 and slave.running
    jacket.enable(False)
    made.run(0.2)
    assert slave.setpoint_c == 5.0 and not slave.running and jacket.setpoint_c == 5.0


def test_after_a_loss_it_stands_by_and_then_follows_the_commands() -> None:
    made, jacket, slave, _ = controller("standby_c = 5.0")
    for celsius in (60.0, 70.0):
        made.run(1.0, lambda celsius=celsius: (jacket.enable(True), jacket.set_setpoint(celsius)))
        assert slave.setpoint_c == celsius
        slave.power(False)
        made.run(1.0)
        slave.power(True)
    made.run(3.0)
    assert slave.setpoint_c == 70.0
    jacket.enable(False)
    slave.power(False)
    made.run(1.0)
    slave.power(True)
    made.run(3.0)
    assert jacket.ready and slave.setpoint_c == 5.0


@pytest.mark.parametrize("top", ["", "standby_c = 0.0\n"])
def test_a_controller_has_a_switch_or_a_setpoint_without_heat(top: str) -> None:
    switch = "[switches]\nrun = { address = 9, on = 1, off = 0, coil = true }\n" if top else ""
    with pytest.raises(ProfileError, match="how to write the setpoint, or to run"):
        TemperatureController("jacket", profile(ANYWHERE + switch, "jacket", top), 1, ModbusLink())


def test_a_step_that_standby_needs_comes_before_it() -> None:
    writing = '[[setup]]\nname = "writing"\naddress = 5\nvalue = 7\nread_back = false\nfirst = true\n'
    made, jacket, _, _ = controller("", "[switches]\nrun = { address = 9, on = 1, off = 0 }\n" + writing)
    made.run(0.5)
    assert jacket.ready
    writes = [data for _, data in made.log.requests("01") if data[1] == 6]
    assert writes[:2] == [with_crc(bytes.fromhex("010600050007")), with_crc(bytes.fromhex("010600090000"))]


def test_a_switch_may_be_a_coil() -> None:
    made, jacket, slave, _ = controller("", "[switches]\nrun = { address = 9, on = 1, off = 0, coil = true }\n")
    made.run(0.5)
    jacket.enable(True)
    made.run(0.2)
    assert slave.running and not isnan(jacket.measured_c)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('type = "u8"', 'type = "u16"', "status is a u16, and function 2 reads none"),
        ("function = 2", "function = 3", "status is a u8, and function 3 reads none"),
        ('["status"]', '["status", "force_n"]', "force_n is a f32, and function 2 reads none"),
        ("[status]", '[[reads]]\nfunction = 4\nsignals = ["force_n"]\nperiod_ms = 50\n[status]', "force_n is in two"),
    ],
)
def test_a_read_that_cannot_be_is_refused(old: str, new: str, message: str) -> None:
    with pytest.raises(ProfileError, match=message):
        profile(TWO_READS.replace(old, new, 1))


@pytest.mark.parametrize(
    ("rest", "writes", "message"),
    [
        ('[[setup]]\nname = "a"\naddress = 1\ntype = "bit"\nvalue = 1\n', "6", "function 5 or 15 writes coils"),
        ('[[setup]]\nname = "a"\naddress = 1\ntype = "bit"\nvalue = 1\nfunction = 3\n', "5", "3 does not read a bit"),
        ('[[setup]]\nname = "a"\naddress = 1\nvalue = 1\nmask = 1\n', "6", "mask: is for a step that waits"),
        ("[switches]\nrun = { address = 9, on = 1, off = 0, coil = true }\n", "6", "no function that writes coils"),
        ("[switches]\nrun = { address = 9, on = 2, off = 0, coil = true }\n", "5", "on: must be a whole number 0..1"),
        ('[writes]\nx = { address = 1, type = "u8" }\n', "5", "writes coils, as bit"),
    ],
)
def test_a_write_that_cannot_be_is_refused(rest: str, writes: str, message: str) -> None:
    with pytest.raises(ProfileError, match=message):
        profile(INPUTS + rest, writes=writes)
