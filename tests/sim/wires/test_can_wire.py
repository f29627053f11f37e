"""The CAN bus in place: wire times, order, urgency, load, watchers."""

from __future__ import annotations

import copy
from math import inf

import pytest

from drivers.ports import BusLost
from sim.wires.can_traffic import Beat, SyncFollower, frame_bits
from sim.wires.can_wire import CanWire

FULL_S = 135 / 500_000
EMPTY_S = 55 / 500_000


class Echo:
    """Listens to an identifier and answers on another in place."""

    def __init__(self, wire: CanWire, can_id: int, answer_id: int, delay_s: float = 0.0) -> None:
        self.wire = wire
        self.answer_id = answer_id
        self.delay_s = delay_s
        self.heard: list[tuple[float, bytes]] = []
        wire.listen(can_id, self.on_frame)

    def on_frame(self, data: bytes, t: float) -> None:
        self.heard.append((t, data))
        self.wire.transmit(self.answer_id, data, t + self.delay_s)


class Log:
    def __init__(self) -> None:
        self.frames: list[tuple[float, int, bytes, bool]] = []

    def frame(self, t: float, can_id: int, data: bytes, from_pc: bool) -> None:
        self.frames.append((t, can_id, data, from_pc))


@pytest.mark.parametrize(("length", "bits"), [(0, 55), (6, 115), (8, 135)])
def test_frame_length_counts_worst_case_stuffing(length: int, bits: int) -> None:
    assert frame_bits(length) == bits


def test_a_frame_reaches_its_listener_after_its_wire_time() -> None:
    wire = CanWire()
    node = Echo(wire, 0x201, 0x181)
    wire.send(0x201, bytes(8), 1.0)
    assert node.heard == [(1.0 + FULL_S, bytes(8))]


def test_the_answer_arrives_one_wire_time_later() -> None:
    wire = CanWire()
    Echo(wire, 0x201, 0x181)
    wire.send(0x201, bytes(8), 1.0)
    assert wire.receive(1.0) == []
    (frame,) = wire.receive(1.01)
    assert frame == (pytest.approx(1.0 + 2 * FULL_S), 0x181, bytes(8))


def test_frames_sent_together_follow_each_other() -> None:
    wire = CanWire()
    first, second = Echo(wire, 0x201, 0x181, 1.0), Echo(wire, 0x202, 0x182, 1.0)
    wire.send(0x201, bytes(8), 0.0)
    wire.send(0x202, bytes(8), 0.0)
    assert second.heard[0][0] - first.heard[0][0] == pytest.approx(FULL_S)


def test_an_unknown_identifier_reaches_no_listener() -> None:
    wire = CanWire()
    node = Echo(wire, 0x201, 0x181)
    wire.send(0x333, b"", 0.0)
    assert node.heard == []
    assert wire.receive(1.0) == []


def test_every_listener_of_a_broadcast_is_called_in_order_of_attachment() -> None:
    wire = CanWire()
    for number in (1, 2, 3):
        Echo(wire, 0x80, 0x180 + number)
    wire.send(0x80, b"", 0.0)
    assert [can_id for _, can_id, _ in wire.receive(1.0)] == [0x181, 0x182, 0x183]


def test_a_removed_listener_gets_no_more_frames() -> None:
    wire = CanWire()
    node, other = Echo(wire, 0x80, 0x181), Echo(wire, 0x80, 0x182)
    wire.forget(0x80, node.on_frame)
    wire.send(0x80, b"", 0.0)
    assert (len(node.heard), len(other.heard)) == (0, 1)


def test_receive_returns_only_arrived_frames() -> None:
    wire = CanWire()
    wire.transmit(0x701, b"\x05", 0.010)
    wire.transmit(0x702, b"\x05", 0.020)
    assert [can_id for _, can_id, _ in wire.receive(0.015)] == [0x701]
    assert [can_id for _, can_id, _ in wire.receive(0.030)] == [0x702]
    assert wire.receive(0.040) == []


def test_frames_that_overlap_the_reading_are_split() -> None:
    wire = CanWire()
    for number in range(1, 6):
        Echo(wire, 0x80, 0x180 + number)
    wire.send(0x80, b"", 0.0)
    early = wire.receive(EMPTY_S * 3.5)
    late = wire.receive(1.0)
    assert [can_id for _, can_id, _ in early + late] == [0x181, 0x182, 0x183, 0x184, 0x185]
    assert len(early) == 2


