"""The jacket's driver against bytes of the Eurotherm register map, and on the simulated line."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isnan, nan

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import load_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.sensor_slave import IrSlave
from sim.wires.modbus_wire import Impairment
from tests.drivers.modbus_bench import Bench, refusal, reply
from tests.drivers.modbus_rig import Quantities, Rig

PROFILE = load_profile("simulated_jacket")


def answer(bench: Bench, registers: dict[int, tuple[int, ...]], now: float) -> None:
    """Answer the request sent last: an echo to a write, registers from the first address to a read."""
    frame = bench.frames[-1]
    data = frame if frame[1] == 6 else reply(*registers[int.from_bytes(frame[2:4], "big")])
    bench.serve(now, (now - 0.005, data))


def connected(now: float = 0.5) -> tuple[Bench, TemperatureController]:
    """Return a jacket that has been set up with nothing wanted; its first read is under way."""
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", PROFILE, 1, bench.link)
    bench.serve(0.0)
    at = 0.0
    while not jacket.ready:
        at += 0.03
        answer(bench, {276: (1,), 5000: (20,)}, at)
    return bench, jacket


def rig() -> tuple[Rig, TemperatureController, ControllerSlave, Quantities]:
    source = Quantities()
    slave = ControllerSlave(PROFILE, 1, source)
    made = Rig(38400, slave)
    return made, TemperatureController("jacket", PROFILE, 1, made.link), slave, source


class Command:
    """Do an engine's work of one scan."""

    def __init__(self, jacket: TemperatureController, celsius: float) -> None:
        self.jacket = jacket
        self.celsius = celsius

    def __call__(self) -> None:
        self.jacket.enable(True)
        self.jacket.set_setpoint(self.celsius)


def test_set_up_is_standby_remote_setpoint_and_off_line_time_each_read_back() -> None:
    bench, _ = connected()
    assert [frame[:6].hex() for frame in bench.frames[:5]] == [
        "010600c70001",  # 199: standby
        "010601140001",  # 276: remote setpoint
        "010301140001",
        "010613880014",  # 5000: 2.0 s
        "010313880001",
    ]


def test_an_off_line_time_that_is_not_kept_is_refused() -> None:
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", PROFILE, 1, bench.link)
    bench.serve(0.0)
    for number in range(1, 6):
        answer(bench, {276: (1,), 5000: (0,)}, 0.03 * number)
    assert jacket.refused == "off-line time: register holds 0, expected 20"


def test_a_controller_without_the_watchdog_register_is_refused_with_the_address() -> None:
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", PROFILE, 1, bench.link)
    bench.serve(0.0)
    for number in range(1, 4):
        answer(bench, {276: (1,)}, 0.03 * number)
    bench.serve(0.12, (0.115, refusal(2, function=6)))
    assert jacket.refused == "exception 2 (illegal data address) on writing 1 register from address 5000"


def test_a_profile_without_lease_reports_it() -> None:
    assert not TemperatureController("jacket", load_profile("omron_e5cc"), 1, Bench().link).has_lease
    assert TemperatureController("jacket", PROFILE, 1, Bench().link).has_lease


def test_readings_come_from_one_block_of_five_and_the_status() -> None:
    bench, jacket = connected()
    seen: set[str] = set()
    for number in range(1, 8):
        frame = bench.frames[-1]
        seen.add(frame[:6].hex())
        answer(bench, {1: (853, 0, 0, 425, 900), 75: (0,)}, 0.5 + 0.03 * number)
    assert {"010300010005", "0103004b0001"} <= seen
    assert (jacket.measured_c, jacket.output_percent, jacket.setpoint_c) == pytest.approx((85.3, 42.5, 90.0))
    assert jacket.valid
    assert jacket.counts == 853


def test_without_the_status_a_reading_is_not_valid() -> None:
    bench, jacket = connected()
    bench.serve(0.6, (0.55, reply(853, 0, 0, 425, 900)))
    assert jacket.stamp_s > -inf
    assert not jacket.valid


def test_a_sensor_break_hides_the_temperature() -> None:
    made, jacket, slave, _ = rig()
    made.run(1.0)
    assert jacket.valid
    slave.sensor_broken = True
    made.run(0.4)
    assert not jacket.valid
    made.run(0.6)
    assert jacket.sensor_break
    assert isnan(jacket.measured_c)


def test_an_implausible_temperature_is_never_shown() -> None:
    bench, jacket = connected()
    for number in range(1, 8):
        answer(bench, {1: (0x7FFF, 0, 0, 0, 0), 75: (0,)}, 0.5 + 0.03 * number)
    assert isnan(jacket.measured_c)
    assert not jacket.valid


