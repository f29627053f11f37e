"""The CRC of Modbus RTU frames."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from pymodbus.framer import FramerRTU

from drivers.crc16 import crc16, with_crc


def test_matches_the_example_of_the_serial_line_specification() -> None:
    # Modbus over serial line V1.02, 6.2.2: 02 07 is followed by 41 12.
    assert with_crc(bytes.fromhex("0207")) == bytes.fromhex("02074112")


@given(st.binary(max_size=256))
def test_agrees_with_pymodbus_on_any_frame(frame: bytes) -> None:
    assert crc16(frame).to_bytes(2, "little") == FramerRTU.compute_CRC(frame).to_bytes(2, "big")


@given(st.binary(max_size=254))
def test_a_frame_with_its_crc_has_crc_zero(frame: bytes) -> None:
    assert crc16(with_crc(frame)) == 0


@given(st.binary(min_size=1, max_size=64), st.integers(min_value=0))
def test_any_single_wrong_bit_is_found(frame: bytes, place: int) -> None:
    whole = bytearray(with_crc(frame))
    bit = place % (8 * len(whole))
    whole[bit // 8] ^= 1 << bit % 8
    assert crc16(bytes(whole)) != 0
