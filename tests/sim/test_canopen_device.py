"""The simulated drive as a CANopen device: boot-up, NMT, heartbeats, object dictionary, emergencies (CiA 301)."""

from __future__ import annotations

import copy
from dataclasses import replace

import pytest

from tests.sim.drive_bench import DISABLED, NODE, PC, WHEEL, DriveBench

HEARTBEAT = 0x700 + NODE
EMCY = 0x080 + NODE


@pytest.fixture
def bench() -> DriveBench:
    return DriveBench().boot()


# boot-up and NMT


def test_power_on_ends_in_one_boot_up_message() -> None:
    bench = DriveBench(boot_s=0.2)
    bench.run(0.5)
    assert bench.heard == [(pytest.approx(0.2, abs=0.001), HEARTBEAT, b"\x00")]


def test_the_boot_up_message_is_urgent() -> None:
    bench = DriveBench(boot_s=0.2)
    bench.drive.advance(0.0, 0.25)
    assert bench.wire.urgent_s == pytest.approx(0.2, abs=0.001)


def test_nothing_answers_before_boot_up() -> None:
    bench = DriveBench(boot_s=0.2)
    bench.send(0x600 + NODE, bytes.fromhex("4000100000000000"))
    bench.run(0.1)
    assert bench.heard == []


def test_an_unpowered_device_is_silent() -> None:
    bench = DriveBench(powered=False)
    bench.send(0x600 + NODE, bytes.fromhex("4000100000000000"))
    bench.nmt(129)
    bench.run(1.0)
    assert bench.heard == []


def test_power_off_ends_the_heartbeats(bench: DriveBench) -> None:
    bench.write(0x1017, 0, 50, 2)
    bench.drive.power(False)
    bench.heard.clear()
    bench.run(1.0)
    assert bench.heard == []


def test_power_cycle_boots_with_defaults(bench: DriveBench) -> None:
    bench.write(0x1017, 0, 50, 2)
    bench.drive.power(False)
    bench.run(0.1)
    bench.drive.power(True)
    bench.run(0.3)
    assert bench.frames(HEARTBEAT).count(b"\x00") == 2
    assert bench.read(0x1017) == 0


def test_reset_node_boots_again_with_defaults(bench: DriveBench) -> None:
    bench.write(0x6083, 0, 777, 4)
    bench.nmt(129)
    bench.run(0.3)
    assert bench.frames(HEARTBEAT) == [b"\x00", b"\x00"]
    assert bench.read(0x6083) == 1000


def test_reset_communication_keeps_the_drive_parameters(bench: DriveBench) -> None:
    bench.write(0x6083, 0, 777, 4)
    bench.write(0x1017, 0, 50, 2)
    bench.nmt(130)
    bench.run(0.1)
    assert bench.frames(HEARTBEAT) == [b"\x00", b"\x00"]
    assert (bench.read(0x6083), bench.read(0x1017)) == (777, 0)


@pytest.mark.parametrize(("command", "state"), [(1, 5), (2, 4), (128, 127)])
def test_nmt_commands_show_in_the_heartbeat(bench: DriveBench, command: int, state: int) -> None:
    bench.write(0x1017, 0, 50, 2)
    bench.nmt(command)
    bench.run(0.1)
    assert bench.frames(HEARTBEAT)[-1] == bytes((state,))


def test_nmt_commands_for_all_nodes_count(bench: DriveBench) -> None:
    bench.send(0x000, b"\x01\x00")
    assert bench.drive.nmt == 5


def test_nmt_commands_for_others_do_not_count(bench: DriveBench) -> None:
    bench.send(0x000, b"\x01\x06")
    assert bench.drive.nmt == 127


def test_a_stopped_device_answers_no_sdo(bench: DriveBench) -> None:
    bench.nmt(2)
    bench.send(0x600 + NODE, bytes.fromhex("4000100000000000"))
    bench.run(0.1)
    assert bench.frames(0x580 + NODE) == []


def test_process_data_flow_in_operational_only(bench: DriveBench) -> None:
    for command, expected in ((128, 0), (1, 1), (2, 1), (1, 2), (128, 2)):
        bench.nmt(command)
        bench.sync()
        bench.run(0.01)
        assert len(bench.frames(0x180 + NODE)) == expected


