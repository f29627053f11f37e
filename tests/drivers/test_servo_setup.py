"""Bring-up, homing, diagnosis and release, frame by frame against a hand-written drive."""

from __future__ import annotations

import struct

import pytest

from drivers.axis import AxisConfig
from drivers.canopen.master import CanMaster
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from tests.drivers.can_bench import NODE, BenchDrive, converse, tpdo1, wheel, yaw


def connect(bench: BenchDrive, config: AxisConfig | None = None) -> tuple[CanMaster, ServoDrive, float]:
    master = CanMaster()
    drive = ServoDrive(config or wheel())
    master.add(drive)
    master.start(drive, drive.connect())
    ended = converse(master, drive, bench, seconds=20.0)
    assert not master.busy(drive)
    return master, drive, ended


def refusal(bench: BenchDrive, config: AxisConfig | None = None) -> str:
    _, drive, _ = connect(bench, config)
    assert drive.refused is not None
    assert (drive.online, drive.emit(True)) == (False, None)
    return drive.refused


def sent(bench: BenchDrive, can_id: int) -> list[bytes]:
    return [data for _, frame_id, data in bench.sent if frame_id == can_id]


def test_a_connected_drive_is_operational_and_switch_on_disabled() -> None:
    _, drive, _ = connect(BenchDrive())
    assert (drive.refused, drive.online, drive.lost, drive.state) == (None, True, False, State.SWITCH_ON_DISABLED)


def test_nothing_is_commanded_after_connect() -> None:
    _, drive, _ = connect(BenchDrive())
    assert (drive.target, drive.goal, drive.outputs) == (0.0, Goal.DISABLED, 0)
    assert drive.emit(True) == bytes(6)


def test_the_conversation_begins_with_a_reset_of_this_nodes_communication() -> None:
    bench = BenchDrive()
    connect(bench)
    nmt = sent(bench, 0)
    assert nmt == [b"\x82\x05", b"\x01\x05"]


def test_our_heartbeat_is_on_the_bus_before_the_drive_watches_it() -> None:
    bench = BenchDrive()
    connect(bench)
    ids = [(can_id, data[:4]) for _, can_id, data in bench.sent]
    armed = ids.index((0x605, bytes.fromhex("23 16 10 01")))
    assert (0x77F, b"\x05") in ids[:armed]


def test_the_watch_on_us_is_node_127_within_200_ms_and_read_back() -> None:
    bench = BenchDrive()
    _, drive, _ = connect(bench)
    assert bytes.fromhex("23 16 10 01 C8 00 7F 00") in sent(bench, 0x605)
    assert drive.parameters[0x1016, 1] == 0x007F00C8


def test_the_parameters_of_a_wheel_are_these() -> None:
    bench = BenchDrive()
    connect(bench)
    assert bench.writes == [
        (0x6040, 0, 0),
        (0x1006, 0, 0), (0x1029, 1, 1),
        (0x6007, 0, 3), (0x605A, 0, 2), (0x605B, 0, 0), (0x605C, 0, 1), (0x605D, 0, 1), (0x605E, 0, 2),
        (0x6083, 0, 20_000), (0x6084, 0, 20_000), (0x6085, 0, 60_000), (0x6072, 0, 3000), (0x6080, 0, 50_000),
        (0x6060, 0, 3), (0x60FF, 0, 0),
        (0x1400, 1, 0x80000205), (0x1600, 0, 0), (0x1600, 1, 0x60400010), (0x1600, 2, 0x60FF0020),
        (0x1600, 0, 2), (0x1400, 2, 1), (0x1400, 1, 0x205),
        (0x1401, 1, 0x80000305),
        (0x1800, 1, 0xC0000185), (0x1A00, 0, 0), (0x1A00, 1, 0x60410010), (0x1A00, 2, 0x606C0020),
        (0x1A00, 3, 0x60770010), (0x1A00, 0, 3), (0x1800, 2, 1), (0x1800, 1, 0x40000185),
        (0x1801, 1, 0xC0000285),
        (0x1017, 0, 50), (0x1016, 1, 0x007F00C8),
    ]


def test_a_press_maps_its_position_and_the_digital_io() -> None:
    bench = BenchDrive()
    connect(bench, wheel(name="press", feedback="position", position_increments=1000.0, digital_io=True))
    for expected in ((0x1A00, 2, 0x60640020), (0x1601, 1, 0x60FE0120), (0x1401, 2, 255), (0x1401, 1, 0x305),
                     (0x1A01, 1, 0x60FD0020), (0x1801, 2, 255), (0x1801, 1, 0x40000285), (0x60FE, 1, 0),
                     (0x60FE, 2, 0xFFFF0000)):
        assert expected in bench.writes


