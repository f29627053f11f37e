"""The CAN master: order of its frames, where received frames go, when it wants service."""

from __future__ import annotations

import copy
import math

import pytest

from drivers.canopen.conversation import Conversation, Pause, SdoRead, SdoWrite, SendNmt
from drivers.canopen.master import CanMaster
from drivers.canopen.messages import encode_emergency
from drivers.canopen.objects import DataType, NmtCommand
from drivers.cia402 import Goal, State
from drivers.ports import BusLost, CanFrame, FrameByFrame
from drivers.servo import ServoDrive
from tests.drivers.can_bench import BenchDrive, converse, joined, tpdo1, wheel, yaw

HEARTBEAT: tuple[int, bytes] = (0x77F, b"\x05")


class Recorder(FrameByFrame):
    """A CanPort that keeps sent frames."""

    def __init__(self) -> None:
        self.frames: list[tuple[int, bytes]] = []

    def send(self, can_id: int, data: bytes, now: float) -> None:
        self.frames.append((can_id, data))

    def receive(self, now: float) -> list[CanFrame]:
        return []

    def take(self) -> list[tuple[int, bytes]]:
        taken, self.frames = self.frames, []
        return taken


class LostPort(Recorder):
    def send(self, can_id: int, data: bytes, now: float) -> None:
        raise BusLost("unplugged")


def bus() -> tuple[CanMaster, ServoDrive, ServoDrive]:
    """Return a master with a wheel (node 1) and a belt with digital outputs (node 2), both connected."""
    master = CanMaster()
    drives = joined(wheel(node_id=1)), joined(wheel(name="belt", node_id=2, digital_io=True))
    for drive in drives:
        master.add(drive)
    return master, *drives


# --- scan ---------------------------------------------------------------------------------------------------

def test_a_scan_sends_outputs_rpdos_sync_and_heartbeat_in_this_order() -> None:
    master, _, belt = bus()
    belt.outputs = 0x0001_0000
    port = Recorder()
    master.scan(port, 0.0)
    assert [can_id for can_id, _ in port.frames] == [0x302, 0x201, 0x202, 0x080, 0x77F]
    assert port.frames[3] == (0x080, b"")


def test_without_sync_the_rpdos_still_go_out() -> None:
    master, _, _ = bus()
    master.sync = False
    port = Recorder()
    master.scan(port, 0.0)
    assert [can_id for can_id, _ in port.frames] == [0x201, 0x202, 0x77F]


def test_a_drive_that_is_not_connected_gets_no_rpdo() -> None:
    master = CanMaster()
    master.add(ServoDrive(wheel()))
    port = Recorder()
    master.scan(port, 0.0)
    assert port.take() == [(0x080, b""), HEARTBEAT]


def test_service_sends_neither_rpdo_nor_sync() -> None:
    master, _, _ = bus()
    port = Recorder()
    master.service(port, 0.0)
    assert port.take() == [HEARTBEAT]


def test_a_lost_wire_is_reported_to_the_caller() -> None:
    master, _, _ = bus()
    with pytest.raises(BusLost):
        master.scan(LostPort(), 0.0)


# --- our heartbeat ------------------------------------------------------------------------------------------

def test_our_heartbeat_leaves_every_50_ms_and_only_when_served() -> None:
    master = CanMaster()
    port = Recorder()
    times = [tick / 1000 for tick in range(200) if (master.service(port, tick / 1000), port.take())[1]]
    assert times == pytest.approx([0.0, 0.05, 0.1, 0.15])


def test_a_late_scan_sends_one_heartbeat_not_the_missed_ones() -> None:
    master = CanMaster()
    port = Recorder()
    master.service(port, 0.0)
    master.service(port, 1.0)
    assert len(port.frames) == 2


def test_the_deadline_is_the_next_heartbeat() -> None:
    master = CanMaster()
    assert master.deadline == -math.inf
    master.service(Recorder(), 2.0)
    assert master.deadline == pytest.approx(2.05)


def test_ticks_of_10_ms_carry_the_heartbeat_without_extra_ticks() -> None:
    master = CanMaster()
    port = Recorder()
    sent = 0
    for tick in range(1000):
        now = tick * 0.01 + 1e-13 * (tick % 3)
        master.scan(port, now)
        sent += HEARTBEAT in port.take()
        assert master.deadline > now
    assert sent == 200


def test_a_withheld_heartbeat_is_not_sent_and_returns_at_once() -> None:
    master = CanMaster()
    port = Recorder()
    master.service(port, 0.0)
    port.take()
    master.withhold_heartbeat = True
    for tick in range(40):
        master.scan(port, tick * 0.01)
    assert HEARTBEAT not in port.take()
    master.withhold_heartbeat = False
    assert master.deadline == -math.inf
    master.service(port, 0.4)
    assert port.take() == [HEARTBEAT]


