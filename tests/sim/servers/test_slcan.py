"""The adapter's half of slcan: commands, frames, refusals."""

from __future__ import annotations

import pytest

from sim.servers.slcan import LONGEST_LINE, SlcanSession


def opened(*before: bytes, bitrate: int = 500_000) -> SlcanSession:
    session = SlcanSession(bitrate)
    for line in (*before, b"S6", b"O"):
        session.feed(line + b"\r")
    session.outgoing.clear()
    return session


def answer(session: SlcanSession, line: bytes) -> bytes:
    session.feed(line + b"\r")
    said = bytes(session.outgoing)
    session.outgoing.clear()
    return said


def test_it_opens_when_it_knows_its_bit_rate() -> None:
    session = SlcanSession(500_000)
    assert answer(session, b"O") == b"\a"
    assert answer(session, b"S6") == b"\r"
    assert answer(session, b"O") == b"\r"
    assert answer(session, b"O") == b"\a", "it is open already"
    assert answer(session, b"S6") == b"\a", "settings are for a closed channel"
    assert answer(session, b"C") == b"\r"
    assert not session.is_open


def test_a_frame_goes_to_the_bus_and_is_confirmed() -> None:
    session = opened()
    assert session.feed(b"t6018400010000000") == []
    assert session.feed(b"0000\rt0000\r") == [(0x601, bytes.fromhex("4000100000000000")), (0, b"")]
    assert session.outgoing == b"z\rz\r"


def test_frames_of_the_bus_come_in_order() -> None:
    session = opened()
    session.relay([(1.0, 0x701, b"\x05"), (1.1, 0x080, b"")])
    assert session.outgoing == b"t701105\rt0800\r"


def test_a_time_stamp_counts_milliseconds_of_a_minute() -> None:
    session = opened(b"Z1")
    session.relay([(61.25, 0x701, b"\x05")])
    assert session.outgoing == b"t70110504E2\r"


def test_a_closed_channel_neither_sends_nor_receives() -> None:
    session = SlcanSession(500_000)
    assert session.feed(b"t0802AABB\r") == []
    session.relay([(1.0, 0x701, b"\x05")])
    assert session.outgoing == b"\a"


def test_one_opened_to_listen_sends_nothing() -> None:
    session = SlcanSession(500_000)
    session.feed(b"S6\rL\r")
    assert session.feed(b"t0802AABB\r") == []
    assert session.refused == 1


def test_at_another_bit_rate_no_node_receives_a_frame() -> None:
    session = opened(bitrate=250_000)
    assert session.feed(b"t0802AABB\r") == []
    session.outgoing.clear()
    session.relay([(1.0, 0x701, b"\x05")])
    assert session.outgoing == b""
    assert answer(session, b"F") == b"F80\r"


def test_a_bit_rate_by_registers_is_the_same() -> None:
    session = SlcanSession(500_000)
    session.feed(b"s001C\rO\r")  # 500 kbit/s of an SJA1000 at 16 MHz
    assert session.is_open
    assert not session.deaf
    session.outgoing.clear()
    assert answer(session, b"F") == b"F00\r"


@pytest.mark.parametrize("line", [b"T000001230", b"r7010", b"R000001230"])
def test_frames_that_the_simulated_bus_does_not_carry_are_counted(line: bytes) -> None:
    session = opened()
    assert session.feed(line + b"\r") == []
    assert session.ignored == 1


@pytest.mark.parametrize("line", [b"t0803AABB", b"t0809", b"tXYZ0", b"t08", b"S9", b"Q", b"O1", b"t080\xff", b"t0801A"])
def test_an_invalid_command_rings_the_bell(line: bytes) -> None:
    session = opened()
    assert session.feed(line + b"\r") == []
    assert (session.outgoing, session.refused) == (b"\a", 1)


def test_a_line_without_an_end_is_dropped() -> None:
    session = opened()
    session.feed(b"t" * (LONGEST_LINE + 1))
    assert session.outgoing == b"\a"
    assert session.feed(b"t0800\r") == [(0x080, b"")]
