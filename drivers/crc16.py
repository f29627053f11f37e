"""CRC of a Modbus RTU frame: the only module that uses ``fastcrc`` (docs/decisions/0015)."""

from __future__ import annotations

from fastcrc.crc16 import modbus

crc16 = modbus
"""Return the CRC of bytes; its low byte is sent first. The CRC of a frame together with its CRC is 0."""


def with_crc(frame: bytes) -> bytes:
    """Return ``frame`` (address, function, data) with its CRC, low byte first."""
    return frame + modbus(frame).to_bytes(2, "little")