def test_the_digital_inputs_get_the_timer_of_the_configuration() -> None:
    bench = BenchDrive()
    _, drive, _ = connect(bench, wheel(digital_io=True, inputs_period_s=0.2))
    assert bench.objects[(0x1801, 5)] == drive.parameters[(0x1801, 5)] == 200


def test_the_digital_inputs_are_read_at_connect() -> None:
    bench = BenchDrive()
    bench.objects[0x60FD, 0] = 0x0003_0000
    _, drive, _ = connect(bench, wheel(digital_io=True))
    assert drive.inputs == 0x0003_0000


def test_a_yaw_axis_is_set_to_profile_position_where_it_stands() -> None:
    bench = BenchDrive()
    bench.objects[0x6064, 0] = 512
    _, drive, _ = connect(bench, yaw(position_window=0.05))
    for expected in ((0x6060, 0, 1), (0x607A, 0, 512), (0x6081, 0, 1000), (0x607D, 1, 2**32 - 3000),
                     (0x607D, 2, 3000), (0x6067, 0, 5), (0x1600, 2, 0x607A0020), (0x1A00, 2, 0x60640020)):
        assert expected in bench.writes
    assert (drive.target, drive.actual, drive.homed) == (5.12, 5.12, False)


def test_the_rpdo_deadline_is_set_where_configured() -> None:
    bench = BenchDrive()
    connect(bench, wheel(rpdo_deadline_s=0.25))
    assert (0x1400, 5, 250) in bench.writes


def test_the_identity_of_the_drive_is_kept() -> None:
    _, drive, _ = connect(BenchDrive())
    assert drive.identity is not None
    assert (drive.identity.vendor_id, drive.identity.product_code, drive.identity.serial_number) == (
        0x000F71C7, 0x402, 77)


def test_everything_read_back_is_kept() -> None:
    bench = BenchDrive()
    _, drive, _ = connect(bench)
    written = {(index, sub) for index, sub, _ in bench.writes}
    assert written <= drive.parameters.keys()
    assert drive.parameters[0x6085, 0] == 60_000


def test_the_statusword_in_fault_is_connected_and_left_in_fault() -> None:
    bench = BenchDrive()
    bench.objects[0x6041, 0] = 0x0218
    _, drive, _ = connect(bench)
    assert (drive.refused, drive.online, drive.state) == (None, True, State.FAULT)
    assert not any(index == 0x6040 and value & 0x80 for index, _, value in bench.writes)


def test_a_running_drive_is_stopped_by_quick_stop_before_it_is_configured() -> None:
    bench = BenchDrive()
    bench.objects[0x6041, 0] = 0x0627

    def stop(index: int, sub: int, value: int) -> int:
        if (index, value) == (0x6040, 2):
            bench.objects[0x6041, 0] = 0x0240
        return value
    bench.on_write = stop
    _, drive, _ = connect(bench)
    assert bench.writes[:2] == [(0x6040, 0, 2), (0x6040, 0, 0)]
    assert drive.refused is None


def test_a_quick_stop_that_holds_the_axis_ends_at_rest() -> None:
    bench = BenchDrive()
    bench.objects[0x6041, 0] = 0x0607

    def off(index: int, sub: int, value: int) -> int:
        if (index, value) == (0x6040, 0):
            bench.objects[0x6041, 0] = 0x0240
        return value
    bench.on_write = off
    assert connect(bench)[1].refused is None


def test_a_drive_without_boot_up_that_answers_is_connected() -> None:
    bench = BenchDrive()
    bench.boots = False
    assert connect(bench)[1].refused is None


# --- refusals name object, value written, value read or abort -----------------------------------------------

def test_an_absent_drive_is_named() -> None:
    bench = BenchDrive()
    bench.boots = bench.answers = False
    assert refusal(bench) == ("no boot-up message within 2 s; 0x1000:00 (device type): "
                              "read failed: no reply within 0.3 s")


def test_a_device_that_is_no_drive_is_refused() -> None:
    bench = BenchDrive()
    bench.objects[0x1000, 0] = 0x00020191
    assert "0x1000:00 (device type): read 0x00020191, no CiA 402 drive" in refusal(bench)


@pytest.mark.parametrize(("sub", "value", "text"), [
    (1, 0x2E1, "0x1018:01 (vendor id): read 0x000002E1, the configuration has 0x000F71C7"),
    (2, 0x403, "0x1018:02 (product code): read 0x00000403"),
])
def test_a_drive_of_another_kind_is_refused(sub: int, value: int, text: str) -> None:
    bench = BenchDrive()
    bench.objects[0x1018, sub] = value
    assert text in refusal(bench)


def test_a_swapped_drive_is_found_by_its_serial_number() -> None:
    assert "0x1018:04 (serial number)" in refusal(BenchDrive(), wheel(serial_number=78))


