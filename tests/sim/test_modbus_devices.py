"""The simulated load-cell transmitter, thermometer and temperature controller, asked with bare frames."""

from __future__ import annotations

import copy
from math import floor, nan

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import ProfileError, load_profile
from sim.nodes.control_loop import JACKET_CYCLE_S
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.modbus_slave import PATTERN, ModbusSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave
from tests.drivers.modbus_rig import Quantities

CELL = load_profile("four_axis_transmitter")
INFRARED = load_profile("calex_pyrominibus")
JACKET = load_profile("simulated_jacket")


def read(slave: ModbusSlave, address: int, count: int, t: float = 0.0) -> bytes:
    """Return the registers."""
    head = bytes((slave.unit_id, 3))
    reply = slave.answer(with_crc(head + address.to_bytes(2, "big") + count.to_bytes(2, "big")), t)
    assert reply is not None
    assert reply[:3] == head + bytes((2 * count,))
    return reply[3:-2]


def write(slave: ModbusSlave, address: int, value: int, t: float = 0.0) -> bytes:
    """Return the reply."""
    head = bytes((slave.unit_id, 6))
    reply = slave.answer(with_crc(head + address.to_bytes(2, "big") + value.to_bytes(2, "big")), t)
    assert reply is not None
    return reply[:-2]


# the last bit


@pytest.mark.parametrize("value", [0.0, 0.25, -0.3, 7.5, 1e4 + 0.49])
def test_a_value_at_rest_changes_by_exactly_one_count_and_keeps_its_mean(value: float) -> None:
    counts = [floor(value + step) for step in PATTERN]
    assert max(counts) - min(counts) == 1
    assert sum(counts) / 4 == pytest.approx(value, abs=0.2501)


@pytest.mark.parametrize("made", ["cell", "thermometer", "controller"])
def test_a_block_asked_for_often_reads_as_the_registers_one_by_one(made: str) -> None:
    source = Quantities()
    source.forces = (123.4, -5678.9, 210.1, 0.377)
    slave, profile = {
        "cell": lambda: (CellSlave(CELL, 1, source), CELL),
        "thermometer": lambda: (IrSlave(INFRARED, 1, source), INFRARED),
        "controller": lambda: (ControllerSlave(JACKET, 1, source), JACKET),
    }[made]()
    if isinstance(slave, ControllerSlave):
        slave.advance(0.0, 1.0)
    for block in profile.blocks:
        for _ in range(5):
            slave.dither = 0
            together = read(slave, block.address, block.count)
            one_by_one = b""
            for address in range(block.address, block.address + block.count):
                slave.dither = 0
                one_by_one += read(slave, address, 1)
            assert together == one_by_one


# load cell


def test_forces_are_sampled_when_the_request_arrives() -> None:
    source = Quantities()
    slave = CellSlave(CELL, 1, source)
    read(slave, 0, 9, 3.25)
    assert source.asked == [3.25]


def test_forces_are_counts_of_the_profile_in_its_order() -> None:
    source = Quantities()
    source.forces = (100.01, -20.01, 200.01, 0.5001)
    counts = CELL.blocks[0].unpack(read(CellSlave(CELL, 1, source), 0, 9))
    assert counts == (pytest.approx(2000, abs=1), pytest.approx(-400, abs=1), pytest.approx(4000, abs=1), 500, 0)


def test_a_channel_beyond_its_range_is_cut_off_and_flagged() -> None:
    source = Quantities()
    source.forces = (5000.0, 0.0, -5000.0, 0.0)
    fx, _, fz, _, status = CELL.blocks[0].unpack(read(CellSlave(CELL, 1, source), 0, 9))
    assert (fx, fz, status) == (20_000, -12_000, 1 << 2)


def test_a_broken_bridge_shows_in_the_status() -> None:
    slave = CellSlave(CELL, 1, Quantities())
    slave.status_bits = 1
    assert read(slave, 8, 1) == b"\x00\x01"


def test_a_frozen_cell_gives_the_same_counts_for_ever() -> None:
    source = Quantities()
    slave = CellSlave(CELL, 1, source)
    first = read(slave, 0, 9)
    slave.frozen = True
    source.forces = (0.0, 0.0, 0.0, 0.0)
    assert [read(slave, 0, 9) for _ in range(4)] == [first] * 4


