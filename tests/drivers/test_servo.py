"""A servo drive scan by scan: RPDO1 from statusword and commands, readings from TPDO1."""

from __future__ import annotations

import copy
import math
import struct

import pytest

from drivers.canopen.messages import encode_emergency
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tests.drivers.can_bench import joined, tpdo1, wheel, yaw

DISABLED, READY, ON, ENABLED = 0x0240, 0x0221, 0x0223, 0x0227
QUICK_STOP_ACTIVE, REACTION, FAULT = 0x0207, 0x020F, 0x0208
REACHED, ACKNOWLEDGED = 0x0400, 0x1000


def rpdo1(drive: ServoDrive, sync: bool = True) -> tuple[int, int]:
    """Return controlword and target of the next scan."""
    data = drive.emit(sync)
    assert data is not None
    word, value = struct.unpack("<Hi", data)
    return word, value


def report(drive: ServoDrive, statusword: int, value: int = 0, torque: int = 0, t: float = 0.0) -> None:
    drive.on_tpdo1(t, tpdo1(statusword, value, torque))


def enabled_wheel() -> ServoDrive:
    drive = joined(wheel())
    drive.goal = Goal.ENABLED
    report(drive, ENABLED)
    return drive


def enabled_yaw(raw: int = 0) -> ServoDrive:
    drive = joined(yaw(), raw=raw)
    drive.goal = Goal.ENABLED
    report(drive, ENABLED, raw)
    rpdo1(drive)
    return drive


# --- readings -----------------------------------------------------------------------------------------------

def test_an_unconnected_drive_has_no_readings() -> None:
    drive = ServoDrive(wheel())
    assert math.isnan(drive.actual)
    assert math.isnan(drive.torque_nm)
    assert (drive.stamp_s, drive.online, drive.lost, drive.state) == (-math.inf, False, False, State.NOT_READY)


def test_tpdo1_becomes_engineering_units() -> None:
    drive = joined(wheel())
    drive.on_tpdo1(1.25, bytes.fromhex("2706 A8160000 38FF"))
    assert (drive.state, drive.actual, drive.stamp_s) == (State.OPERATION_ENABLED, 5.8, 1.25)
    assert drive.torque_nm == pytest.approx(-2.0)


def test_position_feedback_is_scaled_with_the_position_increments() -> None:
    press = joined(wheel(name="press", unit="mm/s", feedback="position", position_increments=200.0))
    report(press, ENABLED, value=3100)
    assert press.actual == 15.5


@pytest.mark.parametrize("data", [b"", bytes(7), bytes(9)])
def test_a_tpdo1_of_another_length_is_counted_and_changes_nothing(data: bytes) -> None:
    drive = enabled_wheel()
    drive.on_tpdo1(1.0, data)
    assert (drive.malformed, drive.stamp_s, drive.state) == (1, 0.0, State.OPERATION_ENABLED)


def test_a_drive_that_is_not_connected_reads_nothing() -> None:
    drive = ServoDrive(wheel())
    report(drive, ENABLED, value=1000)
    assert math.isnan(drive.actual)


def test_tpdo2_is_the_digital_inputs() -> None:
    drive = joined(wheel(digital_io=True))
    drive.on_tpdo2(2.0, bytes.fromhex("00 00 07 00"))
    assert (drive.inputs, drive.inputs_stamp_s) == (0x0007_0000, 2.0)


def test_the_same_inputs_again_are_fresh_and_no_news() -> None:
    drive = joined(wheel(digital_io=True))
    drive.on_tpdo2(2.0, bytes.fromhex("00 00 07 00"))
    drive.news = False
    drive.on_tpdo2(2.1, bytes.fromhex("00 00 07 00"))
    assert (drive.inputs_stamp_s, drive.news) == (2.1, False)


@pytest.mark.parametrize(("bit", "news"), [(0x0400, False), (0x0800, False), (0x0200, True), (0x0008, True)])
def test_only_a_change_of_state_or_of_remote_is_news(bit: int, news: bool) -> None:
    drive = joined(wheel())
    report(drive, ENABLED)
    drive.news = False
    report(drive, ENABLED ^ bit)
    assert (drive.statusword, drive.news, drive.dirty) == (ENABLED ^ bit, news, True)


def test_an_unrequested_statusword_reports_standstill() -> None:
    drive = joined(wheel(speed_zero=0.2))
    report(drive, ENABLED, value=5800)
    assert drive.actual != 0.0 and not drive.stands
    drive.on_tpdo2(2.0, (ENABLED | 0x1000).to_bytes(2, "little"))
    assert (drive.stands, drive.actual, drive.stamp_s, drive.news) == (True, 0.0, 2.0, True)