def test_a_drive_without_the_mode_is_refused() -> None:
    bench = BenchDrive()
    bench.objects[0x6502, 0] = 0x21
    assert "read 0x00000021, without PROFILE_VELOCITY" in refusal(bench)


def test_a_value_the_drive_did_not_keep_is_refused() -> None:
    bench = BenchDrive()
    bench.on_write = lambda index, sub, value: 1 if index == 0x605E else value
    assert refusal(bench) == "0x605E:00 (fault reaction option code): wrote 2, read 1"


def test_an_abort_is_named_with_object_and_value() -> None:
    bench = BenchDrive()
    bench.aborts["write", 0x1016, 1] = 0x06020000
    assert refusal(bench) == ("0x1016:01 (consumer heartbeat (node << 16 | ms)): write of 8323272 "
                              "failed: abort 0x06020000 (object does not exist)")


def test_a_mode_the_drive_does_not_confirm_is_refused() -> None:
    bench = BenchDrive()
    bench.aborts["read", 0x6061, 0] = 0x08000022
    assert "0x6061:00 (mode of operation display): read failed: abort 0x08000022 (refused" in refusal(bench)


def test_a_drive_that_does_not_start_is_refused() -> None:
    bench = BenchDrive()
    bench.starts = False
    assert "not OPERATIONAL within 1 s of NMT start: the heartbeat reports PRE-OPERATIONAL" in refusal(bench)


def test_a_drive_that_does_not_switch_off_is_refused() -> None:
    bench = BenchDrive()
    bench.objects[0x6041, 0] = 0x0233
    assert ("0x6041:00 (statusword): read 0x0233 (SWITCHED_ON), not SWITCH_ON_DISABLED after 1 s"
            in refusal(bench))


@pytest.mark.parametrize("missing", [(0x1006, 0), (0x1029, 1)])
def test_a_drive_without_an_optional_object_is_accepted(missing: tuple[int, int]) -> None:
    bench = BenchDrive()
    bench.aborts["write", *missing] = 0x06020000
    assert connect(bench)[1].refused is None


def test_a_sync_period_that_stays_is_refused() -> None:
    bench = BenchDrive()
    bench.on_write = lambda index, sub, value: 10_000 if index == 0x1006 else value
    assert "0x1006:00 (SYNC period (us)): wrote 0, read 10000" in refusal(bench)


def test_a_refused_drive_is_sent_back_to_pre_operational() -> None:
    bench = BenchDrive()
    bench.objects[0x1000, 0] = 0
    refusal(bench)
    assert sent(bench, 0)[-1] == b"\x80\x05"


def test_a_value_of_the_wrong_length_is_refused() -> None:
    bench = BenchDrive()

    class Wide(BenchDrive):
        def reply(self, can_id: int, data: bytes, t: float) -> None:
            wide = data[:4] == bytes.fromhex("4B 41 60 00")
            super().reply(can_id, b"\x43" + data[1:] if wide else data, t)
    bench = Wide()
    assert "0x6041:00 (statusword): read failed: U16 has 2 bytes, 4 came" in refusal(bench)


# --- homing -------------------------------------------------------------------------------------------------

class HomingBench(BenchDrive):
    """A drive that follows the controlword and finds its reference after ``steps`` scans."""

    def __init__(self, steps: int = 10, outcome: int = 0x1400) -> None:
        super().__init__()
        self.steps = steps
        self.outcome = outcome
        self.words: list[int] = []
        self.started = 0
        self.objects[0x6064, 0] = 4321

    def send(self, can_id: int, data: bytes, now: float) -> None:
        super().send(can_id, data, now)
        if can_id == 0x200 + NODE:
            self.words.append(struct.unpack_from("<H", data)[0])
        elif can_id == 0x080 and self.words:
            self._step(self.words[-1], now)

    def _step(self, word: int, now: float) -> None:
        low = word & 0x0F
        status = {0x06: 0x0221, 0x07: 0x0223, 0x0F: 0x0227}.get(low, 0x0240)
        if low == 0x0F and self.objects.get((0x6061, 0)) == 6:
            if word & 0x10:
                self.started += 1
                if self.started >= self.steps:
                    status |= self.outcome
                    offset = self.objects.get((0x607C, 0), 0)     # the zero lies this far beyond the switch
                    self.objects[0x6064, 0] = 2**32 - offset if offset >= 2**31 else -offset
            else:
                status |= 0x0400
        self.objects[0x6041, 0] = status
        self.reply(0x180 + NODE, tpdo1(status, self.objects[0x6064, 0], 0), now + 0.001)


def home(bench: BenchDrive, config: AxisConfig, start_goal: Goal = Goal.DISABLED) -> ServoDrive:
    master, drive, now = connect(bench, config)
    drive.goal = start_goal
    master.start(drive, drive.home())

    def scan(at: float) -> None:
        if round(at * 1000) % 10 == 0:
            master.scan(bench, at)
    converse(master, drive, bench, seconds=90.0, start=now + 0.001, each=scan)
    assert not master.busy(drive)
    return drive