def test_the_setpoint_goes_to_the_volatile_remote_register_in_tenths() -> None:
    made, jacket, slave, _ = rig()
    made.run(1.0, Command(jacket, 87.34))
    assert made.log.requests("0106001A0369")
    assert slave.setpoint_c == pytest.approx(87.3)
    assert jacket.setpoint_c == pytest.approx(87.3)


@pytest.mark.parametrize("address", ["0002", "0018", "0019"])
def test_registers_that_wear_out_are_never_written(address: str) -> None:
    made, jacket, _, _ = rig()
    made.run(5.0, Command(jacket, 80.0))
    assert not made.log.requests("0106" + address)
    assert not made.log.requests("0110")


@pytest.mark.parametrize(("asked", "given"), [(-20.0, 0.0), (500.0, 150.0)])
def test_the_setpoint_stays_inside_the_profiles_bounds(asked: float, given: float) -> None:
    made, jacket, slave, _ = rig()
    made.run(1.0, Command(jacket, asked))
    assert slave.setpoint_c == given


@pytest.mark.parametrize("celsius", [nan, inf, -inf])
def test_a_setpoint_that_is_no_number_is_refused(celsius: float) -> None:
    jacket = TemperatureController("jacket", PROFILE, 1, Bench().link)
    with pytest.raises(ValueError, match="finite"):
        jacket.set_setpoint(celsius)


def test_both_commands_are_written_twice_a_second() -> None:
    made, jacket, _, _ = rig()
    made.run(1.0, Command(jacket, 80.0))
    made.log.frames.clear()
    made.run(10.0, Command(jacket, 80.0))
    for head in ("0106001A", "010600C7"):
        assert 20 <= len(made.log.requests(head)) <= 23


def test_the_device_stands_by_two_seconds_after_the_computer_fell_silent() -> None:
    made, jacket, slave, source = rig()
    made.run(2.0, Command(jacket, 80.0))
    assert slave.heater_w > 0.0
    t = made.now
    while slave.heater_w > 0.0:
        slave.advance(made.now, made.now)
        made.now += 0.01
    assert 1.4 < made.now - t < 2.3
    assert source.hub_c == 45.0


def test_a_setpoint_that_is_not_asked_for_any_more_is_not_renewed() -> None:
    made, jacket, slave, _ = rig()
    made.run(2.0, Command(jacket, 80.0))
    made.run(4.0)
    assert slave.heater_w == 0.0
    assert jacket.lease_expired
    made.run(2.0, Command(jacket, 80.0))
    assert slave.heater_w > 0.0
    assert not jacket.lease_expired


def test_standby_goes_before_everything_else() -> None:
    made, jacket, slave, _ = rig()
    made.run(2.0, Command(jacket, 80.0))
    made.log.frames.clear()
    jacket.enable(False)
    made.run(0.05)
    written = made.log.requests("010600C70001")
    assert len(written) == 1
    assert sum(1 for _, _, from_pc in made.log.frames if from_pc) <= 3
    assert not slave.running


def test_before_the_first_command_the_controller_stands_by() -> None:
    made, _, slave, _ = rig()
    slave.running = True
    made.run(1.0)
    assert not slave.running


def test_a_controller_that_lost_its_supply_is_set_up_again_before_it_heats() -> None:
    made, jacket, slave, _ = rig()
    made.run(2.0, Command(jacket, 80.0))
    slave.power(False)
    made.run(2.0, Command(jacket, 80.0))
    assert (jacket.is_lost, jacket.valid) == (True, False)
    slave.power(True)
    made.log.frames.clear()
    made.run(2.0, Command(jacket, 80.0))
    assert jacket.valid
    assert slave.running
    heads = [data[:6].hex() for _, data, from_pc in made.log.frames if from_pc]
    assert heads.index("010600c70001") < heads.index("010613880014") < heads.index("010600c70000")


def test_jacket_and_thermometer_share_a_line_at_five_readings_a_second_each() -> None:
    source = Quantities()
    infrared = load_profile("calex_pyrominibus")
    made = Rig(38400, ControllerSlave(PROFILE, 1, source), IrSlave(infrared, 2, source), period_s=0.05)
    jacket = TemperatureController("jacket", PROFILE, 1, made.link)
    thermometer = Sensor(infrared, 2, made.link)
    made.run(2.0, Command(jacket, 60.0))
    made.log.frames.clear()
    made.run(10.0, Command(jacket, 60.0))
    assert len(made.log.requests("010300010005")) >= 50
    assert len(made.log.requests("0203000E0004")) >= 50
    assert len(made.log.requests("0106001A")) >= 20
    assert made.wire.collisions == 0
    assert thermometer.valid
    assert jacket.valid