def test_timed_frames_keep_their_times_whatever_the_order_of_the_nodes() -> None:
    wire = CanWire()
    wire.transmit(0x705, b"\x05", 0.040)
    wire.transmit(0x701, b"\x05", 0.003)
    assert [(round(t, 3), can_id) for t, can_id, _ in wire.receive(0.1)] == [(0.003, 0x701), (0.040, 0x705)]


def test_the_lower_identifier_wins_the_wire() -> None:
    wire = CanWire()
    wire.transmit(0x705, b"\x05", 0.010)
    wire.transmit(0x701, b"\x05", 0.010)
    assert [can_id for _, can_id, _ in wire.receive(0.1)] == [0x701, 0x705]


def test_a_delayed_answer_leaves_the_wire_to_others() -> None:
    wire = CanWire()
    Echo(wire, 0x601, 0x581, delay_s=0.005)
    node = Echo(wire, 0x202, 0x182)
    wire.send(0x601, bytes(8), 0.0)
    wire.send(0x202, bytes(8), 0.0)
    assert node.heard[0][0] == pytest.approx(2 * FULL_S)
    assert [can_id for _, can_id, _ in wire.receive(0.1)] == [0x182, 0x581]


def test_a_long_burst_is_delivered_whole_and_in_order() -> None:
    wire = CanWire()
    node = Echo(wire, 0x601, 0x581, delay_s=0.0005)
    for number in range(200):
        wire.send(0x601, bytes((number,)), 0.0)
    received = wire.receive(1.0)
    assert [data[0] for _, _, data in received] == list(range(200))
    assert [t for t, _, _ in received] == sorted(t for t, _, _ in received)
    assert len(node.heard) == 200


def test_urgent_time_is_the_arrival_of_the_frame() -> None:
    wire = CanWire()
    assert wire.urgent_s == inf
    wire.transmit(0x081, bytes(8), 0.010, urgent=True)
    assert wire.urgent_s == pytest.approx(0.010 + FULL_S)


def test_urgent_time_is_gone_once_received() -> None:
    wire = CanWire()
    wire.transmit(0x081, bytes(8), 0.010, urgent=True)
    wire.receive(0.005)
    assert wire.urgent_s < inf
    wire.receive(wire.urgent_s)
    assert wire.urgent_s == inf


def test_urgent_time_moves_on_when_the_wire_was_busy() -> None:
    wire = CanWire()
    wire.transmit(0x081, bytes(8), 0.010, urgent=True)
    for _ in range(50):
        wire.send(0x333, bytes(8), 0.0)
    for _ in range(10):  # each look may find the frame later than expected, never earlier
        if any(can_id == 0x081 for _, can_id, _ in wire.receive(wire.urgent_s)):
            break
    else:
        pytest.fail("the urgent frame never came")
    assert wire.urgent_s == inf


def test_ordinary_frames_are_not_urgent() -> None:
    wire = CanWire()
    wire.transmit(0x701, b"\x05", 0.010)
    assert wire.urgent_s == inf


def test_a_watcher_sees_both_directions_with_arrival_times() -> None:
    wire, log = CanWire(), Log()
    wire.watch(log.frame)
    Echo(wire, 0x201, 0x181)
    wire.send(0x201, bytes(8), 0.0)
    assert log.frames == [
        (pytest.approx(FULL_S), 0x201, bytes(8), True),
        (pytest.approx(2 * FULL_S), 0x181, bytes(8), False),
    ]


def test_load_is_the_share_of_the_last_second() -> None:
    wire = CanWire()
    for tick in range(300):
        if tick < 100:
            wire.send(0x201, bytes(8), tick * 0.01)
        wire.receive(tick * 0.01)
        if tick == 99:
            assert wire.load == pytest.approx(100 * FULL_S, rel=0.1)
    assert wire.load == 0.0
    assert wire.occupied_s == pytest.approx(100 * FULL_S)


def test_five_axes_load_a_quarter_of_the_bus_at_100_hz() -> None:
    wire = CanWire()
    for number in range(1, 6):
        Echo(wire, 0x300 + number, 0x380 + number)
    for tick in range(200):
        for number in range(1, 6):
            wire.send(0x200 + number, bytes(6), tick * 0.01)
        wire.send(0x80, b"", tick * 0.01)
        for number in range(1, 6):
            wire.transmit(0x180 + number, bytes(8), tick * 0.01)
        wire.receive(tick * 0.01)
    assert wire.load == pytest.approx(0.26, abs=0.01)


def test_a_disconnected_adapter_is_a_lost_bus() -> None:
    wire = CanWire()
    wire.disconnect()
    with pytest.raises(BusLost):
        wire.send(0x80, b"", 0.0)
    with pytest.raises(BusLost):
        wire.receive(0.0)