def test_a_homed_axis_has_its_new_position_as_reading_and_target() -> None:
    drive = home(HomingBench(), yaw(home_offset=-2.5))
    assert (drive.refused, drive.homed, drive.actual, drive.target) == (None, True, 2.5, 2.5)


def test_homing_writes_its_parameters_and_returns_to_its_mode() -> None:
    bench = HomingBench()
    home(bench, yaw(home_offset=-2.5, homing_method=17))
    tail = bench.writes[-7:]
    assert tail == [(0x6098, 0, 17), (0x6099, 1, 200), (0x6099, 2, 50), (0x609A, 0, 2000),
                    (0x607C, 0, 2**32 - 250), (0x6060, 0, 6), (0x6060, 0, 1)]


def test_homing_ends_with_the_power_off() -> None:
    drive = home(HomingBench(), yaw())
    assert (drive.state, drive.goal) == (State.SWITCH_ON_DISABLED, Goal.DISABLED)


def test_a_press_is_homed_and_returns_to_profile_velocity() -> None:
    bench = HomingBench()
    config = wheel(name="press", feedback="position", position_increments=100.0, home_offset=2.5)
    drive = home(bench, config)
    assert (drive.homed, drive.actual, drive.target) == (True, -2.5, 0.0)
    assert bench.writes[-1] == (0x6060, 0, 3)


def test_a_reference_found_at_once_is_accepted() -> None:
    assert home(HomingBench(steps=1), yaw()).homed


def test_a_homing_error_is_refused_and_the_axis_stopped() -> None:
    drive = home(HomingBench(outcome=0x2400), yaw())
    assert drive.refused == "homing failed: statusword 0x2627 (OPERATION_ENABLED)"
    assert (drive.homed, drive.state) == (False, State.SWITCH_ON_DISABLED)


def test_a_homing_that_never_ends_is_refused_and_stopped() -> None:
    bench = HomingBench(steps=10**9)
    drive = home(bench, yaw(home_timeout_s=1.0))
    assert drive.refused == "homing: not finished within 1 s"
    assert (drive.state, bench.words[-1]) == (State.SWITCH_ON_DISABLED, 0x02)


def test_a_goal_set_by_the_caller_ends_the_homing() -> None:
    bench = HomingBench(steps=10**9)
    master, drive, now = connect(bench, yaw())
    master.start(drive, drive.home())

    def interfere(at: float) -> None:
        if bench.started > 5:
            drive.goal = Goal.DISABLED
        if round(at * 1000) % 10 == 0:
            master.scan(bench, at)
    converse(master, drive, bench, seconds=20.0, start=now + 0.001, each=interfere)
    assert drive.refused is not None
    assert "homing failed" in drive.refused


def test_an_axis_without_a_position_cannot_be_homed() -> None:
    drive = home(HomingBench(), wheel())
    assert drive.refused == "homing needs a drive online, with position feedback and homing mode"


# --- diagnosis and release ----------------------------------------------------------------------------------

def test_a_diagnosis_reads_code_register_and_history_and_writes_nothing() -> None:
    bench = BenchDrive()
    master, drive, now = connect(bench)
    before = len(bench.writes)
    bench.objects |= {(0x603F, 0): 0x4310, (0x1001, 0): 0x09, (0x1003, 0): 2, (0x1003, 1): 0x00004310,
                      (0x1003, 2): 0x00008130}
    master.start(drive, drive.diagnose())
    converse(master, drive, bench, seconds=1.0, start=now + 0.001)
    assert drive.diagnosis is not None
    assert (drive.diagnosis.error_code, drive.diagnosis.register) == (0x4310, 0x09)
    assert drive.diagnosis.history == (0x4310, 0x8130)
    assert len(bench.writes) == before


def test_a_diagnosis_of_a_silent_drive_reports_the_silence() -> None:
    bench = BenchDrive()
    master, drive, now = connect(bench)
    bench.answers = False
    master.start(drive, drive.diagnose())
    converse(master, drive, bench, seconds=1.0, start=now + 0.001)
    assert drive.diagnosis is not None
    assert drive.diagnosis.failed == "0x603F:00 (error code): read failed: no reply within 0.3 s"


def test_a_released_drive_watches_us_no_more_and_is_pre_operational() -> None:
    bench = BenchDrive()
    master, drive, now = connect(bench)
    master.start(drive, drive.release())
    converse(master, drive, bench, seconds=1.0, start=now + 0.001)
    assert (bench.writes[-1], bench.nmt_state) == ((0x1016, 1, 0), 127)
    assert (drive.refused, drive.online, drive.emit(True)) == (None, False, None)
