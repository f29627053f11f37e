"""The simulated drive in profile position and homing mode (CiA 402-2)."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.nodes.motion import PositionAxis
from tests.sim.drive_bench import DISABLED, ENABLED, FAULT, YAW, DriveBench

REACHED, LIMIT, TWELVE, THIRTEEN = 0x0400, 0x0800, 0x1000, 0x2000
NEW, IMMEDIATE, RELATIVE, HALT = 0x10, 0x20, 0x40, 0x100


def yaw() -> DriveBench:
    return DriveBench(YAW).enabled(mode=1)


def go(bench: DriveBench, counts: int, bits: int = IMMEDIATE) -> None:
    """Hand over a set-point: bit 4 up until acknowledged, then down."""
    bench.cycle(0x0F | bits | NEW, counts)
    bench.cycle(0x0F | bits, counts)


def test_a_new_set_point_is_acknowledged() -> None:
    bench = yaw()
    bench.cycle(0x0F | NEW | IMMEDIATE, 1000)
    assert bench.statusword & TWELVE
    bench.cycle(0x0F | IMMEDIATE, 1000)
    assert not bench.statusword & TWELVE


def test_a_move_ends_on_target_with_bit_10() -> None:
    bench = yaw()
    go(bench, 1000)
    assert not bench.statusword & REACHED
    bench.run(2.0)
    assert bench.drive.axis.position == 10.0
    assert bench.statusword & REACHED
    bench.sync()
    bench.run(0.01)
    assert bench.sample()[1] == 1000


def test_a_target_without_the_edge_does_nothing() -> None:
    bench = yaw()
    bench.cycle(0x0F, 1000)
    bench.run(1.0)
    assert bench.drive.axis.position == 0.0


def test_a_held_bit_4_is_one_set_point() -> None:
    bench = yaw()
    bench.cycle(0x0F | NEW | IMMEDIATE, 1000)
    bench.cycle(0x0F | NEW | IMMEDIATE, 500)
    bench.run(2.0)
    assert bench.drive.axis.position == 10.0


def test_the_speed_is_the_profile_velocity() -> None:
    bench = yaw()
    bench.write(0x6081, 0, 200, 4)
    go(bench, 3000)
    bench.run(1.0)
    assert bench.drive.axis.value == 2.0


def test_the_motor_speed_limits_the_profile_velocity() -> None:
    bench = yaw()
    bench.write(0x6080, 0, 100, 4)
    go(bench, 3000)
    bench.run(1.0)
    assert bench.drive.axis.value == 1.0


def test_an_immediate_set_point_replaces_the_one_under_way() -> None:
    bench = yaw()
    go(bench, 3000)
    bench.run(0.3)
    go(bench, -500)
    bench.run(3.0)
    assert bench.drive.axis.position == -5.0


def test_a_waiting_set_point_follows_the_one_under_way() -> None:
    bench = yaw()
    go(bench, 1000, 0)
    bench.run(0.2)
    bench.cycle(0x0F | NEW, 500)
    bench.cycle(0x0F, 500)
    assert bench.statusword & TWELVE  # not free before the first move has ended
    furthest = 0.0
    for _ in range(300):
        bench.run(0.01)
        furthest = max(furthest, bench.drive.axis.position)
    assert furthest == pytest.approx(10.0, abs=0.01)
    assert bench.drive.axis.position == 5.0
    assert not bench.statusword & TWELVE


def test_a_relative_set_point_counts_from_the_last_target() -> None:
    bench = yaw()
    go(bench, 1000)
    bench.run(2.0)
    go(bench, -300, IMMEDIATE | RELATIVE)
    bench.run(2.0)
    assert bench.drive.axis.position == pytest.approx(7.0)


def test_a_target_beyond_the_software_limit_ends_at_it() -> None:
    bench = yaw()
    bench.write(0x607D, 1, -2000, 4)
    bench.write(0x607D, 2, 2000, 4)
    go(bench, 5000)
    bench.run(3.0)
    assert bench.drive.axis.position == 20.0
    assert bench.statusword & LIMIT


def test_halt_pauses_a_move_which_then_continues() -> None:
    bench = yaw()
    go(bench, 2000)
    bench.run(0.5)
    bench.cycle(0x0F | IMMEDIATE | HALT, 2000)
    bench.run(2.0)
    assert bench.drive.axis.still
    assert bench.drive.axis.position < 20.0
    assert bench.statusword & REACHED
    bench.cycle(0x0F | IMMEDIATE, 2000)
    bench.run(2.0)
    assert bench.drive.axis.position == 20.0


def test_quick_stop_stops_short_and_a_later_enable_stays_there() -> None:
    bench = yaw()
    go(bench, 2000)
    bench.run(0.4)
    bench.cycle(0x02, 2000)
    bench.run(1.0)
    assert bench.state == DISABLED
    stopped = bench.drive.axis.position
    for controlword in (0x06, 0x07, 0x0F):
        bench.cycle(controlword, 2000)
    bench.run(1.0)
    assert bench.state == ENABLED
    assert 0.0 < bench.drive.axis.position == stopped < 20.0


def test_bit_4_set_before_enabling_is_no_edge() -> None:
    bench = DriveBench(YAW).configured(mode=1)
    for controlword in (0x06, 0x07, 0x17, 0x1F):
        bench.cycle(controlword, 1000)
    bench.run(1.0)
    assert bench.state == ENABLED
    assert bench.drive.axis.position == 0.0


def test_a_blocked_axis_ends_in_a_following_error() -> None:
    bench = yaw()
    bench.write(0x6065, 0, 50, 4)
    bench.write(0x6066, 0, 20, 2)
    bench.drive.block(True)
    go(bench, 1000)
    bench.run(1.0)
    assert bench.state == FAULT
    assert [code for code, _ in bench.emergencies] == [0x8611]
    assert bench.drive.axis.position == 0.0


def test_an_acknowledgement_and_an_arrival_are_urgent() -> None:
    bench = yaw()
    bench.run(0.2)
    go(bench, 100)
    urgent = 0
    for _ in range(100):
        bench.drive.advance(bench.now, bench.now + 0.01)
        bench.now += 0.01
        bench.collect()
        bench.sync()
        urgent += bench.wire.urgent_s < bench.now + 0.01
    assert urgent >= 1


# homing


def homing(position: float = 7.0, home: float = 2.0, **objects: int) -> DriveBench:
    axis = PositionAxis(20.0, 20.0, position=position)
    bench = DriveBench(YAW, axis, home_position=home).configured(mode=6)
    bench.write(0x6098, 0, objects.get("method", 19), 1)
    bench.write(0x6099, 1, 500, 4)
    bench.write(0x609A, 0, 2000, 4)
    bench.write(0x607C, 0, objects.get("offset", 0), 4)
    for controlword in (0x06, 0x07, 0x0F):
        bench.cycle(controlword)
    return bench


def test_homing_waits_for_its_start_bit() -> None:
    bench = homing()
    bench.run(1.0)
    assert bench.drive.axis.position == 7.0
    assert bench.statusword & (TWELVE | THIRTEEN | REACHED) == REACHED


def test_homing_finds_the_switch_and_counts_from_it() -> None:
    bench = homing()
    bench.cycle(0x1F)
    bench.run(0.2)
    assert bench.statusword & (TWELVE | THIRTEEN | REACHED) == 0
    bench.run(3.0)
    assert bench.drive.axis.position == 2.0
    assert bench.statusword & (TWELVE | THIRTEEN | REACHED) == TWELVE | REACHED
    assert bench.read(0x6064) == 0
    assert bench.drive.homed


def test_the_home_offset_lies_between_home_and_zero() -> None:
    bench = homing(offset=300)
    bench.cycle(0x1F)
    bench.run(3.0)
    assert bench.read(0x6064, signed=True) == -300


def test_homing_on_the_present_position_does_not_move() -> None:
    bench = homing(method=35)
    bench.cycle(0x1F)
    bench.run(0.1)
    assert bench.drive.axis.position == 7.0
    assert bench.read(0x6064) == 0
    assert bench.statusword & TWELVE


def test_homing_is_interrupted_by_its_bit() -> None:
    bench = homing()
    bench.cycle(0x1F)
    bench.run(0.3)
    bench.cycle(0x0F)
    bench.run(1.0)
    assert bench.statusword & (TWELVE | THIRTEEN | REACHED) == REACHED
    assert not bench.drive.homed


@pytest.mark.parametrize("controlword", [0x00, 0x02, 0x07, 0x06])
def test_a_stop_on_the_way_is_no_home(controlword: int) -> None:
    bench = homing()
    bench.cycle(0x1F)
    bench.run(0.3)
    bench.cycle(controlword)
    bench.run(2.0)
    assert not bench.drive.homed
    assert not bench.statusword & TWELVE


def test_a_lost_connection_on_the_way_is_no_home() -> None:
    bench = homing()
    bench.write(0x6007, 0, 3, 2)
    bench.cycle(0x1F)
    bench.run(0.3)
    bench.nmt(2)
    bench.run(2.0)
    assert bench.drive.axis.still
    assert not bench.drive.homed


def test_a_broken_home_switch_is_a_homing_error() -> None:
    bench = homing()
    assert bench.drive.homing is not None
    bench.drive.homing.switch_works = False
    bench.cycle(0x1F)
    bench.run(3.0)
    assert bench.statusword & (TWELVE | THIRTEEN) == THIRTEEN


def test_positions_count_from_home_after_the_mode_change() -> None:
    bench = homing()
    bench.cycle(0x1F)
    bench.run(3.0)
    for controlword in (0x0F, 0x00):
        bench.cycle(controlword)
    bench.write(0x6060, 0, 1, 1)
    for controlword in (0x06, 0x07, 0x0F):
        bench.cycle(controlword)
    go(bench, -400)
    bench.run(3.0)
    assert bench.drive.axis.position == pytest.approx(-2.0)
    bench.sync()
    bench.run(0.01)
    assert bench.sample()[1] == bench.read(0x6064, signed=True) == -400


def test_power_off_forgets_the_home() -> None:
    bench = homing()
    bench.cycle(0x1F)
    bench.run(3.0)
    bench.drive.power(False)
    bench.run(0.1)
    bench.drive.power(True)
    bench.run(0.3)
    assert not bench.drive.homed
    assert bench.read(0x6064) == 0


def test_supported_modes_are_position_and_homing() -> None:
    bench = DriveBench(YAW).boot()
    assert bench.read(0x6502) == 0b10_0001
    assert bench.refusal(0x6060, 0, 3, 1) == 0x06090030


def test_an_encoder_that_is_not_homed_counts_from_power_on() -> None:
    bench = DriveBench(replace(YAW), PositionAxis(20.0, 20.0, position=12.0)).boot()
    assert bench.read(0x6064) == 0