def test_an_unrequested_statusword_keeps_a_speed_other_than_zero() -> None:
    drive = joined(wheel(speed_zero=0.2))
    report(drive, ENABLED, value=5800)
    before = (drive.actual, drive.stamp_s)
    drive.on_tpdo2(2.0, (ENABLED | 0x0400).to_bytes(2, "little"))
    assert (drive.actual, drive.stamp_s, drive.stands) == (*before, False)


def test_the_same_speed_as_before_is_read_again_after_a_standstill() -> None:
    drive = joined(wheel(speed_zero=0.2))
    report(drive, ENABLED, value=5800)
    speed, seen = drive.actual, drive.tpdo1_data
    drive.on_tpdo2(2.0, (ENABLED | 0x1000).to_bytes(2, "little"))
    assert drive.tpdo1_data != seen, "the master would take the same bytes for no news"
    report(drive, ENABLED, value=5800)
    assert drive.actual == speed


@pytest.mark.parametrize("data", [b"", bytes(1), bytes(4)])
def test_a_status_pdo_of_another_length_is_counted_and_changes_nothing(data: bytes) -> None:
    drive = joined(wheel(speed_zero=0.2))
    drive.on_tpdo2(2.0, data)
    assert (drive.malformed, drive.stands) == (1, False)


def test_inputs_that_were_never_sent_are_older_than_anything() -> None:
    assert joined(wheel(digital_io=True)).inputs_stamp_s == -math.inf


def test_the_statusword_bits_have_names() -> None:
    drive = joined(wheel())
    report(drive, ENABLED | 0x2880)
    assert (drive.warning, drive.deviation, drive.remote) == (True, True, True)


# --- towards operation --------------------------------------------------------------------------------------

def test_nothing_is_sent_to_a_drive_that_is_not_connected() -> None:
    drive = ServoDrive(wheel())
    drive.goal = Goal.ENABLED
    assert drive.emit(sync=True) is None


def test_enabling_climbs_one_state_per_report_with_target_zero() -> None:
    drive = joined(wheel())
    drive.goal = Goal.ENABLED
    drive.target = 8.0
    seen = [rpdo1(drive)]
    for statusword in (READY, ON):
        report(drive, statusword)
        seen.append(rpdo1(drive))
    assert seen == [(0x06, 0), (0x07, 0), (0x0F, 0)]


def test_the_target_is_sent_once_operation_is_reported() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    assert rpdo1(drive) == (0x0F, 8000)


def test_disabling_sends_target_zero_in_the_same_scan() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    drive.goal = Goal.DISABLED
    assert rpdo1(drive) == (0x07, 0)


def test_a_quick_stop_sends_target_zero_in_the_same_scan() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    drive.goal = Goal.QUICK_STOP
    assert rpdo1(drive) == (0x02, 0)


def test_halt_keeps_the_drive_enabled() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    drive.halt = True
    assert rpdo1(drive) == (0x10F, 8000)


def test_a_drive_under_local_control_is_not_enabled() -> None:
    drive = joined(wheel(), statusword=0x0040)
    drive.goal = Goal.ENABLED
    assert rpdo1(drive) == (0x00, 0)


def test_unchanged_commands_are_the_same_bytes_object() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    first = drive.emit(True)
    report(drive, ENABLED, value=7990, torque=12, t=0.01)
    drive.target = 8.0
    drive.goal = Goal.ENABLED
    assert drive.emit(True) is first


# --- limits -------------------------------------------------------------------------------------------------

@pytest.mark.parametrize(("target", "counts"), [(1e9, 50_000), (-1e9, -50_000), (49.9, 49_900)])
def test_a_speed_is_clamped_to_the_maximum(target: float, counts: int) -> None:
    drive = enabled_wheel()
    drive.target = target
    assert rpdo1(drive)[1] == counts


@pytest.mark.parametrize("target", [math.nan, math.inf, -math.inf])
def test_a_target_that_is_no_number_is_refused_and_changes_nothing(target: float) -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    with pytest.raises(ValueError, match="wheel"):
        drive.target = target
    assert rpdo1(drive) == (0x0F, 8000)


def test_a_position_is_clamped_to_the_software_limits() -> None:
    drive = enabled_yaw()
    drive.target = 45.0
    assert rpdo1(drive) == (0x3F, 3000)


def test_a_position_axis_without_limits_stays_within_32_bits() -> None:
    drive = joined(yaw(software_limits=None))
    drive.goal = Goal.ENABLED
    report(drive, ENABLED)
    rpdo1(drive)
    drive.target = 1e12
    assert rpdo1(drive) == (0x3F, 2**31 - 1)


@pytest.mark.parametrize("bits", [-1, 1 << 32])
def test_outputs_beyond_32_bits_are_refused(bits: int) -> None:
    with pytest.raises(ValueError, match="do not fit"):
        joined(wheel(digital_io=True)).outputs = bits


