"""Bytes received in answer to a Modbus request: over TCP, on a serial line, or on a line with echo.

Over TCP any doubt about framing ends the connection: bytes of the old one are never read. On a serial line the reply
is searched for in the bytes received, and everything else is counted. A reply to a write begins like the write, or is
equal to it. So nothing is written before it is known whether the adapter echoes.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from drivers.crc16 import crc16
from drivers.modbus import codec
from drivers.modbus.request import Request


class AnswerKind(IntEnum):
    """State of the answer so far."""

    WAITED_FOR = 0
    """Nothing complete yet."""
    GOOD = 1
    EXCEPTION = 2
    BROKEN = 3
    """No reply, and none will follow: the attempt has failed."""
    DOUBTED = 4
    """The start of the next frame is unknown (TCP)."""


@dataclass(frozen=True, slots=True)
class ReplySoFar:
    """``data``: registers of a good reply, empty for a write; while it is awaited, the bytes to keep until then."""

    kind: AnswerKind
    data: bytes = b""
    code: int = 0
    """Code of an exception."""
    why: str = ""
    """Reason of a doubt."""


BROKEN: Final = ReplySoFar(AnswerKind.BROKEN)


def numbered(request: Request, transaction: int) -> bytes:
    """Return a request's frame over TCP with a transaction number."""
    return transaction.to_bytes(2, "big") + request.frame[2:]


def tcp_answer(request: Request, sent: bytes, data: bytes) -> ReplySoFar:
    """Return the reply to ``sent`` if ``data`` is that reply and nothing else; anything else is counted."""
    counters = request.station.counters
    transaction = int.from_bytes(sent[:2], "big")
    try:
        pdu = codec.tcp_reply(data, transaction, request.station.unit_id, request.function, request.reply_length)
    except codec.FramingError as error:
        if data[:2] != sent[:2]:
            counters.late += 1
        else:
            counters.garbage += 1
        return ReplySoFar(AnswerKind.DOUBTED, why=f"{error} on {request.describe()}")
    if not pdu:
        return ReplySoFar(AnswerKind.WAITED_FOR, data)
    answer = codec.classify(pdu, request.function, request.address, request.sent_values, request.count)
    if answer is codec.DecodedAnswer.OTHER:
        counters.late += 1
        return ReplySoFar(AnswerKind.DOUBTED, why=f"another reply on {request.describe()}")
    return _reply(request, answer, pdu)


def _reply(request: Request, answer: codec.DecodedAnswer, pdu: bytes) -> ReplySoFar:
    if answer is codec.DecodedAnswer.EXCEPTION:
        return ReplySoFar(AnswerKind.EXCEPTION, code=codec.exception_code(pdu))
    return ReplySoFar(AnswerKind.GOOD, b"" if request.writes else pdu[2:])


def serial_answer(request: Request, data: bytes) -> ReplySoFar:
    """Find the reply in the bytes of a serial line, and count everything else there."""
    counters = request.station.counters
    at = data.find(request.head) if request.head else -1
    whole = data[at : at + request.reply_length] if at >= 0 else b""
    if len(whole) == request.reply_length and crc16(whole) == 0:
        counters.garbage += at > 0  # noise before it, as when a line driver switches on
        return ReplySoFar(AnswerKind.GOOD, whole[3:-2])
    while data:
        used, unit_id, _, pdu = codec.next_frame("rtu", data, request.function)
        if not used:
            break
        if not pdu:
            counters.crc_errors += 1
            return BROKEN
        data = data[used:]
        answer = codec.classify(pdu, request.function, request.address, request.sent_values, request.count)
        if unit_id != request.station.unit_id:
            counters.garbage += 1
        elif answer is codec.DecodedAnswer.OTHER:
            counters.late += 1
        else:
            if data:
                counters.garbage += 1
            return _reply(request, answer, pdu)
    return ReplySoFar(AnswerKind.WAITED_FOR, data)


class SerialEar:
    """Removes the echo of sent bytes, and finds out whether the adapter echoes.

    The request of a read is never a reply to it: an adapter that returns it echoes. A reply to a read without it shows
    that the adapter does not. ``hears_itself`` is None until either has come. ``stripped``: the echo of the request
    under way was removed; the sender of a request clears it.
    """

    def __init__(self, hears_itself: bool | None = None) -> None:
        """Begin with what is known of the echo; None: nothing."""
        self.hears_itself: bool | None = hears_itself
        self.stripped = False

    def answer(self, request: Request, sent: bytes, data: bytes) -> ReplySoFar:
        """Return the answer to ``sent``, without the echo."""
        if self.hears_itself is False and (request.writes or not data.startswith(sent)):
            return serial_answer(request, data)
        # The adapter may be exchanged between two replies: from then on it counts as an adapter with echo.
        if not self.stripped:
            if len(data) < len(sent) and sent.startswith(data):
                return ReplySoFar(AnswerKind.WAITED_FOR, data)
            if data.startswith(sent):
                self.stripped = True
                self.hears_itself = True
                data = data[len(sent) :]
                if not data:
                    return ReplySoFar(AnswerKind.WAITED_FOR)
            elif request.writes:
                # Before its own echo nothing can be the answer to a write.
                request.station.counters.garbage += 1
                return BROKEN
        if request.writes and data == request.echo:
            return ReplySoFar(AnswerKind.GOOD)
        found = serial_answer(request, data)
        if self.hears_itself is None and found.kind in (AnswerKind.GOOD, AnswerKind.EXCEPTION):
            self.hears_itself = False
        return found
