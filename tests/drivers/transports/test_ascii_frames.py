"""Modbus ASCII: the text of a frame, and frames out of text that arrives in any pieces."""

from __future__ import annotations

import pytest

from drivers.crc16 import crc16, with_crc
from drivers.modbus import ModbusLink
from drivers.ports import byte_bits
from drivers.transports.ascii_frames import AsciiFrames, as_ascii
from tests.drivers.modbus_bench import Bench, Notes, reply

READ = with_crc(bytes.fromhex("010300640002"))


def test_a_request_is_its_bytes_as_digits_with_their_lrc() -> None:
    assert as_ascii(READ) == b":01030064000296\r\n"


@pytest.mark.parametrize("size", [1, 2, 5, 100])
def test_frames_come_back_from_pieces_of_any_size(size: int) -> None:
    frames, text = AsciiFrames(), b"\x00" + as_ascii(READ) + as_ascii(reply(0x1234, 0x0D0A))
    found = b"".join(frames.feed(text[at : at + size]) for at in range(0, len(text), size))
    assert found == READ + reply(0x1234, 0x0D0A)


def test_a_start_within_a_frame_begins_anew() -> None:
    assert AsciiFrames().feed(b":0103006" + as_ascii(READ)) == READ


def test_a_wrong_check_becomes_a_wrong_crc() -> None:
    spoilt = AsciiFrames().feed(as_ascii(READ).replace(b"64", b"65"))
    assert len(spoilt) == len(READ) and crc16(spoilt) != 0


@pytest.mark.parametrize("text", [b":\r\n", b":01\r\n", b":0103ZZ\r\n", b"\xff\xfe\r\n", b":" + 2000 * b"0" + b"\r"])
def test_text_that_is_no_frame_is_nothing(text: bytes) -> None:
    assert AsciiFrames().feed(text) == b""


@pytest.mark.parametrize(
    ("framing", "parity", "stop_bits", "bits"),
    [("rtu", "N", 1, 10), ("rtu", "E", 1, 11), ("rtu", "N", 2, 11), ("rtu", "O", 2, 12), ("ascii", "E", 1, 20)],
)
def test_a_byte_takes_its_bits(framing: str, parity: str, stop_bits: int, bits: int) -> None:
    assert byte_bits(framing, parity, stop_bits) == bits  # type: ignore[arg-type]


def test_a_link_waits_longer_for_ascii_and_speaks_rtu_to_its_port() -> None:
    bench = Bench()
    links = [ModbusLink("rtu", 9600), ModbusLink("ascii", 9600)]
    requests = [link.read(link.station(1, bench.station(2 + n).timing, Notes()), 3, 100, 2) for n, link in
                enumerate(links)]  # fmt: skip
    assert requests[0].frame == requests[1].frame == READ
    assert 1.9 < requests[1].wire_s / requests[0].wire_s < 2.1
