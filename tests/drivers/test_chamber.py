"""The chamber's driver against bytes of its register map, and on the simulated line."""

from __future__ import annotations

from math import isnan, nan

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import ProfileError, load_profile
from drivers.temperature_controller import CHAMBER_LEASE_S, TemperatureController
from sim.nodes.controller_slave import ControllerSlave
from tests.drivers.modbus_rig import Rig

PROFILE = load_profile("climate_chamber")


class Air:
    """The value at the chamber's sensor."""

    def __init__(self) -> None:
        self.air_c = 23.0

    def controller_measured_c(self, t: float) -> float:
        return self.air_c


def rig() -> tuple[Rig, TemperatureController, ControllerSlave, Air]:
    air = Air()
    slave = ControllerSlave(PROFILE, 3, air)
    made = Rig(38400, slave, period_s=0.05)
    return made, TemperatureController("chamber", PROFILE, 3, made.link), slave, air


class Command:
    """Do an engine's work of one scan."""

    def __init__(self, chamber: TemperatureController, celsius: float) -> None:
        self.chamber, self.celsius = chamber, celsius

    def __call__(self) -> None:
        self.chamber.enable(True)
        self.chamber.set_setpoint(self.celsius)


def test_set_up_is_standby_and_the_lease_read_back() -> None:
    made, _, slave, _ = rig()
    made.run(1.0)
    assert made.log.requests("03060012")[0][1] == with_crc(bytes.fromhex("030600120000"))
    assert made.log.requests("03060011")[0][1] == with_crc(bytes.fromhex("03060011012c"))
    assert slave.lease_s == CHAMBER_LEASE_S and not slave.running


def test_a_setpoint_below_zero_goes_out_in_tenths_of_a_degree() -> None:
    made, chamber, slave, _ = rig()
    made.run(5.0, Command(chamber, -35.5))
    assert made.log.requests("03060010")[-1][1] == with_crc(bytes.fromhex("03060010fe9d"))
    assert slave.running and slave.setpoint_c == -35.5 and chamber.setpoint_c == pytest.approx(-35.5)
    assert chamber.output_percent == -100.0


def test_the_reading_is_the_air() -> None:
    made, chamber, _, air = rig()
    air.air_c = -49.96
    made.run(3.0)
    assert chamber.valid and chamber.measured_c == pytest.approx(-50.0, abs=0.11)


@pytest.mark.parametrize(("asked", "written"), [(-80.0, -50.0), (140.0, 100.0)])
def test_a_setpoint_is_kept_inside_the_profile(asked: float, written: float) -> None:
    made, chamber, slave, _ = rig()
    made.run(3.0, Command(chamber, asked))
    assert slave.setpoint_c == written


def test_no_number_is_no_setpoint() -> None:
    _, chamber, _, _ = rig()
    with pytest.raises(ValueError, match="finite"):
        chamber.set_setpoint(nan)


def test_a_setpoint_that_is_asked_for_is_renewed_and_the_lease_holds() -> None:
    made, chamber, slave, _ = rig()
    made.run(CHAMBER_LEASE_S + 10.0, Command(chamber, 60.0))
    assert slave.running and not chamber.lease_expired


def test_a_setpoint_that_is_not_asked_for_runs_out_and_the_chamber_stands_by() -> None:
    made, chamber, slave, _ = rig()
    made.run(5.0, Command(chamber, 60.0))
    made.run(CHAMBER_LEASE_S + 5.0)
    assert not slave.running and slave.output == 0.0 and chamber.lease_expired


def test_a_broken_sensor_is_no_reading_and_ends_the_heat() -> None:
    made, chamber, slave, air = rig()
    made.run(3.0, Command(chamber, 60.0))
    air.air_c = nan
    made.run(3.0, Command(chamber, 60.0))
    assert chamber.sensor_break and not chamber.valid and isnan(chamber.measured_c) and slave.output == 0.0


@pytest.mark.parametrize("air_c", [106.0, -56.0])
def test_beyond_its_own_limits_the_chamber_stands_by_and_reports_it(air_c: float) -> None:
    made, chamber, slave, air = rig()
    made.run(3.0, Command(chamber, 60.0))
    air.air_c = air_c
    made.run(2.0)
    assert chamber.out_of_range and not slave.running


def test_standing_by_is_written_at_once() -> None:
    made, chamber, slave, _ = rig()
    made.run(3.0, Command(chamber, 60.0))
    chamber.enable(False)
    made.run(0.1)
    assert not slave.running


def test_a_chamber_without_supply_is_not_valid_and_starts_in_standby() -> None:
    made, chamber, slave, _ = rig()
    made.run(3.0, Command(chamber, 60.0))
    slave.power(False)
    made.run(5.0)
    assert not chamber.valid
    slave.power(True)
    assert not slave.running and slave.output == 0.0


def test_a_profile_of_another_kind_is_refused() -> None:
    with pytest.raises(ProfileError, match="describes a jacket, not a chamber"):
        TemperatureController("chamber", load_profile("simulated_jacket"), 1, rig()[0].link)