# heartbeats


def test_heartbeats_carry_their_true_times_inside_a_long_advance(bench: DriveBench) -> None:
    start = bench.now
    bench.write(0x1017, 0, 50, 2)
    bench.drive.advance(bench.now, bench.now + 0.5)
    bench.now += 0.5
    bench.collect()
    times = bench.times(HEARTBEAT)[1:]
    assert len(times) >= 9
    for number, t in enumerate(times, start=1):
        assert t == pytest.approx(start + 0.05 * number, abs=0.001)


def test_the_next_timer_is_known(bench: DriveBench) -> None:
    bench.write(0x1017, 0, 50, 2)
    assert bench.now < bench.wire.ready_s <= bench.now + 0.05


def arm(bench: DriveBench, milliseconds: int = 200) -> None:
    bench.write(0x1016, 1, PC << 16 | milliseconds, 4)


def test_a_heartbeat_that_is_withheld_stays_so_when_it_is_configured_anew(bench: DriveBench) -> None:
    bench.drive.withhold_heartbeat(True)
    bench.nmt(130)
    bench.run(0.1)
    bench.heard.clear()
    bench.write(0x1017, 0, 50, 2)
    bench.run(0.5)
    assert bench.frames(HEARTBEAT) == []
    bench.drive.withhold_heartbeat(False)
    bench.run(0.5)
    assert len(bench.frames(HEARTBEAT)) >= 9


def test_the_consumer_waits_for_the_first_heartbeat(bench: DriveBench) -> None:
    arm(bench)
    bench.run(2.0)
    assert bench.emergencies == []


def test_a_lost_heartbeat_is_an_emergency_at_its_time(bench: DriveBench) -> None:
    arm(bench)
    bench.heartbeat()
    start = bench.now
    bench.run(0.5, 0.1)
    assert bench.emergencies == [(0x8130, 0x11)]
    assert bench.times(EMCY)[0] == pytest.approx(start + 0.2, abs=0.001)


def test_heartbeats_in_time_are_no_emergency(bench: DriveBench) -> None:
    arm(bench)
    for _ in range(20):
        bench.heartbeat()
        bench.run(0.15)
    assert bench.emergencies == []


def test_a_returning_heartbeat_is_an_error_reset(bench: DriveBench) -> None:
    arm(bench)
    bench.heartbeat()
    bench.run(0.5)
    bench.heartbeat()
    bench.run(0.1)
    assert bench.emergencies == [(0x8130, 0x11), (0x0000, 0x00)]


def test_a_heartbeat_lost_twice_is_reported_twice(bench: DriveBench) -> None:
    arm(bench)
    for _ in range(2):
        bench.heartbeat()
        bench.run(0.5)
    assert [code for code, _ in bench.emergencies] == [0x8130, 0x0000, 0x8130]


def test_another_node_is_not_our_heartbeat(bench: DriveBench) -> None:
    arm(bench)
    bench.heartbeat()
    for _ in range(10):
        bench.send(0x700 + 126, b"\x05")
        bench.run(0.05)
    assert bench.emergencies == [(0x8130, 0x11)]


@pytest.mark.parametrize(("behaviour", "state"), [(0, 127), (1, 5), (2, 4)])
def test_the_nmt_state_after_a_lost_heartbeat_follows_0x1029(
    bench: DriveBench, behaviour: int, state: int
) -> None:
    bench.write(0x1029, 1, behaviour, 1)
    arm(bench)
    bench.nmt(1)
    bench.heartbeat()
    bench.run(0.5)
    assert bench.drive.nmt == state


# object dictionary


def test_device_type_names_profile_402(bench: DriveBench) -> None:
    assert bench.raw("4000100000000000") == "43 00 10 00 92 01 02 00"


def test_identity_comes_from_the_configuration() -> None:
    bench = DriveBench(replace(WHEEL, vendor_id=0xAB, product_code=0xCD), serial_number=4711).boot()
    assert [bench.read(0x1018, sub) for sub in (0, 1, 2, 4)] == [4, 0xAB, 0xCD, 4711]


def test_rated_torque_and_modes_come_from_the_configuration(bench: DriveBench) -> None:
    assert bench.read(0x6076) == 20_000
    assert bench.read(0x6502) == 0b100