# --- frames in ----------------------------------------------------------------------------------------------

def test_each_frame_goes_to_its_drive() -> None:
    master, drive, belt = bus()
    master.feed([(0.01, 0x181, tpdo1(0x0240, 100, 0)), (0.011, 0x182, tpdo1(0x0240, 200, 0)),
                 (0.012, 0x282, b"\x01\0\0\0"), (0.013, 0x082, encode_emergency(0x4310, 9))], 0.02)
    assert (drive.actual, belt.actual, belt.inputs) == (0.1, 0.2, 1)
    assert belt.emergency is not None
    assert drive.emergency is None


def test_an_unchanged_tpdo1_still_renews_the_stamp() -> None:
    master, drive, _ = bus()
    master.feed([(0.01, 0x181, tpdo1(0x0240, 100, 0))], 0.01)
    master.feed([(0.02, 0x181, tpdo1(0x0240, 100, 0))], 0.02)
    assert (drive.stamp_s, drive.actual) == (0.02, 0.1)


def test_two_tpdo1_in_one_feed_leave_the_newer() -> None:
    master, drive, _ = bus()
    master.feed([(0.01, 0x181, tpdo1(0x0240, 100, 0)), (0.02, 0x181, tpdo1(0x0240, 300, 0))], 0.02)
    assert (drive.stamp_s, drive.actual) == (0.02, 0.3)


@pytest.mark.parametrize(("can_id", "data"), [(0x199, bytes(8)), (0x709, b"\x05"), (0x589, bytes(8)),
                                              (0x100, bytes(6)), (0x381, bytes(8)), (0x701, b"\x05\x00")])
def test_frames_without_an_owner_are_counted(can_id: int, data: bytes) -> None:
    master, _, _ = bus()
    master.feed([(0.0, can_id, data)], 0.0)
    assert (master.unknown_frames, master.foreign_master) == (1, False)


@pytest.mark.parametrize(("can_id", "data", "name"), [
    (0x000, b"\x01\x00", "NMT 000#0100"),
    (0x080, b"", "SYNC 080#"),
    (0x201, bytes(6), "RPDO1 201#000000000000"),
    (0x302, bytes(4), "RPDO2 302#00000000"),
    (0x403, b"\x01", "RPDO3 403#01"),
    (0x504, b"\x01", "RPDO4 504#01"),
    (0x601, bytes.fromhex("40 00 10 00 00 00 00 00"), "SDO request 601#4000100000000000"),
    (0x77F, b"\x05", "heartbeat of our node id 77F#05"),
])
def test_frames_that_only_a_master_sends_reveal_another_master(can_id: int, data: bytes, name: str) -> None:
    master, _, _ = bus()
    master.feed([(0.0, can_id, data)], 0.0)
    assert (master.foreign_master, master.foreign_frame) == (True, name)


def test_the_first_foreign_frame_is_the_one_described() -> None:
    master, _, _ = bus()
    master.feed([(0.0, 0x080, b""), (0.0, 0x201, bytes(6))], 0.0)
    assert master.foreign_frame == "SYNC 080#"


def test_the_drives_own_frames_are_not_foreign() -> None:
    master, _, _ = bus()
    master.feed([(0.0, 0x181, bytes(8)), (0.0, 0x701, b"\x05"), (0.0, 0x581, bytes(8)), (0.0, 0x081, bytes(8))], 0.0)
    assert not master.foreign_master


# --- drives' heartbeats -------------------------------------------------------------------------------------

def test_a_silent_drive_is_lost_at_the_deadline_150_ms_after_its_last_heartbeat() -> None:
    master, drive, belt = bus()
    port = Recorder()
    master.feed([(0.1, 0x701, b"\x05"), (0.1, 0x702, b"\x05")], 0.1)
    master.service(port, 0.1)
    for tick in range(11, 25):
        now = tick * 0.01
        master.feed([(now, 0x702, b"\x05")] if tick % 5 == 0 else [], now)
        master.service(port, now)
    assert not drive.lost
    assert master.deadline == pytest.approx(0.25)
    master.feed([(0.25, 0x702, b"\x05")], 0.25)
    master.service(port, 0.25)
    assert (drive.lost, belt.lost) == (True, False)


def test_a_lost_drive_is_sent_a_quick_stop_by_the_next_scan() -> None:
    master, drive, _ = bus()
    drive.goal = Goal.ENABLED
    drive.target = 8.0
    master.feed([(0.01, 0x181, tpdo1(0x0227, 0, 0))], 0.01)
    master.service(Recorder(), 1.0)
    port = Recorder()
    master.scan(port, 1.01)
    assert (0x201, bytes.fromhex("0200 00000000")) in port.frames


# --- conversations ------------------------------------------------------------------------------------------

