"""Answers to a request: over TCP, on a serial line, on a line with echo."""

from __future__ import annotations

import pytest

from drivers.modbus import ModbusLink, Request
from drivers.modbus.answers import AnswerKind, SerialEar, numbered, serial_answer, tcp_answer
from drivers.modbus.codec import Framing, with_crc
from drivers.profiles.model import Timing
from tests.drivers.modbus_bench import reply


class Owner:
    """Receives nothing."""

    def received(self, request: Request, data: bytes, t: float) -> None: ...

    def missed(self) -> None: ...

    def lost(self, t: float) -> None: ...


def read(framing: Framing = "rtu", count: int = 1) -> Request:
    link = ModbusLink(framing)
    return link.read(link.station(1, Timing(0.002, 0.01, 1), Owner()), 3, 0, count)


GOOD = reply(7)
TCP_REPLY = bytes.fromhex("0005 0000 0005 01 03 02 0007".replace(" ", ""))


@pytest.mark.parametrize(("data", "kind"), [
    (GOOD, AnswerKind.GOOD),
    (b"\0" + GOOD, AnswerKind.GOOD),
    (GOOD[:-1], AnswerKind.WAITED_FOR),
    (with_crc(b"\1\x83\2"), AnswerKind.EXCEPTION),
])  # fmt: skip
def test_the_reply_on_a_serial_line_is_looked_for(data: bytes, kind: AnswerKind) -> None:
    request = read()
    found = serial_answer(request, data)
    assert found.kind is kind
    assert request.station.counters.garbage == (data[:1] == b"\0")
    assert found.code == (2 if kind is AnswerKind.EXCEPTION else 0)
    if kind is AnswerKind.GOOD:
        assert found.data == b"\0\7"


def test_over_tcp_a_reply_is_taken_alone_and_whole() -> None:
    request = read("socket")
    sent = numbered(request, 5)
    assert sent[:2] == b"\0\5"
    assert tcp_answer(request, sent, TCP_REPLY).data == b"\0\7"
    assert tcp_answer(request, sent, TCP_REPLY[:9]).kind is AnswerKind.WAITED_FOR
    assert tcp_answer(request, sent, TCP_REPLY + b"\0").why.startswith("1 bytes after the reply on reading")
    assert (request.station.counters.garbage, request.station.counters.late) == (1, 0)
    assert tcp_answer(request, numbered(request, 6), TCP_REPLY).kind is AnswerKind.DOUBTED
    assert (request.station.counters.garbage, request.station.counters.late) == (1, 1)


@pytest.mark.parametrize("hears", [True, False])
def test_an_ear_learns_from_the_first_reply_to_a_read(hears: bool) -> None:
    request, ear = read(), SerialEar()
    ear.stripped = False
    data = request.frame + GOOD if hears else GOOD
    assert ear.answer(request, request.frame, data).data == b"\0\7"
    assert ear.hears_itself is hears


def test_an_exception_shows_it_too() -> None:
    request, ear = read(), SerialEar()
    ear.stripped = False
    assert ear.answer(request, request.frame, with_crc(b"\1\x83\2")).kind is AnswerKind.EXCEPTION
    assert ear.hears_itself is False