def test_the_device_name_is_uploaded_in_segments(bench: DriveBench) -> None:
    first = bench.sdo(bytes.fromhex("4008100000000000"))
    size = int.from_bytes(first[4:], "little")
    text, last = b"", False
    toggle = 0
    while not last:
        segment = bench.sdo(bytes((0x60 | toggle << 4,)) + bytes(7))
        assert segment[0] >> 4 & 1 == toggle
        text += segment[1 : 8 - (segment[0] >> 1 & 7)]
        toggle ^= 1
        last = bool(segment[0] & 1)
    assert first[0] == 0x41
    assert len(text) == size
    assert b"servo" in text


@pytest.mark.parametrize(
    ("index", "sub", "code"),
    [(0x1234, 0, 0x06020000), (0x6042, 0, 0x06020000), (0x1018, 9, 0x06090011), (0x6041, 1, 0x06090011)],
)
def test_a_missing_object_and_a_missing_sub_index_have_different_aborts(
    bench: DriveBench, index: int, sub: int, code: int
) -> None:
    assert bench.refused_read(index, sub) == code
    assert bench.refusal(index, sub, 0, 2) == code


@pytest.mark.parametrize(("index", "sub", "size"), [(0x6041, 0, 2), (0x1018, 1, 4), (0x1000, 0, 4), (0x60FD, 0, 4)])
def test_a_read_only_object_is_not_written(bench: DriveBench, index: int, sub: int, size: int) -> None:
    assert bench.refusal(index, sub, 1, size) == 0x06010002


@pytest.mark.parametrize(("index", "size"), [(0x6040, 4), (0x6083, 2), (0x6060, 2)])
def test_a_wrong_length_is_refused(bench: DriveBench, index: int, size: int) -> None:
    assert bench.refusal(index, 0, 1, size) == 0x06070010


@pytest.mark.parametrize(
    ("index", "sub", "value", "size"),
    [
        (0x6007, 0, 4, 2),
        (0x605A, 0, 9, 2),
        (0x605A, 0, -1, 2),
        (0x605D, 0, 0, 2),
        (0x6060, 0, 4, 1),
        (0x1003, 0, 1, 1),
        (0x1005, 0, 0x40000080, 4),
        (0x1014, 0, 0x99, 4),
        (0x1016, 1, 0x00800064, 4),
        (0x1019, 0, 1, 1),
        (0x1029, 1, 3, 1),
        (0x6098, 0, 99, 1),
    ],
)
def test_a_value_out_of_range_is_refused(
    bench: DriveBench, index: int, sub: int, value: int, size: int
) -> None:
    before = bench.read(index, sub)
    assert bench.refusal(index, sub, value, size) == 0x06090030
    assert bench.read(index, sub) == before


@pytest.mark.parametrize("index", [0x6083, 0x6084, 0x6085, 0x609A])
def test_a_ramp_of_zero_is_too_low(bench: DriveBench, index: int) -> None:
    assert bench.refusal(index, 0, 0, 4) == 0x06090032


def test_written_values_are_read_back(bench: DriveBench) -> None:
    bench.write(0x6007, 0, 3, 2)
    bench.write(0x1016, 1, PC << 16 | 200, 4)
    assert (bench.read(0x6007), bench.read(0x1016, 1)) == (3, 0x007F00C8)


def test_save_makes_values_survive_a_power_cycle(bench: DriveBench) -> None:
    bench.write(0x6083, 0, 777, 4)
    bench.write(0x1010, 1, 0x65766173, 4)
    bench.nmt(129)
    bench.run(0.3)
    assert bench.read(0x6083) == 777


def test_load_brings_the_defaults_back_with_the_next_reset(bench: DriveBench) -> None:
    bench.write(0x6083, 0, 777, 4)
    bench.write(0x1010, 1, 0x65766173, 4)
    bench.write(0x1011, 1, 0x64616F6C, 4)
    assert bench.read(0x6083) == 777
    bench.nmt(129)
    bench.run(0.3)
    assert bench.read(0x6083) == 1000


def test_save_without_the_signature_is_refused(bench: DriveBench) -> None:
    assert bench.refusal(0x1010, 1, 1, 4) == 0x08000020