def test_the_same_forces_after_a_reset_of_the_dither_are_the_same_counts() -> None:
    slave = CellSlave(CELL, 1, Quantities())
    first = [read(slave, 0, 9) for _ in range(3)]
    slave.dither = 0
    assert [read(slave, 0, 9) for _ in range(3)] == first


def test_forces_cannot_be_written() -> None:
    assert write(CellSlave(CELL, 1, Quantities()), 0, 1) == bytes.fromhex("018602")


def test_the_type_can_be_read() -> None:
    assert read(CellSlave(CELL, 1, Quantities()), 100, 1) == bytes.fromhex("4658")


def test_a_one_channel_transmitter_puts_the_sign_into_the_status() -> None:
    profile = load_profile("laumas_tlb")
    source = Quantities()
    source.forces = (0.0, 0.0, -98.07, 0.0)
    status, magnitude = profile.blocks[0].unpack(read(CellSlave(profile, 1, source, {"force": "fz"}), 6, 3))
    assert (status, magnitude) == (1 << 7, pytest.approx(1000, abs=1))


# infrared thermometer


def test_a_surface_is_tenths_of_a_degree_filtered_and_unfiltered() -> None:
    source = Quantities()
    source.surface_c = -12.31
    surface, unfiltered, sensor, status = INFRARED.blocks[0].unpack(read(IrSlave(INFRARED, 2, source), 0x0E, 4))
    assert (surface, unfiltered, sensor, status) == (pytest.approx(-123, abs=1), surface, pytest.approx(250, abs=1), 0)


def test_a_surface_that_cannot_be_measured_is_a_measurement_error() -> None:
    source = Quantities()
    source.surface_c = nan
    assert read(IrSlave(INFRARED, 2, source), 0x11, 1) == b"\x00\x01"


def test_emissivity_is_kept_within_the_device() -> None:
    slave = IrSlave(INFRARED, 2, Quantities())
    assert slave.emissivity == 1.0
    assert write(slave, 0x17, 9500) == bytes.fromhex("02060017251c")
    assert slave.emissivity == pytest.approx(0.95)
    assert write(slave, 0x17, 1000) == bytes.fromhex("028603")
    assert slave.emissivity == pytest.approx(0.95)


@pytest.mark.parametrize("address", [0x00, 0x0E, 0x11])
def test_measured_values_cannot_be_written(address: int) -> None:
    assert write(IrSlave(INFRARED, 2, Quantities()), address, 0) == bytes.fromhex("028602")


# temperature controller


class Hub:
    """420 J/K with 20 W/K to 128 J/K of rubber, which loses 0.3 W/K to air; hub sensor lag 1 s."""

    def __init__(self, celsius: float = 23.0) -> None:
        self.hub_c = self.rubber_c = self.sensor_c = celsius
        self.heater_w = 0.0

    def controller_measured_c(self, t: float) -> float:
        return self.sensor_c

    def advance(self, dt: float) -> None:
        flow_w = 20.0 * (self.hub_c - self.rubber_c)
        self.hub_c += (self.heater_w - flow_w - 0.15 * (self.hub_c - 23.0)) * dt / 420.0
        self.rubber_c += (flow_w - 0.3 * (self.rubber_c - 23.0)) * dt / 128.0
        self.sensor_c += (self.hub_c - self.sensor_c) * dt / 1.0


class Oven:
    """Controller and hub, in steps of 50 ms; the setpoint is renewed twice a second unless ``renew`` is off."""

    def __init__(self) -> None:
        self.hub = Hub()
        self.slave = ControllerSlave(JACKET, 1, self.hub)
        self.t = 0.0
        self.renew = True
        self.hottest = -1e9

    def start(self, celsius: float) -> None:
        self.setpoint = celsius
        write(self.slave, 5000, 20, self.t)
        write(self.slave, 26, round(10 * celsius), self.t)
        write(self.slave, 199, 0, self.t)

    def run(self, seconds: float) -> None:
        for number in range(round(seconds / 0.05)):
            if self.renew and number % 10 == 0:
                write(self.slave, 26, round(10 * self.setpoint), self.t)
            self.slave.advance(self.t, self.t + 0.05)
            self.hub.heater_w = self.slave.heater_w
            self.hub.advance(0.05)
            self.t += 0.05
            self.hottest = max(self.hottest, self.hub.hub_c)


