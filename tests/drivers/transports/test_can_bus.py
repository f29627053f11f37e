"""The python-can edge on python-can's own virtual bus, and on buses that fail."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from threading import Event

import can
import pytest

from drivers.canopen.master import CanMaster
from drivers.ports import BusLost, CanFrame, TellingCanPort
from drivers.transports.can_bus import PythonCanPort, open_can
from drivers.transports.own_frames import PROBE_ID

TRIES = 400
_channels = itertools.count()


def collect(port: PythonCanPort, count: int, now: float = 100.0) -> list[CanFrame]:
    """Return ``count`` frames, waiting two seconds at most for the receive thread."""
    frames: list[CanFrame] = []
    pause = Event()
    for _ in range(TRIES):
        frames += port.receive(now)
        if len(frames) >= count:
            break
        pause.wait(0.005)
    return frames


def until_lost(port: PythonCanPort) -> str:
    pause = Event()
    for _ in range(TRIES):
        try:
            port.receive(0.0)
        except BusLost as error:
            return str(error)
        pause.wait(0.005)
    raise AssertionError("the bus was not lost within two seconds")


def after_the_probe(peer: can.BusABC) -> None:
    """Take the first frame of a port off the bus."""
    probe = peer.recv(2.0)
    assert probe is not None
    assert probe.arbitration_id == PROBE_ID


@pytest.fixture
def channel() -> str:
    return f"edge-{next(_channels)}"


@pytest.fixture
def peer(channel: str) -> Iterator[can.BusABC]:
    with can.Bus(interface="virtual", channel=channel) as bus:
        yield bus


@pytest.fixture
def port(channel: str, peer: can.BusABC) -> Iterator[PythonCanPort]:
    opened = open_can("virtual", channel, 500_000)
    yield opened
    opened.close()


class StubBus(can.BusABC):
    """A bus whose frames and failures come from a list; silent once it is used up."""

    def __init__(self, script: list[object]) -> None:
        self.script = script
        self.fail_send: Exception | None = None
        super().__init__(channel="stub")

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if not self.script:
            Event().wait(timeout)
            return None, True
        item = self.script.pop(0)
        if isinstance(item, Exception):
            raise item
        assert isinstance(item, can.Message)
        return item, True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.fail_send is not None:
            raise self.fail_send


def test_a_frame_sent_arrives_on_the_bus(port: PythonCanPort, peer: can.BusABC) -> None:
    port.send(0x205, bytes.fromhex("0F00 E8030000"), now=0.0)
    after_the_probe(peer)
    message = peer.recv(2.0)
    assert message is not None
    assert (message.arbitration_id, bytes(message.data), message.is_extended_id) == (
        0x205, bytes.fromhex("0F00 E8030000"), False)


def test_a_sync_frame_has_no_data(port: PythonCanPort, peer: can.BusABC) -> None:
    port.send(0x080, b"", now=0.0)
    after_the_probe(peer)
    message = peer.recv(2.0)
    assert message is not None
    assert message.dlc == 0


def test_frames_are_received_in_order(port: PythonCanPort, peer: can.BusABC) -> None:
    for number in range(20):
        peer.send(can.Message(arbitration_id=0x181, data=bytes([number]), is_extended_id=False))
    assert collect(port, 20) == [(100.0, 0x181, bytes([number])) for number in range(20)]


def test_our_own_frames_are_not_received(port: PythonCanPort, peer: can.BusABC) -> None:
    port.send(0x205, b"\x01", now=0.0)
    peer.send(can.Message(arbitration_id=0x185, data=b"\x02", is_extended_id=False))
    assert collect(port, 1) == [(100.0, 0x185, b"\x02")]


def test_with_a_clock_frames_are_stamped_when_they_arrive(channel: str, peer: can.BusABC) -> None:
    times = iter((1.5, 2.5))
    port = open_can("virtual", channel, 500_000, clock=lambda: next(times))
    for data in (b"\x01", b"\x02"):
        peer.send(can.Message(arbitration_id=0x181, data=data, is_extended_id=False))
    assert collect(port, 1, now=2.0) == [(1.5, 0x181, b"\x01")]
    assert collect(port, 1, now=3.0) == [(2.5, 0x181, b"\x02")]
    port.close()


def test_frames_that_are_none_of_ours_are_counted() -> None:
    port = PythonCanPort(StubBus([
        can.Message(arbitration_id=0x181, is_extended_id=True),
        can.Message(arbitration_id=0x181, is_extended_id=False, is_remote_frame=True),
        can.Message(arbitration_id=0x185, is_extended_id=False)]))
    assert collect(port, 1) == [(100.0, 0x185, b"")]
    assert port.ignored == 2
    assert port.errors == {}
    port.close()


@pytest.mark.parametrize(("name", "counted"), [
    ("socketcan can0", {"no acknowledgement": 2, "controller": 1, "bus error": 1, "error": 1}),
    ("pcan PCAN_USBBUS1", {"error": 4}),
])
def test_error_frames_are_counted_by_type(name: str, counted: dict[str, int]) -> None:
    frames = [can.Message(arbitration_id=bits, is_error_frame=True) for bits in (0x020, 0x024, 0x080, 0x400)]
    port = PythonCanPort(StubBus([*frames, can.Message(arbitration_id=0x185, is_extended_id=False)]), name=name)
    assert collect(port, 1) == [(100.0, 0x185, b"")]
    assert port.errors == counted
    assert port.ignored == 0
    port.close()


class StatefulBus(StubBus):
    """A bus whose interface reports a state."""

    @property
    def state(self) -> can.BusState:
        if self.fail_send is not None:
            raise self.fail_send
        return can.BusState.PASSIVE


def test_a_state_is_reported_where_the_interface_reports_one() -> None:
    port, other = PythonCanPort(StatefulBus([])), PythonCanPort(StubBus([]))
    assert isinstance(port, TellingCanPort)
    assert (port.state, other.state) == ("passive", "")
    port._bus.fail_send = can.CanOperationError("gone")
    assert port.state == ""
    port.close()
    other.close()


@pytest.mark.parametrize("error", [can.CanOperationError("read error"), OSError(19, "No such device"),
                                   ValueError("garbage from the adapter")])
def test_any_receive_error_is_a_lost_bus(error: Exception) -> None:
    port = PythonCanPort(StubBus([error]))
    assert "receiving failed" in until_lost(port)
    port.close()


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_an_error_that_no_adapter_announces_is_also_a_lost_bus() -> None:
    port = PythonCanPort(StubBus([KeyError("bug in a driver")]))
    assert "the receive thread failed" in until_lost(port)
    port.close()


def test_bus_off_is_a_lost_bus() -> None:
    port = PythonCanPort(StubBus([can.Message(arbitration_id=0x40, is_error_frame=True)]))
    assert until_lost(port) == "CAN bus lost: bus-off"
    port.close()


def test_an_adapter_that_is_gone_is_closed_without_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    bus = StubBus([])
    port = PythonCanPort(bus)

    def gone() -> None:
        raise can.CanOperationError("Could not write to serial device")

    with monkeypatch.context() as patched:
        patched.setattr(bus, "shutdown", gone)
        port.close()
    with pytest.raises(BusLost, match="closed"):
        port.receive(0.0)
    bus.shutdown()


def test_frames_before_the_loss_are_still_delivered() -> None:
    port = PythonCanPort(StubBus([can.Message(arbitration_id=0x185, is_extended_id=False), OSError("gone")]))
    assert collect(port, 1) == [(100.0, 0x185, b"")]
    until_lost(port)
    port.close()


@pytest.mark.parametrize("error", [can.CanOperationError("transmit buffer full"), OSError(105, "No buffer space")])
def test_a_failed_send_is_a_lost_bus_for_good(error: Exception) -> None:
    bus = StubBus([])
    port = PythonCanPort(bus)
    bus.fail_send = error
    with pytest.raises(BusLost, match="sending failed"):
        port.send(0x205, b"", now=0.0)
    bus.fail_send = None
    with pytest.raises(BusLost, match="sending failed"):
        port.send(0x205, b"", now=0.01)
    port.close()


def test_a_closed_port_is_lost(channel: str) -> None:
    port = open_can("virtual", channel, 500_000)
    port.close()
    with pytest.raises(BusLost, match="closed"):
        port.send(0x205, b"", now=0.0)


def test_an_adapter_that_does_not_open_is_a_lost_bus() -> None:
    with pytest.raises(BusLost, match="cannot open no-such-interface"):
        open_can("no-such-interface", "x", 500_000)


@pytest.mark.parametrize(
    ("frames", "calls"),
    [
        ([(0x080, ""), (0x701, "05"), (0x581, "60000000")], 0),
        ([(0x081, "3081200000000000")], 1),
        ([(0x701, "00")], 1),
        ([(0x283, "00000100"), (0x283, "00000100"), (0x283, "00000300")], 2),
        ([(0x181, "2706000000000000"), (0x181, "0F02000000000000"), (0x182, "2702000000000000")], 3),
        ([(0x181, "2706000000000000"), (0x181, "2706FF0000000000"), (0x181, "A716000000000000")], 1),
    ],
    ids=["SYNC, heartbeat, SDO", "emergency", "boot-up", "changed inputs", "states", "speed, warning, target reached"],
)
def test_urgent_frames_are_reported_at_once(frames: list[tuple[int, str]], calls: int) -> None:
    told: list[int] = []
    script: list[object] = [
        can.Message(arbitration_id=can_id, data=bytes.fromhex(data), is_extended_id=False) for can_id, data in frames
    ]
    port = PythonCanPort(StubBus(script), on_urgent=lambda: told.append(1))
    assert len(collect(port, len(frames))) == len(frames)
    port.close()
    assert len(told) == calls + 1  # the end of reception is reported last


def test_frames_of_other_programs_of_this_computer_are_received() -> None:
    # As python-can gives them on SocketCAN: hardbyte/python-can#1274.
    local = can.Message(arbitration_id=0x000, data=b"\x81\x01", is_extended_id=False, is_rx=False)
    port = PythonCanPort(StubBus([local]))
    assert collect(port, 1) == [(100.0, 0x000, b"\x81\x01")]
    assert (port.local, port.ignored) == (1, 0)
    port.close()


def test_another_program_of_this_computer_is_a_second_master() -> None:
    port = PythonCanPort(StubBus([can.Message(arbitration_id=0, data=b"\x81\x01", is_extended_id=False, is_rx=False)]))
    master = CanMaster()
    master.feed(collect(port, 1), 100.0)
    assert master.foreign_frame == "NMT 000#8101"
    port.close()


def echoing(channel: str) -> PythonCanPort:
    return PythonCanPort(can.Bus(interface="virtual", channel=channel, receive_own_messages=True), name="virtual 0")


def test_an_interface_that_gives_our_frames_back_is_recognised_and_they_are_taken_off(
    channel: str, peer: can.BusABC
) -> None:
    port = echoing(channel)
    for number in range(5):
        port.send(0x080, bytes((number,)), now=0.0)
    peer.send(can.Message(arbitration_id=0x185, data=b"\x02", is_extended_id=False))
    assert collect(port, 1, now=0.01) == [(0.01, 0x185, b"\x02")]
    assert port.own.echoes is True
    assert (port.own.returned, port.own.unreturned) == (6, 0)
    port.close()


def test_a_second_master_is_detected_behind_an_interface_that_echoes_ours(channel: str, peer: can.BusABC) -> None:
    port = echoing(channel)
    port.send(0x080, b"", now=0.0)
    peer.send(can.Message(arbitration_id=0x080, is_extended_id=False))
    assert collect(port, 1, now=0.01) == [(0.01, 0x080, b"")]
    port.close()
