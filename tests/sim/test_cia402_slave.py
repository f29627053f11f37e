"""The simulated drive in profile velocity: state machine, ramps, stops, faults, status bits (CiA 402-2)."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.nodes.motion import VelocityAxis
from tests.sim.drive_bench import (
    DISABLED,
    ENABLED,
    FAULT,
    NODE,
    PC,
    PRESS,
    QUICK_STOP,
    REACTION,
    READY,
    SWITCHED_ON,
    WHEEL,
    DriveBench,
)

REACHED, LIMIT, ZERO, SLIPPAGE = 0x0400, 0x0800, 0x1000, 0x2000
VOLTAGE, WARNING, REMOTE = 0x0010, 0x0080, 0x0200


def turning(speed: int = 10_000, lag_s: float = 0.004) -> DriveBench:
    """Return a bench whose wheel turns at ``speed`` counts (0.001 rad/s)."""
    bench = DriveBench(lag_s=lag_s).enabled()
    bench.cycle(0x0F, speed)
    bench.run(3.0)
    assert bench.drive.axis.value == speed / 1000
    return bench


# the walk


def test_a_booted_drive_is_switch_on_disabled() -> None:
    bench = DriveBench().boot()
    assert bench.read(0x6041) & 0x4F == DISABLED


def test_the_walk_to_operation_enabled() -> None:
    bench = DriveBench().configured()
    states: list[int] = []
    for controlword in (0x00, 0x06, 0x07, 0x0F):
        bench.cycle(controlword)
        states.append(bench.state)
    assert states == [DISABLED, READY, SWITCHED_ON, ENABLED]


def test_enable_operation_from_ready_takes_both_transitions() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x06)
    bench.cycle(0x0F)
    assert bench.state == ENABLED


def test_enable_operation_does_nothing_while_disabled() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x0F, 5000)
    assert bench.state == DISABLED
    assert bench.drive.axis.still


def test_the_walk_by_sdo() -> None:
    bench = DriveBench().boot()
    for controlword, state in ((0x06, READY), (0x07, SWITCHED_ON), (0x0F, ENABLED), (0x00, DISABLED)):
        bench.write(0x6040, 0, controlword, 2)
        assert bench.read(0x6041) & 0x6F & ~(0x20 if state == DISABLED else 0) == state


def test_process_data_are_ignored_before_operational() -> None:
    bench = DriveBench().boot()
    bench.cycle(0x06)
    assert bench.state == DISABLED


# profile velocity


def test_the_ramp_has_the_acceleration_set() -> None:
    bench = DriveBench(lag_s=0.0).enabled()
    bench.cycle(0x0F, 10_000)
    start = bench.now - 0.01
    bench.run(0.5)
    assert bench.drive.axis.value == pytest.approx(10.0 * (bench.now - start))


def test_the_tpdo_carries_status_velocity_and_torque() -> None:
    bench = turning()
    bench.drive.load(-5.0, 0.0)
    bench.cycle(0x0F, 10_000)
    status, velocity, torque = bench.sample()
    assert (velocity, torque) == (10_000, -250)
    assert status == 0x0637


def test_torque_beyond_the_field_is_clamped() -> None:
    bench = turning()
    bench.drive.load(1e6, 0.0)
    bench.cycle(0x0F, 10_000)
    assert bench.sample()[2] == 32767
    assert bench.read(0x6077) == 32767


def test_target_reached_is_set_at_the_end_of_the_ramp_only() -> None:
    bench = DriveBench().enabled()
    bench.cycle(0x0F, 10_000)
    bench.run(0.5)
    assert not bench.statusword & REACHED
    bench.run(0.7)
    assert bench.statusword & REACHED


def test_speed_zero_separates_standstill_from_turning() -> None:
    bench = DriveBench().enabled()
    bench.run(0.1)
    assert bench.statusword & ZERO
    bench.cycle(0x0F, 10_000)
    bench.run(0.1)
    assert not bench.statusword & ZERO


def test_windows_need_their_time() -> None:
    bench = DriveBench().configured()
    bench.write(0x606E, 0, 500, 2)
    for controlword in (0x06, 0x07, 0x0F):
        bench.cycle(controlword)
    bench.cycle(0x0F, 1000)
    bench.run(0.4)
    assert not bench.statusword & REACHED
    bench.run(0.4)
    assert bench.statusword & REACHED


def test_a_target_beyond_the_speed_limit_is_limited_and_reported() -> None:
    bench = DriveBench().configured()
    bench.write(0x6080, 0, 5000, 4)
    for controlword in (0x06, 0x07, 0x0F):
        bench.cycle(controlword)
    bench.cycle(0x0F, -20_000)
    bench.run(1.0)
    assert bench.drive.axis.value == -5.0
    assert bench.statusword & LIMIT


def test_halt_ramps_down_and_reports_the_standstill() -> None:
    bench = turning()
    bench.cycle(0x10F, 10_000)
    bench.run(0.5)
    assert bench.drive.axis.value == pytest.approx(10.0 - 10.0 * 0.5, abs=0.2)
    bench.run(1.0)
    assert bench.drive.axis.still
    assert bench.state == ENABLED
    assert bench.statusword & REACHED


def test_after_halt_the_drive_continues_to_the_target() -> None:
    bench = turning()
    bench.cycle(0x10F, 10_000)
    bench.run(2.0)
    bench.cycle(0x0F, 10_000)
    bench.run(2.0)
    assert bench.drive.axis.value == 10.0


def test_halt_option_2_takes_the_quick_stop_ramp() -> None:
    bench = turning()
    bench.write(0x605D, 0, 2, 2)
    bench.cycle(0x10F, 10_000)
    bench.run(0.3)
    assert bench.drive.axis.still


def test_a_new_ramp_by_sdo_counts_at_once() -> None:
    bench = turning(2000, lag_s=0.0)
    bench.write(0x6083, 0, 1000, 4)
    bench.cycle(0x0F, 12_000)
    bench.run(1.0)
    assert bench.drive.axis.value == pytest.approx(3.0, abs=0.02)


def test_demand_and_position_are_shown() -> None:
    bench = DriveBench(PRESS).enabled()
    bench.cycle(0x0F, 1000)
    bench.run(2.0)
    assert bench.read(0x606B) == 1000
    bench.cycle(0x0F, 0)
    bench.run(1.0)
    bench.cycle(0x0F, 0)
    assert bench.read(0x6064) == bench.sample()[1] == round(bench.drive.axis.position * 1000) > 1000


def test_a_position_counter_wraps_around() -> None:
    axis = VelocityAxis(10.0, position=3_000_000.0)
    bench = DriveBench(PRESS, axis).configured()
    bench.sync()
    bench.run(0.01)
    assert bench.sample()[1] == 3_000_000_000 - (1 << 32)


def test_slippage_shows_a_blocked_shaft() -> None:
    bench = turning()
    bench.write(0x60F8, 0, 500, 4)
    bench.drive.block(True)
    bench.run(0.1)
    assert bench.statusword & SLIPPAGE
    bench.drive.block(False)
    bench.run(0.1)
    assert not bench.statusword & SLIPPAGE


def test_a_blocked_shaft_sends_its_statusword_at_once_where_pdo_2_carries_it() -> None:
    bench = turning()
    bench.write(0x6070, 0, 0, 2)
    bench.map(0x1801, 0x1A01, 0x280 + NODE, 255, (0x60410010,))
    bench.run(0.1)
    sent = len(bench.frames(0x280 + NODE))
    bench.drive.block(True)
    bench.run(0.001, 0.001)
    said = [int.from_bytes(data, "little") & ZERO for data in bench.frames(0x280 + NODE)[sent:]]
    assert said == [ZERO], "within a millisecond, and without a SYNC"


# leaving operation


def test_quick_stop_takes_its_ramp_and_ends_disabled() -> None:
    bench = turning()
    bench.cycle(0x02, 10_000)
    assert bench.state == QUICK_STOP
    bench.run(0.1)
    assert bench.drive.axis.value == pytest.approx(10.0 - 40.0 * 0.1, abs=0.6)
    bench.run(0.4)
    assert (bench.state, bench.drive.axis.value) == (DISABLED, 0.0)


def test_quick_stop_is_not_left_by_enable_operation() -> None:
    bench = turning()
    bench.cycle(0x02)
    bench.cycle(0x0F)
    assert bench.state == QUICK_STOP


def test_quick_stop_option_0_coasts() -> None:
    bench = turning()
    bench.write(0x605A, 0, 0, 2)
    bench.cycle(0x02, 10_000)
    assert bench.state == DISABLED
    assert bench.drive.axis.value > 9.0


def test_quick_stop_option_1_takes_the_slow_ramp() -> None:
    bench = turning()
    bench.write(0x605A, 0, 1, 2)
    bench.cycle(0x02)
    bench.run(0.5)
    assert bench.state == QUICK_STOP
    assert bench.drive.axis.value == pytest.approx(5.0, abs=0.3)


@pytest.mark.parametrize(("option", "seconds"), [(5, 1.2), (6, 0.4)])
def test_quick_stop_options_5_and_6_stay_in_quick_stop(option: int, seconds: float) -> None:
    bench = turning()
    bench.write(0x605A, 0, option, 2)
    bench.cycle(0x02)
    bench.run(seconds)
    assert (bench.state, bench.drive.axis.value) == (QUICK_STOP, 0.0)
    assert bench.statusword & REACHED
    bench.cycle(0x0F, 1000)
    bench.run(0.5)
    assert (bench.state, bench.drive.axis.value) == (ENABLED, 1.0)


def test_disable_operation_ramps_down_first() -> None:
    bench = turning()
    bench.cycle(0x07, 10_000)
    bench.run(0.5)
    assert bench.state == ENABLED
    assert bench.drive.axis.value == pytest.approx(5.0, abs=0.3)
    bench.run(0.7)
    assert bench.state == SWITCHED_ON


def test_disable_operation_can_be_taken_back() -> None:
    bench = turning()
    bench.cycle(0x07, 10_000)
    bench.run(0.5)
    bench.cycle(0x0F, 10_000)
    bench.run(1.0)
    assert (bench.state, bench.drive.axis.value) == (ENABLED, 10.0)


def test_disable_operation_option_0_coasts() -> None:
    bench = turning()
    bench.write(0x605C, 0, 0, 2)
    bench.cycle(0x07)
    assert bench.state == SWITCHED_ON


@pytest.mark.parametrize(("option", "state"), [(0, READY), (1, ENABLED)])
def test_shutdown_option_chooses_between_coast_and_ramp(option: int, state: int) -> None:
    bench = turning()
    bench.write(0x605B, 0, option, 2)
    bench.cycle(0x06)
    assert bench.state == state
    bench.run(2.0)
    assert (bench.state, bench.drive.axis.value) == (READY, 0.0)


def test_disable_voltage_coasts_with_the_friction_of_the_axis() -> None:
    bench = turning()
    bench.drive.coast_deceleration = 2.0
    bench.cycle(0x00)
    assert bench.state == DISABLED
    bench.run(1.0)
    assert bench.drive.axis.value == pytest.approx(8.0, abs=0.1)


def test_power_loss_coasts() -> None:
    bench = turning()
    bench.drive.power(False)
    bench.run(0.5)
    assert bench.drive.axis.value == pytest.approx(5.0, abs=0.1)
    bench.run(1.0)
    assert bench.drive.axis.still


def test_power_returns_without_motion() -> None:
    bench = turning()
    bench.drive.power(False)
    bench.run(2.0)
    bench.drive.power(True)
    bench.run(0.5)
    bench.cycle(0x0F, 10_000)
    assert bench.state == DISABLED
    assert bench.drive.axis.still


def test_the_spring_retracts_an_unpowered_press_to_its_stop() -> None:
    screw = VelocityAxis(100.0, position=10.0, low=0.0, high=30.0)
    bench = DriveBench(PRESS, screw, unpowered_velocity=-20.0, coast_deceleration=400.0)
    bench.run(0.25)
    assert screw.value == -20.0
    bench.run(0.5)
    assert (screw.position, screw.value, screw.still) == (0.0, 0.0, True)


def test_an_enabled_press_holds_against_the_spring() -> None:
    screw = VelocityAxis(100.0, position=0.0, low=0.0, high=30.0)
    bench = DriveBench(PRESS, screw, unpowered_velocity=-20.0).enabled()
    bench.cycle(0x0F, 5000)
    bench.run(1.0)
    bench.cycle(0x0F, 0)
    bench.run(1.0)
    held = screw.position
    bench.run(1.0)
    assert screw.position == held > 4.0
    bench.cycle(0x00, 0)
    bench.run(1.0)
    assert screw.position == 0.0


# faults


def test_a_fault_ramps_down_then_shows_fault() -> None:
    bench = turning()
    bench.drive.fault(0x7121)
    assert bench.state == REACTION
    bench.run(0.1)
    assert bench.drive.axis.value == pytest.approx(6.0, abs=0.5)
    bench.run(0.4)
    assert (bench.state, bench.drive.axis.value) == (FAULT, 0.0)
    assert bench.read(0x603F) == 0x7121


def test_fault_reaction_option_0_coasts_in_fault() -> None:
    bench = turning()
    bench.write(0x605E, 0, 0, 2)
    bench.drive.fault(0x2310)
    assert bench.state == FAULT
    assert bench.drive.axis.value == 10.0


def test_a_fault_of_a_disabled_drive_is_shown_at_once() -> None:
    bench = DriveBench().configured()
    bench.drive.fault(0x4310)
    assert bench.state == FAULT


def test_a_fault_is_reset_by_the_rising_edge_of_bit_7() -> None:
    bench = DriveBench().configured()
    bench.drive.fault(0x4310)
    bench.cycle(0x80)
    assert bench.state == DISABLED
    assert bench.emergencies == [(0x4310, 0x09), (0x0000, 0x00)]
    assert bench.read(0x603F) == 0


def test_bit_7_held_from_before_does_not_reset() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x80)
    bench.drive.fault(0x4310)
    bench.cycle(0x80)
    assert bench.state == FAULT
    bench.cycle(0x00)
    bench.cycle(0x80)
    assert bench.state == DISABLED


def test_no_other_word_leaves_a_fault() -> None:
    bench = DriveBench().configured()
    bench.drive.fault(0x4310)
    for controlword in (0x00, 0x06, 0x07, 0x0F, 0x02):
        bench.cycle(controlword)
    assert bench.state == FAULT


def test_a_reset_with_the_enable_bits_set_ends_disabled() -> None:
    bench = DriveBench().configured()
    bench.drive.fault(0x4310)
    bench.cycle(0x0F)
    bench.cycle(0x8F)
    bench.cycle(0x0F)
    assert bench.state == DISABLED


def test_a_persistent_cause_refuses_the_reset() -> None:
    bench = DriveBench().configured()
    bench.drive.fault(0x7305, persistent=True)
    bench.cycle(0x80)
    assert bench.state == FAULT
    bench.drive.clear_cause(0x7305)
    bench.cycle(0x00)
    bench.cycle(0x80)
    assert bench.state == DISABLED


def test_a_second_fault_during_the_reaction_is_also_reported() -> None:
    bench = turning()
    bench.drive.fault(0x7121)
    bench.drive.fault(0x4310)
    bench.run(0.5)
    assert [code for code, _ in bench.emergencies] == [0x7121, 0x4310]
    assert bench.state == FAULT


def test_a_drive_without_power_notices_no_fault() -> None:
    bench = DriveBench(powered=False)
    bench.drive.fault(0x4310)
    bench.drive.power(True)
    bench.run(0.4)
    assert bench.emergencies == []
    assert bench.state == DISABLED


def test_a_persistent_cause_is_found_at_power_on() -> None:
    bench = DriveBench(powered=False)
    bench.drive.fault(0x7305, persistent=True)
    bench.drive.power(True)
    bench.run(0.4)
    assert bench.emergencies == [(0x7305, 0x21)]
    assert bench.state == FAULT


# lost connections


def watched(option: int, speed: int = 10_000) -> DriveBench:
    """Return a turning drive that has received one heartbeat."""
    bench = turning(speed)
    bench.write(0x6007, 0, option, 2)
    bench.write(0x1016, 1, PC << 16 | 200, 4)
    bench.heartbeat()
    return bench


def test_a_lost_heartbeat_with_option_3_is_a_quick_stop() -> None:
    bench = watched(3)
    bench.run(0.25)
    assert bench.state == QUICK_STOP
    bench.run(0.4)
    assert (bench.state, bench.drive.axis.value) == (DISABLED, 0.0)


def test_the_reaction_starts_when_the_heartbeat_is_due_within_a_long_tick() -> None:
    bench = watched(3)
    bench.run(0.3, 0.1)
    assert bench.drive.axis.value == pytest.approx(10.0 - 40.0 * 0.1, abs=0.3)


def test_a_lost_heartbeat_with_option_2_coasts() -> None:
    bench = watched(2)
    bench.run(0.21)
    assert bench.state == DISABLED
    assert bench.drive.axis.value > 9.0


def test_a_lost_heartbeat_with_option_1_is_a_fault() -> None:
    bench = watched(1)
    bench.run(1.0)
    assert bench.state == FAULT
    assert bench.read(0x603F) == 0x8130
    bench.heartbeat()
    bench.run(0.1)
    assert bench.emergencies == [(0x8130, 0x11)]


def test_a_lost_heartbeat_with_option_0_changes_nothing() -> None:
    bench = watched(0)
    bench.write(0x1029, 1, 1, 1)
    bench.heartbeat()
    bench.run(1.0)
    assert (bench.state, bench.drive.axis.value) == (ENABLED, 10.0)
    assert bench.statusword & WARNING


def test_enable_operation_after_a_lost_heartbeat_does_not_move() -> None:
    bench = watched(3)
    bench.run(1.0)
    bench.heartbeat()
    bench.nmt(1)
    for _ in range(5):
        bench.cycle(0x0F, 10_000)
    assert (bench.state, bench.drive.axis.value) == (DISABLED, 0.0)


def test_a_switched_on_drive_is_disabled_by_a_lost_heartbeat() -> None:
    bench = DriveBench().configured()
    bench.write(0x6007, 0, 3, 2)
    bench.write(0x1016, 1, PC << 16 | 200, 4)
    bench.heartbeat()
    bench.cycle(0x06)
    bench.cycle(0x07)
    bench.run(0.5)
    assert bench.state == DISABLED


@pytest.mark.parametrize("command", [2, 130])
def test_nmt_stop_and_communication_reset_are_lost_connections(command: int) -> None:
    bench = turning()
    bench.write(0x6007, 0, 3, 2)
    bench.nmt(command)
    bench.run(1.0)
    assert bench.drive.axis.value == 0.0
    assert bench.state == DISABLED


def test_reset_node_takes_the_torque_away() -> None:
    bench = turning()
    bench.nmt(129)
    bench.run(0.1)
    assert 8.0 < bench.drive.axis.value < 10.0
    bench.run(2.0)
    assert bench.drive.axis.still


# inputs of the drive


def test_torque_off_disables_and_clears_the_voltage_bit() -> None:
    bench = turning()
    bench.drive.set_torque_off(True)
    bench.cycle(0x06)
    assert bench.state == DISABLED
    assert not bench.statusword & VOLTAGE
    bench.drive.set_torque_off(False)
    bench.cycle(0x06)
    assert bench.state == READY
    assert bench.statusword & VOLTAGE


def test_a_drive_under_local_control_ignores_the_bus() -> None:
    bench = DriveBench().configured()
    assert bench.statusword & REMOTE
    bench.drive.set_local(True)
    bench.cycle(0x06)
    assert bench.state == DISABLED
    assert not bench.statusword & REMOTE
    assert bench.refusal(0x6040, 0, 0x06, 2) == 0x08000021
    bench.drive.set_local(False)
    bench.cycle(0x06)
    assert bench.state == READY


# modes


def test_the_mode_display_confirms_the_mode() -> None:
    bench = DriveBench().boot()
    assert bench.read(0x6061) == 0
    bench.write(0x6060, 0, 3, 1)
    assert bench.read(0x6061) == 3


@pytest.mark.parametrize("mode", [1, 2, 6, 8, 9])
def test_an_unsupported_mode_is_refused(mode: int) -> None:
    bench = DriveBench().boot()
    assert bench.refusal(0x6060, 0, mode, 1) == 0x06090030


def test_the_mode_is_not_changed_while_turning() -> None:
    bench = turning()
    assert bench.refusal(0x6060, 0, 0, 1) == 0x08000022
    assert bench.read(0x6061) == 3


def test_a_mapped_mode_changes_at_standstill() -> None:
    bench = DriveBench().configured()
    bench.map(0x1400, 0x1600, 0x200 + NODE, 1, (0x60400010, 0x60600008))
    for mode, shown in ((0, 0), (3, 3), (9, 0)):
        bench.send(0x200 + NODE, bytes((0x06, 0x00, mode)))
        bench.sync()
        bench.run(0.01)
        assert bench.read(0x6061) == shown


# what is cheap must be right


def test_the_same_rpdo_bytes_keep_the_drive_going() -> None:
    bench = turning()
    for _ in range(20):
        bench.cycle(0x0F, 10_000)
    assert (bench.state, bench.drive.axis.value) == (ENABLED, 10.0)


def test_a_drive_that_fell_out_by_itself_obeys_the_next_word_even_if_it_is_the_last_one() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x06)
    bench.drive.set_torque_off(True)
    bench.drive.set_torque_off(False)
    assert bench.state == DISABLED
    bench.cycle(0x06)
    assert bench.state == READY


def test_a_target_change_of_one_count_moves_the_axis() -> None:
    bench = turning()
    bench.cycle(0x0F, 10_001)
    bench.run(0.2)
    assert bench.drive.axis.value == 10.001


def test_a_high_speed_axis_in_other_units_scales() -> None:
    bench = DriveBench(replace(WHEEL, unit="m/s", velocity_increments=1e6, acceleration=2.0)).enabled()
    bench.cycle(0x0F, 800_000)
    bench.run(1.0)
    assert bench.drive.axis.value == 0.8
    bench.cycle(0x0F, 800_000)
    assert bench.sample()[1] == 800_000