@pytest.mark.parametrize("setpoint", [40.0, 85.0, 130.0])
def test_the_hub_follows_its_setpoint_with_less_than_2_k_of_overshoot(setpoint: float) -> None:
    oven = Oven()
    oven.start(setpoint)
    oven.run(700.0)
    assert oven.hottest < setpoint + 2.0
    assert oven.hub.hub_c == pytest.approx(setpoint, abs=0.2)


def test_a_long_time_at_full_power_does_not_wind_the_integral_up() -> None:
    oven = Oven()
    oven.start(140.0)
    oven.run(120.0)
    assert oven.slave.heater_w == pytest.approx(200.0)
    oven.setpoint = 60.0
    write(oven.slave, 26, 600, oven.t)
    oven.run(1.0)
    assert oven.slave.heater_w == 0.0


@pytest.mark.parametrize("rise_k_s", [0.1, 0.3])
def test_a_setpoint_that_rises_and_then_stops_is_overshot_by_less_than_2_k(rise_k_s: float) -> None:
    oven = Oven()
    oven.start(23.0)
    while oven.setpoint < 100.0:
        oven.setpoint += rise_k_s
        oven.run(1.0)
    oven.run(200.0)
    assert oven.hottest < oven.setpoint + 2.0


def test_a_setpoint_that_rises_slowly_is_followed() -> None:
    oven = Oven()
    oven.start(40.0)
    oven.run(400.0)
    for _ in range(100):
        oven.setpoint += 0.1
        oven.run(1.0)
        assert abs(oven.hub.hub_c - oven.setpoint) < 2.0


def test_in_standby_there_is_no_heat() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(10.0)
    write(oven.slave, 199, 1, oven.t)
    oven.run(2 * JACKET_CYCLE_S)
    assert oven.slave.heater_w == 0.0


def test_a_controller_starts_in_standby() -> None:
    slave = ControllerSlave(JACKET, 1, Hub())
    slave.advance(0.0, 1.0)
    assert read(slave, 199, 1) == b"\x00\x01"
    assert slave.heater_w == 0.0


@pytest.mark.parametrize(("asked", "given"), [(2000, 150.0), (0xFF38, 0.0), (853, 85.3)])
def test_the_setpoint_is_kept_between_0_and_150(asked: int, given: float) -> None:
    slave = ControllerSlave(JACKET, 1, Hub())
    write(slave, 26, asked)
    assert slave.setpoint_c == pytest.approx(given)
    assert int.from_bytes(read(slave, 5, 1), "big") == round(10 * given)


def test_without_setpoints_the_lease_runs_out_after_two_seconds() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(5.0)
    oven.renew = False
    oven.run(1.4)
    assert oven.slave.heater_w > 0.0
    oven.run(1.0)
    assert oven.slave.heater_w == 0.0
    assert not oven.slave.running
    assert int.from_bytes(read(oven.slave, 75, 1), "big") == 1 << 14


def test_a_setpoint_alone_does_not_start_it_again() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.renew = False
    oven.run(4.0)
    oven.renew = True
    oven.run(2.0)
    assert oven.slave.heater_w == 0.0
    write(oven.slave, 199, 0, oven.t)
    oven.run(1.0)
    assert oven.slave.heater_w > 0.0


def test_run_without_a_setpoint_gives_no_heat() -> None:
    oven = Oven()
    write(oven.slave, 5000, 20)
    write(oven.slave, 199, 0)
    oven.renew = False
    oven.run(5.0)
    assert oven.hub.hub_c == pytest.approx(23.0)


def test_off_line_time_0_means_no_lease() -> None:
    oven = Oven()
    oven.start(80.0)
    write(oven.slave, 5000, 0)
    oven.renew = False
    oven.run(10.0)
    assert oven.slave.heater_w > 0.0


def test_the_limiter_latches_until_standby_and_cool() -> None:
    oven = Oven()
    oven.start(100.0)
    oven.slave.stuck_output = None
    oven.hub.sensor_c = oven.hub.hub_c = 156.0
    oven.run(2 * JACKET_CYCLE_S)
    assert oven.slave.limited
    assert int.from_bytes(read(oven.slave, 75, 1), "big") & 1
    oven.hub.sensor_c = oven.hub.hub_c = 90.0
    oven.run(1.0)
    assert oven.slave.heater_w == 0.0
    write(oven.slave, 199, 1, oven.t)
    oven.run(1.0)
    write(oven.slave, 199, 0, oven.t)
    oven.run(1.0)
    assert oven.slave.heater_w > 0.0


