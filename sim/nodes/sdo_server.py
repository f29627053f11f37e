"""The SDO server of a simulated device (CiA 301, 7.2.4): expedited and segmented transfers, toggle, abort codes.

Sans-IO: a request of eight bytes in, a reply of eight bytes out. Block transfer is answered as an unknown command,
as by devices without it.
"""

from __future__ import annotations

from drivers.canopen import sdo
from sim.nodes.object_store import ObjectStore, SdoAbortError

MAX_OBJECT_BYTES = 256
"""Largest object that a client may write, bytes: no object of a servo drive is longer."""

_IDLE, _UPLOAD, _DOWNLOAD = 0, 1, 2


class SdoServer:
    """One SDO channel; it keeps the state of a segmented transfer between requests."""

    def __init__(self, objects: ObjectStore) -> None:
        """Serve ``objects``."""
        self._objects = objects
        self._mode = _IDLE
        self._index = 0
        self._sub = 0
        self._toggle = 0
        self._size: int | None = None
        self._buffer = b""

    def reset(self) -> None:
        """Forget a transfer in progress."""
        self._mode = _IDLE
        self._buffer = b""

    def request(self, data: bytes) -> bytes | None:
        """Return the reply to a request; None when it needs no answer (an abort, not eight bytes)."""
        if len(data) != 8:
            return None
        command = data[0] >> 5
        try:
            if command == 1:
                return self._start_download(data)
            if command == 2:
                return self._start_upload(data)
            if command == 0 and self._mode == _DOWNLOAD:
                return self._download_segment(data)
            if command == 3 and self._mode == _UPLOAD:
                return self._upload_segment(data)
            if command == 4:
                self.reset()
                return None
            if command in (5, 6):
                self._address(data)
            elif self._mode == _IDLE:
                # A segment outside a transfer contains no address.
                self._index = self._sub = 0
            raise SdoAbortError(sdo.UNKNOWN_COMMAND)
        except SdoAbortError as refusal:
            self.reset()
            return self._head(0x80) + refusal.code.to_bytes(4, "little")

    def _address(self, data: bytes) -> None:
        self._index = data[1] | data[2] << 8
        self._sub = data[3]

    def _head(self, command: int) -> bytes:
        return bytes((command, self._index & 0xFF, self._index >> 8, self._sub))

    def _start_upload(self, data: bytes) -> bytes:
        self.reset()
        self._address(data)
        value = self._objects.upload(self._index, self._sub)
        size = len(value)
        if 1 <= size <= 4:
            return self._head(0x43 | (4 - size) << 2) + value.ljust(4, b"\0")
        return self._begin_segments(value)

    def _begin_segments(self, value: bytes) -> bytes:
        self._mode = _UPLOAD
        self._buffer = value
        self._toggle = 0
        return self._head(0x41) + len(value).to_bytes(4, "little")

    def _upload_segment(self, data: bytes) -> bytes:
        self._check_toggle(data[0])
        chunk, self._buffer = self._buffer[:7], self._buffer[7:]
        last = not self._buffer
        reply = bytes((self._toggle << 4 | (7 - len(chunk)) << 1 | last,)) + chunk.ljust(7, b"\0")
        self._toggle ^= 1
        if last:
            self._mode = _IDLE
        return reply

    def _start_download(self, data: bytes) -> bytes:
        self.reset()
        self._address(data)
        command = data[0]
        expedited, sized = bool(command & 0x02), bool(command & 0x01)
        if expedited:
            size = 4 - (command >> 2 & 3) if sized else 4
            self._objects.download(self._index, self._sub, data[4 : 4 + size], sized)
            return self._head(0x60) + bytes(4)
        self._objects.check_writable(self._index, self._sub)
        self._size = int.from_bytes(data[4:8], "little") if sized else None
        if self._size is not None and self._size > MAX_OBJECT_BYTES:
            raise SdoAbortError(sdo.OUT_OF_MEMORY)
        self._mode = _DOWNLOAD
        self._toggle = 0
        return self._head(0x60) + bytes(4)

    def _download_segment(self, data: bytes) -> bytes:
        self._check_toggle(data[0])
        self._buffer += data[1 : 8 - (data[0] >> 1 & 7)]
        if len(self._buffer) > (MAX_OBJECT_BYTES if self._size is None else self._size):
            raise SdoAbortError(sdo.LENGTH_MISMATCH if self._size is not None else sdo.OUT_OF_MEMORY)
        reply = bytes((0x20 | self._toggle << 4,)) + bytes(7)
        self._toggle ^= 1
        if data[0] & 0x01:
            if self._size is not None and len(self._buffer) != self._size:
                raise SdoAbortError(sdo.LENGTH_MISMATCH)
            self._objects.download(self._index, self._sub, self._buffer, True)
            self.reset()
        return reply

    def _check_toggle(self, command: int) -> None:
        if command >> 4 & 1 != self._toggle:
            raise SdoAbortError(sdo.TOGGLE_ERROR)
