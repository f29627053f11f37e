"""Frames of a Modbus RTU line that other devices use: the end of each frame, and its sender.

For a second adapter that only listens. It does not use silences, because USB adapters do not preserve them: a frame
ends where its CRC is right and its length is possible for its function code (Modbus application protocol V1.1b3, 6).
"""

from __future__ import annotations

from drivers.crc16 import crc16

_READS = (1, 2, 3, 4)
_WRITES_ONE = (5, 6)
_WRITES_MANY = (15, 16)
_SHORTEST, _LONGEST = 4, 256


class LineTap:
    """``feed`` takes bytes and returns frames as (bytes, sent by the master). ``garbage`` counts bytes of no frame."""

    def __init__(self) -> None:
        """Begin between two frames."""
        self.garbage = 0
        self._buffer = b""
        self._asked = b""

    def feed(self, data: bytes) -> list[tuple[bytes, bool]]:
        """Process the bytes received; return the frames that are complete."""
        self._buffer += data
        found: list[tuple[bytes, bool]] = []
        while len(self._buffer) >= _SHORTEST:
            frame = self._first()
            if frame is not None:
                found.append((frame, self._from_master(frame)))
                self._buffer = self._buffer[len(frame) :]
            elif len(self._buffer) >= _LONGEST:
                self.garbage += 1
                self._buffer = self._buffer[1:]
            else:
                break
        return found

    def _first(self) -> bytes | None:
        for length in _lengths(self._buffer):
            frame = self._buffer[:length]
            if len(frame) == length and crc16(frame) == 0:
                return frame
        return None

    def _from_master(self, frame: bytes) -> bool:
        """Return whether a frame is a request: it is, unless it can be the answer to the frame before."""
        asked, self._asked = self._asked, b""
        if asked and frame[0] == asked[0] and _answers(asked, frame):
            return False
        self._asked = frame
        return True


def _lengths(buffer: bytes) -> tuple[int, ...]:
    """Return the possible lengths of a frame with the first bytes' function code, requests first."""
    function = buffer[1]
    if function & 0x80:
        return (5,)
    if function in _READS:
        return (8, 5 + buffer[2])
    if function in _WRITES_ONE:
        return (8,)
    if function in _WRITES_MANY:
        return (8, 9 + buffer[6]) if len(buffer) > 6 else ()
    return ()


def _answers(asked: bytes, frame: bytes) -> bool:
    function = asked[1]
    if frame[1] == function | 0x80:
        return True
    if frame[1] != function:
        return False
    if function in _READS:
        count = int.from_bytes(asked[4:6], "big")
        size = 2 * count if function in (3, 4) else (count + 7) // 8
        return len(frame) == 5 + size and frame[2] == size
    return frame[2:6] == asked[2:6] and len(frame) == 8