@pytest.mark.parametrize("way", ["flag", "nan"])
def test_a_broken_sensor_takes_the_heat_off(way: str) -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(5.0)
    if way == "flag":
        oven.slave.sensor_broken = True
    else:
        oven.hub.sensor_c = nan
    oven.slave.advance(oven.t, oven.t + 0.25)
    assert oven.slave.heater_w == 0.0
    assert int.from_bytes(read(oven.slave, 75, 1), "big") == 1 << 5 | 1 << 10
    assert read(oven.slave, 1, 1) == bytes.fromhex("7FFF")


def test_temperature_and_output_are_those_of_the_last_cycle() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(1.0)
    pv, output, setpoint = JACKET.blocks[0].unpack(read(oven.slave, 1, 5))
    assert (pv, output, setpoint) == (pytest.approx(231, abs=4), 1000, 800)


def test_the_loop_runs_eight_times_a_second_whatever_the_ticks() -> None:
    for tick_s in (0.001, 0.01, 0.1, 0.5):
        source = Quantities()
        slave = ControllerSlave(JACKET, 1, source)
        for number in range(round(2.0 / tick_s)):
            slave.advance(number * tick_s, (number + 1) * tick_s)
        assert len(source.asked) == pytest.approx(17, abs=1)


def test_a_late_start_of_the_clock_does_not_run_cycles_of_the_past() -> None:
    source = Quantities()
    ControllerSlave(JACKET, 1, source).advance(1e6, 1e6 + 0.01)
    assert len(source.asked) == 1


@pytest.mark.parametrize(("address", "value"), [(199, 7), (5000, 60_000), (276, 5)])
def test_values_it_does_not_know_are_refused(address: int, value: int) -> None:
    assert write(ControllerSlave(JACKET, 1, Hub()), address, value) == bytes.fromhex("018603")


def test_measured_registers_cannot_be_written() -> None:
    assert write(ControllerSlave(JACKET, 1, Hub()), 1, 0) == bytes.fromhex("018602")


def test_without_supply_there_is_neither_answer_nor_heat() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(5.0)
    oven.slave.power(False)
    assert oven.slave.heater_w == 0.0
    assert oven.slave.answer(with_crc(bytes.fromhex("010300010005")), oven.t) is None
    oven.slave.power(True)
    oven.run(1.0)
    assert oven.slave.heater_w == 0.0


def test_the_other_controllers_profile_also_works() -> None:
    slave = ControllerSlave(load_profile("omron_e5cc"), 1, Quantities())
    write(slave, 0x2103, 900)
    write(slave, 0x0000, 0x0100)
    slave.advance(0.0, 1.0)
    assert slave.running
    assert slave.heater_w > 0.0


def test_a_profile_of_another_kind_is_refused() -> None:
    with pytest.raises(ProfileError, match="not a load_cell"):
        CellSlave(JACKET, 1, Quantities())


def test_a_copy_of_controller_and_hub_lives_on_its_own() -> None:
    oven = Oven()
    oven.start(80.0)
    oven.run(5.0)
    twin = copy.deepcopy(oven)
    twin.run(5.0)
    oven.run(5.0)
    assert twin.hub.hub_c == oven.hub.hub_c
    assert twin.hub is not oven.hub


# non-volatile memory


def test_only_a_changed_value_is_written_to_memory_and_the_remote_setpoint_never() -> None:
    jacket = ControllerSlave(JACKET, 1, Quantities())
    for value in (20, 20, 20, 30):
        write(jacket, 5000, value)
        write(jacket, 26, 10 * value)
    assert jacket.wear == {5000: 2}


def test_a_memory_worn_out_refuses_a_change_with_exception_04_and_keeps_the_value() -> None:
    jacket = ControllerSlave(JACKET, 1, Quantities())
    write(jacket, 199, 0)
    jacket.endurance = 1
    assert write(jacket, 199, 1).hex() == "018604"
    assert jacket.running and jacket.get(199) == 0
    assert write(jacket, 199, 0).hex() == "010600c70000"
    assert write(jacket, 26, 500)[1] == 6