# --- digital outputs ----------------------------------------------------------------------------------------

def test_outputs_are_sent_once_per_change() -> None:
    drive = joined(wheel(digital_io=True))
    assert drive.emit_outputs(1.0) is None
    drive.outputs = 0x0001_0000
    assert drive.emit_outputs(1.0) == bytes.fromhex("00 00 01 00")
    assert drive.emit_outputs(9.0) is None


def test_outputs_without_an_answer_are_sent_again_ten_times_a_second() -> None:
    drive = joined(wheel(digital_io=True))
    drive.outputs = 0x0001_0000
    drive.outputs_unanswered = True
    sent = [i for i in range(128) if drive.emit_outputs(i / 128) is not None]
    assert sent == list(range(0, 128, 13))


def test_outputs_with_an_answer_are_not_sent_again() -> None:
    drive = joined(wheel(digital_io=True))
    drive.outputs = 0x0001_0000
    drive.emit_outputs(0.0)
    drive.outputs_unanswered = True
    drive.outputs_unanswered = False
    assert drive.emit_outputs(5.0) is None


def test_a_lost_drive_is_sent_outputs_off() -> None:
    drive = joined(wheel(digital_io=True))
    drive.outputs = 0x0001_0000
    drive.emit_outputs(0.0)
    drive.check_heartbeat(now=10.0)
    assert drive.emit_outputs(10.0) == bytes(4)


# --- position mode ------------------------------------------------------------------------------------------

def test_before_operation_a_position_axis_is_sent_where_it_is() -> None:
    drive = joined(yaw(), raw=512)
    drive.goal = Goal.ENABLED
    drive.target = 10.0
    report(drive, ON, value=515)
    assert rpdo1(drive) == (0x0F, 515)


def test_connecting_makes_the_present_position_the_target() -> None:
    drive = joined(yaw(), raw=512)
    assert drive.target == 5.12


def test_an_enabled_axis_without_a_new_target_gets_no_set_point() -> None:
    drive = enabled_yaw(raw=512)
    assert rpdo1(drive) == (0x2F, 512)


def test_a_new_target_is_a_set_point_until_acknowledged() -> None:
    drive = enabled_yaw()
    drive.target = 20.0
    assert rpdo1(drive) == (0x3F, 2000)
    report(drive, ENABLED, value=3)
    assert rpdo1(drive) == (0x3F, 2000)
    report(drive, ENABLED | ACKNOWLEDGED, value=9)
    assert rpdo1(drive) == (0x2F, 2000)


def test_a_target_changed_on_the_way_follows_after_the_handshake() -> None:
    drive = enabled_yaw()
    drive.target = 20.0
    rpdo1(drive)
    drive.target = 5.0
    assert rpdo1(drive) == (0x3F, 2000)
    report(drive, ENABLED | ACKNOWLEDGED)
    assert rpdo1(drive) == (0x2F, 2000)
    report(drive, ENABLED)
    assert rpdo1(drive) == (0x3F, 500)


def test_reached_counts_only_for_the_present_target() -> None:
    drive = enabled_yaw()
    report(drive, ENABLED | REACHED)
    rpdo1(drive)
    drive.target = 20.0
    assert not drive.reached()
    rpdo1(drive)
    report(drive, ENABLED | ACKNOWLEDGED | REACHED)
    rpdo1(drive)
    assert drive.reached()


def test_a_disabled_drive_has_reached_nothing() -> None:
    drive = joined(wheel())
    report(drive, DISABLED | REACHED)
    rpdo1(drive)
    assert not drive.reached()


def test_after_a_stop_a_position_axis_is_held_where_it_stands() -> None:
    drive = enabled_yaw()
    drive.target = 20.0
    rpdo1(drive)
    drive.goal = Goal.DISABLED
    report(drive, ON, value=700)
    assert rpdo1(drive) == (0x06, 700)


# --- stops the drive made by itself, faults, resets ---------------------------------------------------------

@pytest.mark.parametrize("statusword", [DISABLED, ON, QUICK_STOP_ACTIVE, REACTION, FAULT])
def test_a_drive_that_left_operation_by_itself_is_not_enabled_again(statusword: int) -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    report(drive, statusword)
    report(drive, DISABLED)
    assert drive.inhibited
    assert rpdo1(drive) == (0x00, 0)


def test_another_goal_ends_the_inhibition() -> None:
    drive = enabled_wheel()
    report(drive, DISABLED)
    drive.goal = Goal.DISABLED
    drive.goal = Goal.ENABLED
    assert rpdo1(drive) == (0x06, 0)


