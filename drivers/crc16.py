"""CRC of a Modbus RTU frame, two bytes a step."""

from __future__ import annotations

from collections.abc import Callable
from struct import Struct

_POLYNOMIAL = 0xA001
"""x16 + x15 + x2 + 1, bits reflected (Modbus over serial line V1.02, 6.2.2)."""

_LONGEST = 260
"""Bytes of the longest frame we have to do with: 256 on the line, and a few of garbage."""


def _by_byte() -> list[int]:
    """Return what eight steps make of every low byte."""
    table: list[int] = []
    for value in range(256):
        for _ in range(8):
            value = (value >> 1) ^ _POLYNOMIAL if value & 1 else value >> 1
        table.append(value)
    return table


_BYTE = _by_byte()
_WORD = [low ^ high for high in _BYTE for low in ((first >> 8) ^ _BYTE[first & 0xFF] for first in _BYTE)]
"""What sixteen steps make of every 16-bit value: the CRC is linear, so it is the sum of its two bytes' parts."""

_WORDS: tuple[Callable[[bytes], tuple[int, ...]], ...] = tuple(
    Struct(f"<{count}H").unpack_from for count in range(_LONGEST // 2 + 1)
)


def crc16(data: bytes) -> int:
    """Return the CRC of ``data`` (up to 260 bytes).

    On the wire the low byte goes first, and the CRC of a whole frame with its CRC is 0. Raises ValueError when longer.
    """
    length = len(data)
    if length > _LONGEST:
        raise ValueError(f"a Modbus RTU frame has at most 256 bytes, not {length}")
    crc = 0xFFFF
    for word in _WORDS[length >> 1](data):
        crc = _WORD[crc ^ word]
    if length & 1:
        crc = (crc >> 8) ^ _BYTE[(crc ^ data[-1]) & 0xFF]
    return crc


def with_crc(frame: bytes) -> bytes:
    """Return ``frame`` (address, function, data) with its CRC, low byte first."""
    return frame + crc16(frame).to_bytes(2, "little")
