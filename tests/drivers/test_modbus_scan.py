"""Registers read one request at a time, byte by byte."""

from __future__ import annotations

import pytest

from drivers.crc16 import with_crc
from drivers.modbus.register_scan import LineScan, RegisterQuestion
from drivers.ports import WatchedLine


class Line(WatchedLine):
    """A line whose answers a test writes."""

    def __init__(self) -> None:
        super().__init__()
        self.sent: list[bytes] = []

    def write(self, data: bytes, now: float) -> None:
        self.sent.append(data)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        return []


QUESTION = RegisterQuestion(unit_id=1, function=3, address=100, count=1)
REQUEST = with_crc(bytes.fromhex("01 03 00 64 00 01"))
GOOD = with_crc(bytes.fromhex("01 03 02 46 58"))


def asked() -> tuple[Line, LineScan]:
    line, scan = Line(), LineScan("rtu", 9600, "N")
    scan.ask(QUESTION, 0.1)
    scan.service(line, 0.0)
    return line, scan


def test_a_question_is_a_read_and_nothing_else() -> None:
    line, _ = asked()
    assert line.sent == [REQUEST]


def test_an_answer_brings_its_registers_and_how_long_the_device_took() -> None:
    _, scan = asked()
    wire_s = (8 + 7 + 3.5) * 10 / 9600  # request, answer, and the silence that ends the request
    scan.feed([(wire_s + 0.017, GOOD)], 0.05)
    assert scan.answer is not None
    assert scan.answer.data == b"\x46\x58"
    assert scan.answer.delay_s == pytest.approx(0.017, abs=1e-9)


def test_an_answer_in_two_pieces_is_one() -> None:
    _, scan = asked()
    scan.feed([(0.02, GOOD[:3])], 0.02)
    assert scan.answer is None
    scan.feed([(0.03, GOOD[3:])], 0.03)
    assert scan.answer is not None
    assert scan.answer.ok


def test_an_exception_is_a_device_that_is_there() -> None:
    _, scan = asked()
    scan.feed([(0.02, with_crc(bytes.fromhex("01 83 02")))], 0.02)
    assert scan.answer is not None
    assert (scan.answer.ok, scan.answer.there, scan.answer.exception) == (False, True, 2)


def test_silence_ends_a_question() -> None:
    line, scan = asked()
    scan.service(line, 0.05)
    assert scan.answer is None
    scan.service(line, 0.2)
    assert scan.answer is not None
    assert not scan.answer.there
    assert scan.answer.describe() == "nothing"


@pytest.mark.parametrize(
    "data",
    [
        GOOD[:-1] + bytes((GOOD[-1] ^ 1,)),
        with_crc(bytes.fromhex("02 03 02 46 58")),
        with_crc(bytes.fromhex("01 03 04 46 58 00 00")),
    ],
    ids=["a wrong CRC", "another unit", "another length"],
)
def test_bytes_that_are_no_answer_are_noise(data: bytes) -> None:
    line, scan = asked()
    scan.feed([(0.02, data)], 0.02)
    scan.service(line, 0.2)
    assert scan.answer is not None
    assert (scan.answer.there, scan.answer.noise) == (False, data)


def test_an_answer_to_an_earlier_question_is_not_taken_for_this_ones() -> None:
    line, scan = asked()
    scan.service(line, 0.2)
    scan.ask(RegisterQuestion(1, 3, 200, 1), 0.1)
    scan.feed([(0.2, GOOD)], 0.2)  # late: it arrives before the next request is sent
    scan.service(line, 0.2)
    assert scan.answer is None
    assert len(line.sent) == 1
    scan.service(line, 0.206)
    assert len(line.sent) == 2


def test_over_tcp_the_transaction_number_identifies_the_answer() -> None:
    line, scan = Line(), LineScan("socket", 9600, "N")
    scan.ask(QUESTION, 0.1)
    scan.service(line, 0.0)
    assert line.sent == [bytes.fromhex("00 01 00 00 00 06 01 03 00 64 00 01")]
    scan.feed([(0.01, bytes.fromhex("00 07 00 00 00 05 01 03 02 11 11"))], 0.01)
    assert scan.answer is None
    scan.feed([(0.02, bytes.fromhex("00 01 00 00 00 05 01 03 02 46 58"))], 0.02)
    assert scan.answer is not None
    assert scan.answer.data == b"\x46\x58"


@pytest.mark.parametrize("size", range(1, 9))
def test_the_echo_of_an_adapter_is_removed_in_any_pieces(size: int) -> None:
    _, scan = asked()
    echo_and_answer = REQUEST + GOOD
    for at in range(0, len(echo_and_answer), size):
        scan.feed([(0.02, echo_and_answer[at : at + size])], 0.02)
    assert scan.hears_itself
    assert scan.answer is not None and scan.answer.data == b"\x46\x58"


def test_an_echo_alone_is_no_answer() -> None:
    line, scan = asked()
    scan.feed([(0.02, REQUEST)], 0.02)
    scan.service(line, 1.0)
    assert scan.answer is not None and not scan.answer.there and scan.answer.noise == b""
