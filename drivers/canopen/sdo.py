"""An SDO client without I/O: expedited and segmented transfers (CiA 301, 7.2.4).

The caller sends the frames that ``upload``, ``download``, ``feed`` and ``expire`` return, and feeds the
replies. One transfer at a time; block transfer is not used by any object of this project.
"""

from __future__ import annotations

import math
import struct

TOGGLE_ERROR = 0x0503_0000
TIMED_OUT = 0x0504_0000
UNKNOWN_COMMAND = 0x0504_0001
OUT_OF_MEMORY = 0x0504_0005
UNSUPPORTED_ACCESS = 0x0601_0000
WRITE_ONLY = 0x0601_0001
READ_ONLY = 0x0601_0002
NO_OBJECT = 0x0602_0000
NOT_MAPPABLE = 0x0604_0041
PDO_TOO_LONG = 0x0604_0042
LENGTH_MISMATCH = 0x0607_0010
NO_SUB_INDEX = 0x0609_0011
VALUE_RANGE = 0x0609_0030
VALUE_TOO_LOW = 0x0609_0032
NOT_STORED = 0x0800_0020
LOCAL_CONTROL = 0x0800_0021
DEVICE_STATE = 0x0800_0022

ABORT_TEXT: dict[int, str] = {
    TOGGLE_ERROR: "toggle bit not alternated",
    TIMED_OUT: "SDO protocol timed out",
    UNKNOWN_COMMAND: "SDO command not valid or unknown",
    0x0504_0002: "block size not valid",
    0x0504_0003: "sequence number not valid",
    0x0504_0004: "CRC error",
    OUT_OF_MEMORY: "out of memory",
    UNSUPPORTED_ACCESS: "access not supported",
    WRITE_ONLY: "object is write only",
    READ_ONLY: "object is read only",
    NO_OBJECT: "object does not exist",
    NOT_MAPPABLE: "object cannot be mapped to the PDO",
    PDO_TOO_LONG: "mapped objects exceed the PDO length",
    0x0604_0043: "parameters incompatible",
    0x0604_0047: "internal incompatibility in the device",
    0x0606_0000: "hardware error",
    LENGTH_MISMATCH: "length of the value does not match the type",
    0x0607_0012: "value too long",
    0x0607_0013: "value too short",
    NO_SUB_INDEX: "sub-index does not exist",
    VALUE_RANGE: "value range exceeded, or refused in this state",
    0x0609_0031: "value too high",
    VALUE_TOO_LOW: "value too low",
    0x0609_0036: "maximum is less than minimum",
    0x060A_0023: "resource not available",
    0x0800_0000: "general error",
    NOT_STORED: "value cannot be stored",
    LOCAL_CONTROL: "value cannot be stored: local control",
    DEVICE_STATE: "refused in the present device state",
    0x0800_0023: "no object dictionary present",
    0x0800_0024: "no data available",
}
"""SDO abort codes (CiA 301, table 22)."""

MAX_LENGTH = 65_536
"""Longest value accepted, bytes: far beyond every text of a drive, and a bound on a faulty server."""

_MUX = struct.Struct("<BHB")
_ABORT = struct.Struct("<BHBI")
_LENGTH = struct.Struct("<I")
_NONE, _UPLOAD, _UPLOADING, _DOWNLOAD, _DOWNLOADING = range(5)


def abort_text(code: int) -> str:
    """Return an abort code with its meaning."""
    return f"abort 0x{code:08X} ({ABORT_TEXT.get(code, 'unknown abort code')})"


def abort_frame(index: int, sub: int, code: int) -> bytes:
    """Return the frame that aborts a transfer; client and server send the same."""
    return _ABORT.pack(0x80, index, sub, code)