def test_frames_sent_while_disconnected_are_lost() -> None:
    wire = CanWire()
    wire.disconnect()
    wire.transmit(0x081, bytes(8), 0.5, urgent=True)
    with pytest.raises(BusLost):
        wire.receive(1.0)
    wire.reconnect()
    assert wire.urgent_s == inf
    assert wire.receive(2.0) == []


def test_a_third_party_reaches_nodes_and_computer() -> None:
    wire = CanWire()
    node = Echo(wire, 0x000, 0x701)
    wire.inject(0x000, b"\x02\x00", 0.0)
    assert len(node.heard) == 1
    assert [can_id for _, can_id, _ in wire.receive(0.1)] == [0x000, 0x701]


class Taker:
    """Keeps the frames it receives; ignores equal data."""

    def __init__(self, wire: CanWire, can_id: int) -> None:
        self.heard: list[tuple[float, bytes]] = []
        wire.listen(can_id, self.on_frame, repeatable=True)

    def on_frame(self, data: bytes, t: float) -> None:
        self.heard.append((t, data))


class Follower(SyncFollower):
    """Counts SYNCs."""

    def __init__(self, wire: CanWire) -> None:
        super().__init__(bytes)
        self.syncs: list[float] = []
        wire.follow(self, 1)

    def on_sync(self, t: float, plainly: bool = False) -> bool:
        self.syncs.append(t)
        return False


SYNC = (0x080, b"")


def send_cycle(wire: CanWire, frames: tuple[tuple[int, bytes], ...], now: float) -> None:
    wire.send_cycle(tuple(can_id for can_id, _ in frames), tuple(data for _, data in frames), now)


def test_only_changed_frames_of_a_cycle_are_handed_on_at_their_own_times() -> None:
    wire, bare = CanWire(), CanWire()
    first, second = Taker(wire, 0x201), Taker(wire, 0x202)
    alone = Taker(bare, 0x202)
    one, other, newer = (0x201, bytes(6)), (0x202, bytes(6)), (0x202, b"\x01" + bytes(5))
    for number, frames in enumerate(((one, other, SYNC), (one, other, SYNC), (one, newer, SYNC))):
        send_cycle(wire, frames, 1.0 + number)
        for can_id, data in frames:
            bare.send(can_id, data, 1.0 + number)
    assert len(first.heard) == 1
    assert [data for _, data in second.heard] == [bytes(6), newer[1]]
    assert [t for t, _ in second.heard] == pytest.approx([alone.heard[0][0], alone.heard[2][0]], abs=1e-12)
    assert wire.occupied_s == pytest.approx(bare.occupied_s)


def test_a_cycle_of_as_many_other_frames_is_taken_frame_by_frame() -> None:
    wire = CanWire()
    taker, follower = Taker(wire, 0x201), Follower(wire)
    send_cycle(wire, ((0x201, bytes(6)), SYNC), 1.0)
    send_cycle(wire, ((0x202, bytes(6)), (0x201, bytes(6))), 2.0)  # no SYNC in it
    assert len(taker.heard) == 2 and len(follower.syncs) == 1


def test_a_forgotten_cycle_is_handed_on_again() -> None:
    wire = CanWire()
    taker, frames = Taker(wire, 0x201), ((0x201, bytes(6)), SYNC)
    send_cycle(wire, frames, 1.0)
    wire.forget_cycle()
    send_cycle(wire, frames, 2.0)
    assert len(taker.heard) == 2


def test_beats_come_in_their_period_until_they_end() -> None:
    wire = CanWire()
    beat = Beat(0x701, b"\x05", 0.05)
    wire.beat(beat, 1.0)
    assert wire.ready_s == 1.0
    wire.unbeat(beat, 1.12)
    assert [t for t, _, _ in wire.receive(2.0)] == [pytest.approx(t + wire_s(1)) for t in (1.0, 1.05, 1.1)]


def wire_s(length: int) -> float:
    return frame_bits(length) / 500_000


def test_more_than_eight_bytes_are_refused() -> None:
    with pytest.raises(ValueError, match="8 bytes"):
        CanWire().send(0x201, bytes(9), 0.0)


def test_a_copy_of_the_wire_has_its_own_listeners_and_queue() -> None:
    wire = CanWire()
    node = Echo(wire, 0x201, 0x181)
    wire.send(0x201, b"", 0.0)
    other_wire, other_node = copy.deepcopy((wire, node))
    other_wire.send(0x201, b"", 0.1)
    assert (len(node.heard), len(other_node.heard)) == (1, 2)
    assert (len(wire.receive(1.0)), len(other_wire.receive(1.0))) == (1, 2)
