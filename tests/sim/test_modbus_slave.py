"""The simulated slaves' protocol: answers, exceptions, silence; on bytes of the specification."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.crc16 import with_crc
from sim.nodes.modbus_slave import ModbusSlave

ALL = frozenset({3, 4, 6, 16})


class Device(ModbusSlave):
    """Registers 100 to 109 and 200; 108 refuses values above 10."""

    def __init__(self) -> None:
        super().__init__(17, 0.001, [(100, 10), (200, 1)], ALL)
        self.refreshed: list[float] = []
        self.writes: list[tuple[int, int]] = []

    def refresh(self, t: float) -> None:
        self.refreshed.append(t)

    def written(self, address: int, value: int, t: float) -> int:
        self.writes.append((address, value))
        return 3 if address == 108 and value > 10 else 0


def ask(device: ModbusSlave, request: str, t: float = 1.0) -> str | None:
    reply = device.answer(with_crc(bytes.fromhex(request)), t)
    if reply is None:
        return None
    assert with_crc(reply[:-2]) == reply
    return reply[:-2].hex()


def test_registers_are_read_as_in_the_specification() -> None:
    device = Device()
    device.put(100, bytes.fromhex("022B00000064"))
    assert ask(device, "110300640003") == "1103" + "06" + "022b00000064"


def test_input_registers_are_also_read() -> None:
    assert ask(Device(), "1104006C0001") == "1104020000"


def test_one_register_is_written_and_echoed() -> None:
    device = Device()
    assert ask(device, "110600640003") == "110600640003"
    assert device.get(100) == 3


def test_many_registers_are_written_and_counted() -> None:
    device = Device()
    assert ask(device, "1110006400020400 0A0102".replace(" ", "")) == "111000640002"
    assert (device.get(100), device.get(101)) == (10, 258)


@pytest.mark.parametrize(
    ("request_", "reply"),
    [
        ("110100640001", "118101"),  # a function it does not know
        ("1103006D0002", "118302"),  # the second register is not there
        ("110300000001", "118302"),
        ("110300640000", "118303"),  # no register at all
        ("11030064007E", "118303"),  # 126 of them
        ("1106012C0001", "118602"),
        ("1106006C000B", "118603"),  # refused by the device
        ("111000640002020001", "119003"),  # byte count and count differ
        ("1110006D00020400010002", "119002"),
    ],
)
def test_impossible_requests_are_answered_with_an_exception(request_: str, reply: str) -> None:
    assert ask(Device(), request_) == reply


def test_a_refused_write_changes_nothing() -> None:
    device = Device()
    ask(device, "1106006C000B")
    assert device.get(108) == 0


def test_registers_do_not_reach_over_a_gap() -> None:
    assert ask(Device(), "1103006C005D") == "118302"


@pytest.mark.parametrize(
    "frame",
    [
        with_crc(bytes.fromhex("120300640001")),  # another device
        bytes.fromhex("1103006400010000"),  # bad CRC
        with_crc(bytes.fromhex("11030064")),  # broken off
        with_crc(bytes.fromhex("11030064000100")),  # too long
        with_crc(bytes.fromhex("11100064000204000A")),  # data missing
        b"",
        b"\x11",
    ],
)
def test_silence(frame: bytes) -> None:
    assert Device().answer(frame, 1.0) is None


def test_a_device_without_power_is_silent() -> None:
    device = Device()
    device.powered = False
    assert ask(device, "110300640001") is None


def test_a_broadcast_is_executed_in_silence() -> None:
    device = Device()
    assert ask(device, "000600640007") is None
    assert device.get(100) == 7


def test_registers_are_refreshed_at_the_time_of_each_read() -> None:
    device = Device()
    for t in (1.0, 2.0, 3.0):
        ask(device, "110300640001", t)
    assert device.refreshed == [1.0, 2.0, 3.0]


def test_an_unchanged_answer_is_the_same_bytes_object() -> None:
    device = Device()
    frame = with_crc(bytes.fromhex("110300640002"))
    first = device.answer(frame, 1.0)
    assert device.answer(frame, 2.0) is first
    device.put(101, b"\x00\x05")
    assert device.answer(frame, 3.0) == with_crc(bytes.fromhex("1103040000") + b"\x00\x05")


def test_a_write_that_comes_again_is_executed_again() -> None:
    device = Device()
    frames = ["110600640003", "111000650001020009", "1106006C000B"]
    first = [ask(device, frame, 1.0) for frame in frames]
    assert [ask(device, frame, 2.0) for frame in frames] == first == ["110600640003", "111000650001", "118603"]
    assert device.writes == [(100, 3), (101, 9), (108, 11)] * 2


@given(st.binary(max_size=300))
def test_any_bytes_are_answered_or_met_with_silence(frame: bytes) -> None:
    device = Device()
    assert device.answer(frame, 1.0) is None or frame[0] == 17


@given(st.binary(min_size=1, max_size=250))
def test_any_request_with_a_good_crc_gets_a_well_formed_answer_or_silence(body: bytes) -> None:
    device = Device()
    reply = device.answer(with_crc(b"\x11" + body), 1.0)
    assert reply is None or (with_crc(reply[:-2]) == reply and reply[1] & 0x7F == body[0] & 0x7F)