def test_a_commanded_stop_does_not_inhibit() -> None:
    drive = enabled_wheel()
    drive.goal = Goal.DISABLED
    report(drive, ON)
    report(drive, DISABLED)
    assert not drive.inhibited


@pytest.mark.parametrize("goal", list(Goal))
def test_no_goal_resets_a_fault(goal: Goal) -> None:
    drive = joined(wheel(), statusword=FAULT)
    drive.goal = goal
    assert rpdo1(drive)[0] & 0x80 == 0


def test_a_reset_is_one_rising_edge_of_bit_7() -> None:
    drive = joined(wheel(), statusword=FAULT)
    drive.reset_fault()
    assert [rpdo1(drive)[0] for _ in range(3)] == [0x80, 0x00, 0x00]


def test_without_sync_the_edge_is_kept_for_the_next_one() -> None:
    drive = joined(wheel(), statusword=FAULT)
    drive.reset_fault()
    assert [rpdo1(drive, sync)[0] for sync in (False, True, True)] == [0x80, 0x80, 0x00]


def test_a_reset_without_a_fault_sends_nothing() -> None:
    drive = enabled_wheel()
    drive.reset_fault()
    assert rpdo1(drive) == (0x0F, 0)


def test_after_a_reset_the_drive_stays_disabled_though_the_goal_is_enabled() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    report(drive, FAULT)
    drive.reset_fault()
    rpdo1(drive)
    report(drive, DISABLED)
    assert rpdo1(drive) == (0x00, 0)


def test_a_goal_set_during_the_fault_does_not_count_after_it() -> None:
    drive = joined(wheel(), statusword=FAULT)
    drive.goal = Goal.ENABLED
    drive.reset_fault()
    drive.goal = Goal.DISABLED
    drive.goal = Goal.ENABLED
    report(drive, DISABLED)
    assert (drive.inhibited, rpdo1(drive)[0]) == (True, 0x00)


# --- heartbeat, boot-up, emergencies ------------------------------------------------------------------------

def test_a_lost_drive_is_sent_a_quick_stop_until_its_voltage_is_to_be_disabled() -> None:
    drive = enabled_wheel()
    drive.target = 8.0
    drive.check_heartbeat(now=0.149)
    assert not drive.lost
    drive.check_heartbeat(now=0.151)
    assert (drive.lost, drive.online) == (True, False)
    assert rpdo1(drive) == (0x02, 0)
    drive.goal = Goal.FREE
    assert rpdo1(drive) == (0x00, 0)


def test_a_heartbeat_that_comes_back_does_not_undo_the_loss() -> None:
    drive = enabled_wheel()
    drive.check_heartbeat(now=1.0)
    drive.on_heartbeat(1.1, 5)
    assert (drive.lost, drive.online) == (True, False)


def test_a_boot_up_in_use_is_a_loss_and_nothing_more_is_sent() -> None:
    drive = enabled_wheel()
    drive.on_heartbeat(0.02, 0)
    assert (drive.rebooted, drive.lost, drive.online, drive.emit(True)) == (True, True, False, None)


def test_after_a_boot_up_the_old_tpdo1_is_not_taken_for_fresh() -> None:
    drive = enabled_wheel()
    drive.on_heartbeat(0.02, 0)
    assert drive.tpdo1_data == b""


def test_a_drive_that_left_operational_is_not_online() -> None:
    drive = enabled_wheel()
    drive.on_heartbeat(0.02, 127)
    assert (drive.online, drive.lost) == (False, False)


def test_an_emergency_stays_until_the_device_resets_it() -> None:
    drive = enabled_wheel()
    drive.on_emergency(0.5, encode_emergency(0x4310, 0x09))
    assert drive.emergency is not None
    assert drive.emergency.text == "0x4310 drive over-temperature"
    drive.on_emergency(0.6, encode_emergency(0, 0))
    assert drive.emergency is None
    assert [e.code for e in drive.take_emergencies()] == [0x4310, 0]
    assert drive.take_emergencies() == []


def test_an_emergency_storm_is_bounded_and_counted() -> None:
    drive = enabled_wheel()
    for _ in range(100):
        drive.on_emergency(0.5, encode_emergency(0x8110, 0x11))
    assert (len(drive.take_emergencies()), drive.emergencies_dropped) == (64, 36)


def test_an_acknowledgement_forgets_the_emergency() -> None:
    drive = enabled_wheel()
    drive.on_emergency(0.5, encode_emergency(0x4310, 0x09))
    drive.reset_fault()
    assert drive.emergency is None


def test_a_deep_copy_goes_its_own_way() -> None:
    drive = enabled_wheel()
    twin = copy.deepcopy(drive)
    drive.target = 8.0
    drive.on_heartbeat(1.0, 5)
    assert rpdo1(twin) == (0x0F, 0)
    assert twin.heartbeat.heard_s == 0.0