def test_five_drives_are_brought_up_side_by_side() -> None:
    master = CanMaster()
    benches = [BenchDrive(node) for node in range(1, 6)]
    drives = [ServoDrive(wheel(node_id=1)), ServoDrive(wheel(node_id=2)), ServoDrive(wheel(node_id=3)),
              ServoDrive(yaw(node_id=4)), ServoDrive(yaw(node_id=5))]
    for drive in drives:
        master.add(drive)
        master.start(drive, drive.connect())

    class Together(FrameByFrame):
        def send(self, can_id: int, data: bytes, now: float) -> None:
            for bench in benches:
                bench.send(can_id, data, now)

        def receive(self, now: float) -> list[CanFrame]:
            return sorted(frame for bench in benches for frame in bench.receive(now))

    port = Together()
    tick = 0
    while any(master.busy(drive) for drive in drives) and tick < 5000:
        now = tick / 1000
        if tick % 50 == 0:
            for bench in benches:
                bench.heartbeat(now)
        master.feed(port.receive(now), now)
        master.service(port, now)
        tick += 1
    assert [(drive.refused, drive.online, drive.state) for drive in drives] == [
        (None, True, State.SWITCH_ON_DISABLED)] * 5
    assert tick < 500


def test_an_outstanding_reply_asks_for_service_within_milliseconds() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)

    def talk() -> Conversation:
        yield SdoRead(0x1000)
    master.start(drive, talk())
    assert master.deadline == -math.inf
    master.service(Recorder(), 1.0)
    assert 1.0 < master.deadline <= 1.005


def test_a_second_conversation_with_the_same_drive_is_refused() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    master.start(drive, drive.connect())
    with pytest.raises(ValueError, match="still running"):
        master.start(drive, drive.diagnose())


def test_a_cancelled_conversation_sends_no_more_frames() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    master.start(drive, drive.connect())
    master.cancel(drive)
    port = Recorder()
    master.service(port, 0.0)
    assert (master.busy(drive), port.take()) == (False, [HEARTBEAT])


def test_a_reply_older_than_the_request_is_not_taken_for_its_answer() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    read: list[object] = []

    def talk() -> Conversation:
        yield Pause(0.1)
        read.append((yield SdoRead(0x6041)))
    bench = BenchDrive()
    master.start(drive, talk())
    master.service(bench, 0.0)
    master.feed([(0.05, 0x585, bytes.fromhex("4B 41 60 00 37 06 00 00"))], 0.05)
    converse(master, drive, bench, seconds=1.0, start=0.06)
    assert read == [0x0240]


def test_texts_and_objects_outside_the_dictionary_can_be_transferred() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    read: list[object] = []

    def talk() -> Conversation:
        yield SdoWrite(0x2100, 1, "abc", DataType.TEXT)
        read.append((yield SdoRead(0x2100, 1, DataType.TEXT)))
        yield SendNmt(NmtCommand.STOP)
    master.start(drive, talk())
    port = Recorder()
    master.service(port, 0.0)
    assert port.frames[-1] == (0x605, bytes.fromhex("27 00 21 01 61 62 63 00"))
    master.feed([(0.001, 0x585, bytes.fromhex("60 00 21 01 00 00 00 00"))], 0.001)
    master.service(port, 0.001)
    master.feed([(0.002, 0x585, bytes.fromhex("47 00 21 01 61 62 63 00"))], 0.002)
    master.service(port, 0.002)
    assert (read, port.frames[-1]) == (["abc"], (0x000, b"\x02\x05"))
    assert not master.busy(drive)


def test_replies_are_worth_an_immediate_service() -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    master.start(drive, drive.connect())
    master.service(Recorder(), 1.0)
    master.feed([(1.001, 0x705, b"\x00")], 1.001)
    assert master.deadline <= 1.001


# --- housekeeping -------------------------------------------------------------------------------------------

@pytest.mark.parametrize("node_id", [1, 126])
def test_a_node_id_can_be_taken_once(node_id: int) -> None:
    master = CanMaster(node_id=126)
    master.add(ServoDrive(wheel(node_id=1)))
    with pytest.raises(ValueError, match="taken"):
        master.add(ServoDrive(wheel(node_id=node_id)))


def test_a_deep_copy_of_a_bus_goes_its_own_way() -> None:
    master, drive, _ = bus()
    twin = copy.deepcopy(master)
    master.feed([(0.01, 0x181, tpdo1(0x0240, 100, 0))], 0.01)
    twin_wheel = twin.nodes[0]
    assert (drive.stamp_s, twin_wheel.stamp_s) == (0.01, -math.inf)
    twin.feed([(0.02, 0x181, tpdo1(0x0240, 500, 0))], 0.02)
    assert (drive.actual, twin_wheel.actual) == (0.1, 0.5)


