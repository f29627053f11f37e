"""Frames against the examples of the Modbus specifications."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymodbus.framer import FramerRTU
from pymodbus.pdu import DecodePDU

from drivers.crc16 import with_crc
from drivers.modbus import codec
from drivers.modbus.codec import DecodedAnswer
from tests.drivers.modbus_bench import Bench, reply


def test_read_request_is_the_specifications_bytes() -> None:
    # Application protocol V1.1b3, 6.3: registers 108 to 110.
    assert codec.read_request("rtu", 0x11, 3, 0x6B, 3) == with_crc(bytes.fromhex("1103006B0003"))


def test_read_request_of_input_registers_has_function_4() -> None:
    assert codec.read_request("rtu", 0x11, 4, 8, 1) == with_crc(bytes.fromhex("110400080001"))


def test_write_of_one_register_is_the_specifications_bytes() -> None:
    assert codec.write_request("rtu", 0x11, 6, 1, (3,)) == with_crc(bytes.fromhex("110600010003"))


def test_write_of_many_registers_is_the_specifications_bytes() -> None:
    frame = codec.write_request("rtu", 0x11, 16, 1, (10, 0x0102))
    assert frame == with_crc(bytes.fromhex("1110000100020 4000A0102".replace(" ", "")))


def test_tcp_request_has_an_mbap_header() -> None:
    frame = codec.read_request("socket", 0x11, 3, 0x6B, 3)
    assert frame == bytes.fromhex("0000 0000 0006 11 03006B0003".replace(" ", ""))


@pytest.mark.parametrize(
    ("framing", "function", "count", "length"),
    [("rtu", 3, 9, 23), ("rtu", 6, 1, 8), ("rtu", 16, 4, 8), ("socket", 3, 9, 27)],
)
def test_reply_length(framing: codec.Framing, function: int, count: int, length: int) -> None:
    assert codec.reply_length(framing, function, count) == length


@pytest.mark.parametrize(
    ("function", "values"), [(3, (1,)), (6, (1, 2)), (6, (0x10000,)), (16, (-1,)), (16, ())]
)
def test_writes_that_cannot_be_are_refused(function: int, values: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"write|holds|count"):
        codec.write_request("rtu", 1, function, 0, values)


@pytest.mark.parametrize(("function", "count"), [(6, 1), (3, 0), (3, 126)])
def test_reads_that_cannot_be_are_refused(function: int, count: int) -> None:
    with pytest.raises(ValueError, match=r"read|count"):
        codec.read_request("rtu", 1, function, 0, count)


def test_a_frame_is_found_behind_noise() -> None:
    frame = with_crc(bytes.fromhex("0103020001"))
    used, unit_id, _, pdu = codec.next_frame("rtu", b"\x00\x00" + frame)
    assert (used, unit_id, pdu) == (len(frame) + 2, 1, bytes.fromhex("03020001"))


def test_bytes_behind_a_frame_are_left() -> None:
    frame = with_crc(bytes.fromhex("0103020001"))
    used, *_ = codec.next_frame("rtu", frame + b"\x01\x03")
    assert used == len(frame)


def test_an_incomplete_frame_uses_nothing_up() -> None:
    frame = with_crc(bytes.fromhex("0103020001"))
    assert all(codec.next_frame("rtu", frame[:length])[0] == 0 for length in range(len(frame)))


def test_a_frame_with_a_bad_crc_has_no_pdu() -> None:
    used, _, _, pdu = codec.next_frame("rtu", bytes.fromhex("01030200010000"))
    assert used == 7
    assert pdu == b""


@pytest.mark.parametrize(
    ("pdu", "answer"),
    [
        ("03020001", DecodedAnswer.GOOD),
        ("8302", DecodedAnswer.EXCEPTION),
        ("0304000100020", DecodedAnswer.OTHER),
        ("04020001", DecodedAnswer.OTHER),
        ("8402", DecodedAnswer.OTHER),
        ("0302", DecodedAnswer.OTHER),
    ],
)
def test_replies_to_a_read_of_one_register_are_distinguished(pdu: str, answer: DecodedAnswer) -> None:
    assert codec.classify(bytes.fromhex(pdu[: len(pdu) & ~1]), 3, 0, (), 1) is answer


@pytest.mark.parametrize(
    ("pdu", "answer"),
    [("0600010003", DecodedAnswer.GOOD), ("0600020003", DecodedAnswer.OTHER), ("0600010004", DecodedAnswer.OTHER)],
)
def test_a_write_is_confirmed_by_its_echo_only(pdu: str, answer: DecodedAnswer) -> None:
    assert codec.classify(bytes.fromhex(pdu), 6, 1, (3,), 1) is answer


@pytest.mark.parametrize(("pdu", "answer"), [("1000010002", DecodedAnswer.GOOD), ("1000010001", DecodedAnswer.OTHER)])
def test_a_write_of_many_is_confirmed_by_address_and_count(pdu: str, answer: DecodedAnswer) -> None:
    assert codec.classify(bytes.fromhex(pdu), 16, 1, (10, 258), 2) is answer


def test_every_code_we_act_on_has_a_text() -> None:
    assert {1, 2, 3, 4, 6, 10, 11} <= codec.EXCEPTION_TEXTS.keys()
    assert codec.exception_code(bytes.fromhex("8302")) == 2


@given(st.lists(st.integers(min_value=0, max_value=0xFFFF), min_size=1, max_size=125))
def test_the_links_fast_decoder_agrees_with_pymodbus(registers: list[int]) -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, len(registers), 0.0))
    bench.serve(0.0)
    frame = reply(*registers)
    bench.serve(0.05, (0.001, frame))
    _, decoded = FramerRTU(DecodePDU(False)).handleFrame(frame, 1, 0)
    assert decoded is not None
    assert bench.notes.replies[0][1] == b"".join(value.to_bytes(2, "big") for value in decoded.registers)
