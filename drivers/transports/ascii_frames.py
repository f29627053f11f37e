"""Modbus ASCII on a serial port: frames of Modbus RTU become text, and text becomes frames.

An ASCII frame is ``:``, two hexadecimal digits for each byte, those of the LRC, and a line end (Modbus over serial line
V1.02, 2.5.2). The link and its records use RTU frames alone: only the port knows the difference.
"""

from __future__ import annotations

from drivers.crc16 import with_crc

_START, _END = b":", b"\n"
_LONGEST = 2 * 255 + 8
"""Characters of the longest frame, with its start and end: more are no frame."""


def lrc(data: bytes) -> int:
    """Return the check of an ASCII frame: the sum of its bytes, negative, in eight bits (6.2.1)."""
    return -sum(data) & 0xFF


def as_ascii(frame: bytes) -> bytes:
    """Return an RTU frame as an ASCII frame."""
    data = frame[:-2]
    return _START + (data + bytes((lrc(data),))).hex().upper().encode("ascii") + b"\r\n"


class AsciiFrames:
    """``feed`` takes characters and returns the complete frames in them as RTU frames.

    A frame whose LRC is wrong becomes one whose CRC is wrong, so that the link counts it.
    """

    def __init__(self) -> None:
        """Begin between two frames."""
        self._text = b""

    def feed(self, data: bytes) -> bytes:
        """Process the characters received; return the frames that they complete."""
        self._text += data
        found = b""
        while (end := self._text.find(_END)) >= 0:
            line, self._text = self._text[:end], self._text[end + 1 :]
            found += _frame(line.rpartition(_START)[2].strip())
        self._text = self._text[-_LONGEST:]
        return found


def _frame(text: bytes) -> bytes:
    """Return the RTU frame for a line's characters between start and end; nothing where these are no bytes."""
    try:
        data = bytes.fromhex(text.decode("ascii"))
    except ValueError:
        return b""
    if len(data) < 3:
        return b""
    frame = with_crc(data[:-1])
    return frame if lrc(data[:-1]) == data[-1] else frame[:-1] + bytes((frame[-1] ^ 0xFF,))
