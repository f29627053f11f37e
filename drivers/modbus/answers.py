"""What came over a Modbus line in answer to a request: over TCP, on a serial line, on one that hears itself.

Over TCP any doubt about framing ends the connection: what comes of the old one is never read. On a serial line a reply
is looked for in what came, and everything else there is counted. A reply to a write begins like the write, or is equal
to it: nothing is written before it is known whether the adapter hears itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from drivers.crc16 import crc16
from drivers.modbus import codec
from drivers.modbus.request import Request


class AnswerKind(IntEnum):
    """What has come so far."""

    WAITED_FOR = 0
    """Nothing whole yet."""
    GOOD = 1
    EXCEPTION = 2
    BROKEN = 3
    """No reply, and none will follow: the attempt has failed."""
    DOUBTED = 4
    """The begin of the next frame is unknown (TCP)."""


@dataclass(frozen=True, slots=True)
class ReplySoFar:
    """``data``: registers of a good reply, empty for a write; of one that is waited for, what to keep until then."""

    kind: AnswerKind
    data: bytes = b""
    code: int = 0
    """Of an exception."""
    why: str = ""
    """Of a doubt."""


BROKEN: Final = ReplySoFar(AnswerKind.BROKEN)


def numbered(request: Request, transaction: int) -> bytes:
    """Return a request's frame over TCP with a transaction number."""
    return transaction.to_bytes(2, "big") + request.frame[2:]


def tcp_answer(request: Request, sent: bytes, data: bytes) -> ReplySoFar:
    """Take what came over TCP for the reply to ``sent`` where it is that and nothing else; what is not is counted."""
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
    """Find the reply in what came on a serial line, and count what else is there."""
    counters = request.station.counters
    at = data.find(request.head) if request.head else -1
    whole = data[at : at + request.reply_length] if at >= 0 else b""
    if len(whole) == request.reply_length and crc16(whole) == 0:
        counters.garbage += at > 0  # noise before it, as when a driver of the line is switched on
        return ReplySoFar(AnswerKind.GOOD, whole[3:-2])
    while data:
        used, unit_id, _, pdu = codec.next_frame("rtu", data)
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
    """Takes off what was sent, where the adapter gives it back, and finds out whether it does.

    The request of a read is never a reply to it: who gets it back hears itself. Whose reply to a read comes without it
    does not. ``hears_itself`` is None until one of the two has come.
    """

    def __init__(self, hears_itself: bool | None = None) -> None:
        """Begin with what is known."""
        self.hears_itself: bool | None = hears_itself
        self._stripped = False

    def asked(self) -> None:
        """Begin anew: a request was sent."""
        self._stripped = False

    def answer(self, request: Request, sent: bytes, data: bytes) -> ReplySoFar:
        """Return what came in answer to ``sent``."""
        if self.hears_itself is False and (request.writes or not data.startswith(sent)):
            return serial_answer(request, data)
        # The adapter may be changed between two replies: from then on it counts as one that hears itself.
        if not self._stripped:
            if len(data) < len(sent) and sent.startswith(data):
                return ReplySoFar(AnswerKind.WAITED_FOR, data)
            if data.startswith(sent):
                self._stripped = True
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