class SdoError(Exception):
    """A transfer failed; ``code`` is the abort code sent or received."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


class SdoClient:
    """Transfers values to and from one SDO server.

    ``busy`` while a transfer runs. Afterwards either ``error`` is set, or ``result`` holds the bytes read (empty
    after a download). The server's answer is overdue at the time ``due`` (s). ``ignored`` counts
    replies for another object: late replies of an earlier transfer, which must not count for this one.
    """

    def __init__(self, timeout_s: float = 0.3) -> None:
        self.timeout_s = timeout_s
        self.result = b""
        self.error: SdoError | None = None
        self.due = math.inf
        self.ignored = 0
        self._phase = _NONE
        self._index = 0
        self._sub = 0
        self._toggle = 0
        self._buffer = b""
        self._position = 0
        self._size = -1

    @property
    def busy(self) -> bool:
        """Whether a transfer runs."""
        return self._phase != _NONE

    def upload(self, index: int, sub: int, now: float) -> bytes:
        """Begin to read an object; return the request frame."""
        self._begin(index, sub, now, _UPLOAD)
        return _MUX.pack(0x40, index, sub) + b"\0\0\0\0"

    def download(self, index: int, sub: int, data: bytes, now: float) -> bytes:
        """Begin to write an object; return the request frame. More than four bytes go in segments."""
        self._begin(index, sub, now, _DOWNLOAD)
        self._buffer = data
        self._position = 0
        size = len(data)
        if 1 <= size <= 4:
            self._position = size
            return _MUX.pack(0x23 | (4 - size) << 2, index, sub) + data.ljust(4, b"\0")
        return _MUX.pack(0x21, index, sub) + _LENGTH.pack(size)

    def feed(self, data: bytes, now: float) -> bytes | None:
        """Process one reply that arrived; return the next frame to send, if any."""
        if self._phase == _NONE or len(data) != 8:
            self.ignored += 1
            return None
        if data[0] == 0x80:
            return self._on_abort(data)
        initiating = self._phase in (_UPLOAD, _DOWNLOAD)
        if initiating and (data[1] | data[2] << 8, data[3]) != (self._index, self._sub):
            self.ignored += 1
            return None
        self.due = now + self.timeout_s
        if self._phase == _UPLOAD:
            return self._on_upload(data)
        if self._phase == _UPLOADING:
            return self._on_upload_segment(data)
        if self._phase == _DOWNLOAD:
            return self._on_download(data)
        return self._on_download_segment(data)

    def expire(self, now: float) -> bytes | None:
        """Give up when the answer is overdue; return the abort frame to send then, else None."""
        if self._phase == _NONE or now < self.due:
            return None
        late = f", {self.ignored} reply of another object ignored" if self.ignored else ""
        return self._fail(TIMED_OUT, f"no reply within {self.timeout_s:g} s{late}")

    def _begin(self, index: int, sub: int, now: float, phase: int) -> None:
        if self._phase != _NONE:
            raise ValueError(f"0x{self._index:04X}:{self._sub:02X} is still being transferred")
        self._phase = phase
        self._index = index
        self._sub = sub
        self._toggle = 0
        self._buffer = b""
        self._size = -1
        self.result = b""
        self.error = None
        self.ignored = 0
        self.due = now + self.timeout_s

    def _end(self, result: bytes) -> None:
        self._phase = _NONE
        self.due = math.inf
        self.result = result

    def _fail(self, code: int, text: str) -> bytes:
        self._end(b"")
        self.error = SdoError(code, text)
        return abort_frame(self._index, self._sub, code)

    def _on_abort(self, data: bytes) -> None:
        _, index, sub, code = _ABORT.unpack(data)
        if (index, sub) not in ((self._index, self._sub), (0, 0)):    # some servers leave the address empty
            self.ignored += 1
            return
        self._end(b"")
        self.error = SdoError(code, abort_text(code))

    def _unexpected(self, data: bytes) -> bytes:
        return self._fail(UNKNOWN_COMMAND, f"unexpected reply {data.hex(' ')}")

    def _on_upload(self, data: bytes) -> bytes | None:
        command = data[0]
        if command >> 5 != 2:
            return self._unexpected(data)
        if command & 0x02:                                   # expedited
            size = 4 - (command >> 2 & 0x03) if command & 0x01 else 4
            self._end(data[4:4 + size])
            return None
        if command & 0x01:
            (self._size,) = _LENGTH.unpack_from(data, 4)
            if self._size > MAX_LENGTH:
                return self._fail(OUT_OF_MEMORY, f"{self._size} bytes announced, {MAX_LENGTH} accepted")
        self._phase = _UPLOADING
        return b"\x60\0\0\0\0\0\0\0"

    def _on_upload_segment(self, data: bytes) -> bytes | None:
        command = data[0]
        if command >> 5 != 0:
            return self._unexpected(data)
        if command >> 4 & 1 != self._toggle:
            return self._fail(TOGGLE_ERROR, abort_text(TOGGLE_ERROR))
        self._buffer += data[1:8 - (command >> 1 & 0x07)]
        if len(self._buffer) > (self._size if self._size >= 0 else MAX_LENGTH):
            return self._fail(LENGTH_MISMATCH, f"more than the {self._size} bytes announced"
                              if self._size >= 0 else f"more than {MAX_LENGTH} bytes")
        if command & 0x01:
            if self._size not in (-1, len(self._buffer)):
                return self._fail(LENGTH_MISMATCH, f"{len(self._buffer)} of {self._size} bytes announced")
            self._end(self._buffer)
            return None
        self._toggle ^= 1
        return bytes((0x60 | self._toggle << 4,)) + bytes(7)

    def _on_download(self, data: bytes) -> bytes | None:
        if data[0] != 0x60:
            return self._unexpected(data)
        if self._position and self._position == len(self._buffer):
            self._end(b"")
            return None
        self._phase = _DOWNLOADING
        return self._segment()

    def _on_download_segment(self, data: bytes) -> bytes | None:
        command = data[0]
        if command & 0xEF != 0x20:
            return self._unexpected(data)
        if command >> 4 & 1 != self._toggle:
            return self._fail(TOGGLE_ERROR, abort_text(TOGGLE_ERROR))
        if self._position >= len(self._buffer):
            self._end(b"")
            return None
        self._toggle ^= 1
        return self._segment()

    def _segment(self) -> bytes:
        part = self._buffer[self._position:self._position + 7]
        self._position += len(part)
        last = self._position >= len(self._buffer)
        return bytes((self._toggle << 4 | (7 - len(part)) << 1 | last,)) + part.ljust(7, b"\0")