def test_a_silent_thermometer_does_not_make_the_jacket_stale_or_its_lease_run_out() -> None:
    source = Quantities()
    infrared = load_profile("calex_pyrominibus")
    slave = ControllerSlave(PROFILE, 1, source)
    made = Rig(38400, slave, IrSlave(infrared, 2, source), period_s=0.05)
    jacket = TemperatureController("jacket", PROFILE, 1, made.link)
    thermometer = Sensor(infrared, 2, made.link)
    made.run(2.0, Command(jacket, 60.0))
    made.wire.impair = Impairment("silence", count=-1, unit_id=2)
    for _ in range(100):
        made.run(0.1, Command(jacket, 60.0))
        assert made.now - jacket.stamp_s < 0.6
        assert slave.running
    assert thermometer.is_lost


def test_slip_ring_chatter_is_counted_and_never_becomes_a_reading() -> None:
    made, jacket, _, source = rig()
    made.run(1.0, Command(jacket, 60.0))
    for number in range(60):
        kinds = ("corrupt", "silence", "truncate", "noise", "wrong_id", "stale")
        made.wire.impair = Impairment(kinds[number % 6], count=1)  # type: ignore[arg-type]
        made.run(0.1, Command(jacket, 60.0))
        assert isnan(jacket.measured_c) or jacket.measured_c == pytest.approx(source.hub_c, abs=0.11)
    counters = jacket.station.counters
    assert counters.crc_errors > 0
    assert counters.timeouts > 0
    assert jacket.refused is None


def test_omron_run_and_stop_are_operation_commands() -> None:
    profile = load_profile("omron_e5cc")
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", profile, 1, bench.link)
    jacket.enable(True)
    bench.serve(0.0)
    for number in range(1, 5):
        answer(bench, {0x2000: (850, 0, 900, 0, 425)}, 0.03 * number)
    heads = [frame[:6].hex() for frame in bench.frames]
    assert heads[:3] == ["010600000001", "010600000101", "010600000401"]
    assert "010600000100" in heads


def test_an_echo_of_the_wrong_register_does_not_end_the_set_up() -> None:
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", PROFILE, 1, bench.link)
    bench.serve(0.0)
    bench.serve(0.03, (0.02, with_crc(bytes.fromhex("010600C80001"))))
    assert not jacket.ready
    assert len(bench.frames) == 1


# the real controller, which has no lease -----------------------------------------------------------------------------

REAL = load_profile("eurotherm_3200")


def test_without_a_lease_the_setpoint_that_it_falls_back_to_is_set_and_read_back() -> None:
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", REAL, 1, bench.link)
    bench.serve(0.0)
    at = 0.0
    while not jacket.ready:
        at += 0.03
        answer(bench, {24: (0,), 15: (0,), 276: (1,)}, at)
    assert [frame[:6].hex() for frame in bench.frames[:7]] == [
        "010600c70001",  # 199: standby
        "010600180000",  # 24: SP1 0 degC
        "010300180001",
        "0106000f0000",  # 15: SP1 selected
        "0103000f0001",
        "010601140001",  # 276: remote setpoint
        "010301140001",
    ]
    assert (jacket.has_lease, jacket.ends_s) == (False, 5.0)


def test_a_controller_that_keeps_another_fallback_setpoint_is_refused() -> None:
    bench = Bench(baud=38400)
    jacket = TemperatureController("jacket", REAL, 1, bench.link)
    bench.serve(0.0)
    for number in range(1, 4):
        answer(bench, {24: (800,)}, 0.03 * number)
    assert jacket.refused == "setpoint 1, to which it falls back: register holds 800, expected 0"


def test_without_setpoints_the_real_controller_stops_heating_after_5_s_and_reports_it() -> None:
    source = Quantities()
    slave = ControllerSlave(REAL, 1, source)
    made = Rig(38400, slave)
    jacket = TemperatureController("jacket", REAL, 1, made.link)
    made.run(3.0, Command(jacket, 80.0))
    assert slave.heater_w > 0.0
    made.run(4.0)
    assert slave.heater_w > 0.0
    made.run(3.0)
    assert (slave.heater_w, slave.setpoint_c, jacket.lease_expired) == (0.0, 0.0, True)
    made.run(2.0, Command(jacket, 80.0))
    assert slave.heater_w > 0.0
    assert not jacket.lease_expired


def test_a_setpoint_that_is_a_float_goes_out_in_two_registers_by_function_16() -> None:
    writes = PROFILE.writes | {"setpoint": replace(PROFILE.writes["setpoint"], type="f32", scale=1.0)}
    made = Rig(38400, ControllerSlave(PROFILE, 1, Quantities()))
    jacket = TemperatureController("jacket", replace(PROFILE, writes=writes), 1, made.link)
    made.run(2.0, Command(jacket, 41.5))
    head = "0110" + PROFILE.writes["setpoint"].address.to_bytes(2, "big").hex() + "000204"
    assert made.log.requests(head)[-1][1][7:11].hex() == "42260000"  # 41.5 as a float, not 42
