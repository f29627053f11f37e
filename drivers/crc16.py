"""CRC of a Modbus RTU frame: the one door to ``fastcrc`` (docs/decisions/0015)."""

from __future__ import annotations

from fastcrc.crc16 import modbus

crc16 = modbus
"""Return the CRC of bytes; on the wire its low byte goes first, and the CRC of a whole frame with its CRC is 0."""


def with_crc(frame: bytes) -> bytes:
    """Return ``frame`` (address, function, data) with its CRC, low byte first."""
    return frame + modbus(frame).to_bytes(2, "little")