def test_an_sdo_answer_comes_after_the_turnaround_time() -> None:
    bench = DriveBench(turnaround_s=0.003).boot()
    start = bench.now
    bench.read(0x1000)
    assert bench.times(0x580 + NODE)[0] == pytest.approx(start + 0.003 + 2 * 135 / 500_000)


# emergencies


def test_an_emergency_has_eight_bytes_and_is_urgent(bench: DriveBench) -> None:
    bench.drive.fault(0x4310)
    assert bench.wire.urgent_s < bench.now + 0.001
    bench.run(0.01)
    assert bench.frames(EMCY) == [bytes.fromhex("1043090000000000")]


@pytest.mark.parametrize(
    ("code", "register"),
    [(0x2310, 0x03), (0x3220, 0x05), (0x4310, 0x09), (0x7305, 0x21), (0x8130, 0x11), (0x8611, 0x21), (0xFF01, 0x81)],
)
def test_the_error_register_follows_the_class_of_the_error(bench: DriveBench, code: int, register: int) -> None:
    bench.drive.fault(code)
    bench.run(0.01)
    assert bench.emergencies == [(code, register)]
    assert bench.read(0x1001) == register


def test_the_history_holds_the_newest_error_first(bench: DriveBench) -> None:
    for code in (0x2310, 0x4310):
        bench.drive.fault(code)
    assert [bench.read(0x1003, sub) for sub in (0, 1, 2)] == [2, 0x4310, 0x2310]


def test_the_history_keeps_eight_errors(bench: DriveBench) -> None:
    for number in range(10):
        bench.drive.fault(0xFF00 + number)
    assert [bench.read(0x1003, sub) for sub in (0, 1, 8)] == [8, 0xFF09, 0xFF02]


def test_writing_zero_clears_the_history(bench: DriveBench) -> None:
    bench.drive.fault(0x2310)
    bench.write(0x1003, 0, 0, 1)
    assert [bench.read(0x1003, sub) for sub in (0, 1)] == [0, 0]


def test_a_disabled_emergency_is_not_sent(bench: DriveBench) -> None:
    bench.write(0x1014, 0, 0x80000080 + NODE, 4)
    bench.drive.fault(0x2310)
    bench.run(0.1)
    assert bench.emergencies == []


def test_a_stopped_device_sends_no_emergency(bench: DriveBench) -> None:
    bench.nmt(2)
    bench.drive.fault(0x2310)
    bench.run(0.1)
    assert bench.emergencies == []


def test_the_inhibit_time_holds_the_second_emergency_back(bench: DriveBench) -> None:
    bench.write(0x1015, 0, 500, 2)  # 50 ms
    bench.drive.fault(0x2310)
    bench.drive.fault(0x4310)
    bench.run(0.2)
    first, second = bench.times(EMCY)
    assert second - first == pytest.approx(0.05, abs=1e-4)


def test_a_persistent_cause_is_reported_again_after_a_reset(bench: DriveBench) -> None:
    bench.drive.fault(0x7305, persistent=True)
    bench.nmt(129)
    bench.run(0.4)
    assert [code for code, _ in bench.emergencies] == [0x7305, 0x7305]


def test_a_fault_survives_a_communication_reset(bench: DriveBench) -> None:
    bench.drive.fault(0x7305)
    bench.nmt(130)
    bench.run(0.1)
    assert bench.read(0x1001) == 0x21
    assert bench.read(0x6041) & 0x4F == 0x08


# copies


def test_a_copy_goes_its_own_way() -> None:
    bench = DriveBench().configured()
    bench.cycle(0x06)
    other = copy.deepcopy(bench)
    for controlword in (0x07, 0x0F):
        other.cycle(controlword, 2000)
    other.run(0.5)
    assert other.drive.axis.value == 2.0
    assert (bench.drive.axis.value, bench.state) == (0.0, 0x21)
    bench.cycle(0x00)
    assert bench.state == DISABLED


def test_a_copy_continues_exactly_as_the_original() -> None:
    bench = DriveBench().enabled()
    bench.write(0x1017, 0, 50, 2)
    bench.cycle(0x0F, 3000)
    other = copy.deepcopy(bench)
    for one in (bench, other):
        for _ in range(50):
            one.cycle(0x0F, 2500)
    assert bench.heard == other.heard
