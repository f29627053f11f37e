"""Frames of Modbus requests and replies. The only module that knows pymodbus.

pymodbus's framers and PDU classes are used without its clients: they neither keep time nor own a connection here.
Minor releases change these classes, so the version is pinned and every class used is tested.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from enum import Enum
from typing import Literal

from pymodbus.framer import FramerRTU, FramerSocket
from pymodbus.pdu import DecodePDU, ExceptionResponse, ModbusPDU
from pymodbus.pdu.bit_message import (
    ReadCoilsRequest,
    ReadCoilsResponse,
    ReadDiscreteInputsRequest,
    ReadDiscreteInputsResponse,
    WriteMultipleCoilsRequest,
    WriteMultipleCoilsResponse,
    WriteSingleCoilRequest,
    WriteSingleCoilResponse,
)
from pymodbus.pdu.register_message import (
    ReadHoldingRegistersRequest,
    ReadHoldingRegistersResponse,
    ReadInputRegistersRequest,
    ReadInputRegistersResponse,
    WriteMultipleRegistersRequest,
    WriteMultipleRegistersResponse,
    WriteSingleRegisterRequest,
    WriteSingleRegisterResponse,
)

from drivers.crc16 import with_crc

Framing = Literal["rtu", "socket"]
"""Modbus RTU (serial line) or Modbus TCP."""

READ_COILS = 1
READ_DISCRETE = 2
READ_HOLDING = 3
READ_INPUT = 4
WRITE_COIL = 5
WRITE_ONE = 6
WRITE_COILS = 15
WRITE_MANY = 16
"""Function codes in use (Modbus application protocol V1.1b3)."""
_BIT_FUNCTIONS = frozenset({READ_COILS, READ_DISCRETE, WRITE_COIL, WRITE_COILS})
_COIL_ON = 0xFF00
"""Value of function 5 that switches a coil on (6.5)."""

MOST_WRITTEN = 123
"""Registers in one write (6.12)."""

EXCEPTION_TEXTS = {
    1: "illegal function",
    2: "illegal data address",
    3: "illegal data value",
    4: "device failure",
    5: "acknowledge",
    6: "device busy",
    7: "negative acknowledge",
    8: "write-protected, or memory parity error",
    10: "gateway path unavailable",
    11: "gateway target failed to respond",
}
"""Exception codes (Modbus application protocol V1.1b3, 7); 8 on a write: write-protected (JUMO)."""
CONFIGURATION, WRITE_PROTECTED, DEVICE_GONE = frozenset({1, 2, 3}), 8, frozenset({10, 11})
"""Exceptions of a device that is not as its profile says; one that is this for a write alone; those of a gateway whose
device is absent."""

# Without this handler the library would report bad frames on stderr; the link counts them instead.
logging.getLogger("pymodbus").addHandler(logging.NullHandler())


class _Replies(DecodePDU):
    """Decoder of the possible replies only, so that garbage is seldom decoded as the head of a frame."""

    pdu_table = {  # noqa: RUF012 - the library's own class attribute, narrowed
        READ_HOLDING: (ReadHoldingRegistersRequest, ReadHoldingRegistersResponse),
        READ_INPUT: (ReadInputRegistersRequest, ReadInputRegistersResponse),
        WRITE_ONE: (WriteSingleRegisterRequest, WriteSingleRegisterResponse),
        WRITE_MANY: (WriteMultipleRegistersRequest, WriteMultipleRegistersResponse),
    }


class _BitReplies(DecodePDU):
    """Decoder of the possible replies to requests for coils and discrete inputs only."""

    pdu_table = {  # noqa: RUF012 - the library's own class attribute, narrowed
        READ_COILS: (ReadCoilsRequest, ReadCoilsResponse),
        READ_DISCRETE: (ReadDiscreteInputsRequest, ReadDiscreteInputsResponse),
        WRITE_COIL: (WriteSingleCoilRequest, WriteSingleCoilResponse),
        WRITE_COILS: (WriteMultipleCoilsRequest, WriteMultipleCoilsResponse),
    }


_FRAMERS: dict[str, FramerRTU | FramerSocket] = {
    "rtu": FramerRTU(_Replies(False)),
    "socket": FramerSocket(_Replies(False)),
}
_BIT_FRAMERS: dict[str, FramerRTU | FramerSocket] = {
    "rtu": FramerRTU(_BitReplies(False)),
    "socket": FramerSocket(_BitReplies(False)),
}


class DecodedAnswer(Enum):
    """Relation of a well-formed frame to the request that waits for it."""

    GOOD = 1
    EXCEPTION = 2
    OTHER = 3
    """An answer, but not to this request."""


def read_request(framing: Framing, unit_id: int, function: int, address: int, count: int) -> bytes:
    """Return the request to read ``count`` registers, coils or discrete inputs from ``address``; transaction number 0
    on TCP.

    Raises ValueError for a function that does not read, a count outside 1..125 (of bits 1..2000) or an address outside
    16 bits.
    """
    if function == READ_HOLDING:
        return _build(framing, ReadHoldingRegistersRequest(dev_id=unit_id, address=address, count=count))
    if function == READ_INPUT:
        return _build(framing, ReadInputRegistersRequest(dev_id=unit_id, address=address, count=count))
    if function == READ_COILS:
        return _build(framing, ReadCoilsRequest(dev_id=unit_id, address=address, count=count))
    if function == READ_DISCRETE:
        return _build(framing, ReadDiscreteInputsRequest(dev_id=unit_id, address=address, count=count))
    raise ValueError(f"function {function} does not read (expected 1 to 4)")


def write_request(framing: Framing, unit_id: int, function: int, address: int, values: Sequence[int]) -> bytes:
    """Return the request to write ``values`` (0..65535 each, coils 0 or 1) from ``address``; transaction number 0 on
    TCP.

    Raises ValueError for a function that does not write, for no or too many values, and for values out of range.
    """
    coils = function in (WRITE_COIL, WRITE_COILS)
    if any(not 0 <= value <= (1 if coils else 0xFFFF) for value in values):
        raise ValueError(f"a {'coil holds 0 or 1' if coils else 'register holds 0..65535'}, not {list(values)}")
    if function == WRITE_COIL and len(values) == 1:
        return _build(framing, WriteSingleCoilRequest(dev_id=unit_id, address=address, bits=[values[0] == 1]))
    if function == WRITE_COILS and 1 <= len(values) <= MOST_WRITTEN:
        bits = [value == 1 for value in values]
        return _build(framing, WriteMultipleCoilsRequest(dev_id=unit_id, address=address, bits=bits))
    if function == WRITE_ONE and len(values) == 1:
        return _build(framing, WriteSingleRegisterRequest(dev_id=unit_id, address=address, registers=values))
    if function == WRITE_MANY and 1 <= len(values) <= MOST_WRITTEN:
        return _build(framing, WriteMultipleRegistersRequest(dev_id=unit_id, address=address, registers=values))
    expected = f"expected 6 for one register, 16 for up to {MOST_WRITTEN}; 5 for one coil, 15 for several"
    raise ValueError(f"function {function} does not write {len(values)} values ({expected})")


def _build(framing: Framing, message: ModbusPDU) -> bytes:
    return _FRAMERS[framing].buildFrame(message)


def write_reply(request: bytes) -> bytes:
    """Return the good RTU reply to a write: functions 5 and 6 repeat it, 15 and 16 its address and count."""
    return request if request[1] in (WRITE_COIL, WRITE_ONE) else with_crc(request[:6])


def data_length(function: int, count: int) -> int:
    """Return the bytes of data in a good reply to a read of ``count`` registers or bits; 0 for a write."""
    if function in (READ_COILS, READ_DISCRETE):
        return (count + 7) // 8
    return 2 * count if function in (READ_HOLDING, READ_INPUT) else 0


def reply_length(framing: Framing, function: int, count: int) -> int:
    """Return the length in bytes of a good reply to a request of ``count`` registers or bits."""
    data = data_length(function, count)
    return (1 + data if data else 4) + (4 if framing == "rtu" else 8)


def next_frame(framing: Framing, buffer: bytes, function: int = READ_HOLDING) -> tuple[int, int, int, bytes]:
    """Return (bytes consumed, unit id, transaction number, PDU) of the first frame in ``buffer``.

    ``function``: that of the request; a reply of registers is not looked for where bits were asked for, and vice versa.
    0 bytes consumed: no frame yet. Bytes consumed without a PDU: a frame that fails its CRC.
    """
    framers = _BIT_FRAMERS if function in _BIT_FUNCTIONS else _FRAMERS
    used, unit_id, transaction, pdu = framers[framing].decode(buffer)
    if pdu and framing == "rtu":
        # The library drops the bytes after the frame; they may be the answer we wait for.
        used = buffer.index(pdu) + len(pdu) + 2
    return used, unit_id, transaction, pdu


class FramingError(ValueError):
    """Bytes over TCP that cannot be the reply: the start of the next frame is unknown."""


def tcp_reply(data: bytes, transaction: int, unit_id: int, function: int, length: int) -> bytes:
    """Return the PDU of ``data``, which must be exactly one reply over TCP; b"" while it is incomplete.

    ``length``: bytes of the good reply. Raises FramingError for another transaction, protocol, length, unit or
    function, and for bytes beyond the frame (Modbus messaging on TCP/IP implementation guide V1.0b, 3.1.3).
    """
    for what, at, known in (
        ("transaction", 0, transaction.to_bytes(2, "big")),
        ("protocol", 2, b"\0\0"),
        ("unit", 6, bytes((unit_id,))),
    ):
        found = data[at : at + len(known)]
        if not known.startswith(found):
            raise FramingError(f"{what} {found.hex()} instead of {known.hex()}")
    good, refused = length - 6, 3
    counted = int.from_bytes(data[4:6], "big")
    if len(data) >= 6 and counted not in (good, refused):
        raise FramingError(f"{counted} bytes announced, expected {good}, or {refused} of an exception")
    answered = {function} if counted == good else {function | 0x80}
    if len(data) >= 8 and data[7] not in (answered if good != refused else {function, function | 0x80}):
        raise FramingError(f"function {data[7]} in a reply of {counted} bytes")
    reads = function <= READ_INPUT
    if len(data) >= 9 and data[7] == function and reads and data[8] != length - 9:
        raise FramingError(f"{data[8]} bytes of registers, expected {length - 9}")
    if len(data) > 6 + counted and len(data) >= 6:
        raise FramingError(f"{len(data) - 6 - counted} bytes after the reply")
    return data[7:] if len(data) >= 6 and len(data) == 6 + counted else b""


def classify(pdu: bytes, function: int, address: int, values: Sequence[int], count: int) -> DecodedAnswer:
    """Return how ``pdu`` answers a request of ``function`` from ``address``, to read ``count`` or write ``values``."""
    if pdu[0] == function | 0x80 and len(pdu) == 2:
        return DecodedAnswer.EXCEPTION
    if pdu[0] != function:
        return DecodedAnswer.OTHER
    data = data_length(function, count)
    if data:
        good = len(pdu) == 2 + data and pdu[1] == data
    else:
        one = function in (WRITE_COIL, WRITE_ONE) and len(values) == 1
        repeated = count if not one else values[0] * _COIL_ON if function == WRITE_COIL else values[0]
        good = pdu[1:] == address.to_bytes(2, "big") + repeated.to_bytes(2, "big")
    return DecodedAnswer.GOOD if good else DecodedAnswer.OTHER


def exception_code(pdu: bytes) -> int:
    """Return the code of an exception PDU (two bytes)."""
    message = ExceptionResponse(pdu[0] & 0x7F)
    message.decode(pdu[1:])
    return message.exception_code
