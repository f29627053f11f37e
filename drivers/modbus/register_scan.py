"""Ask devices of a Modbus line for registers, one question at a time: the base of a survey of a line.

Nothing is written. Each answer also contains the device's reply time, and any bytes that were no answer; a driver's
link would have given a late answer up.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Final

from drivers.modbus import codec
from drivers.modbus.line import silent_gap_s
from drivers.ports import LineFraming, LinePort, Parity, byte_bits

SETTLE_S: Final = 0.005
"""Silence kept after bytes that were no answer, s: the rest of them may still come [A]."""


@dataclass(frozen=True, slots=True)
class RegisterQuestion:
    """Registers to read."""

    unit_id: int
    function: int
    address: int
    count: int


@dataclass(frozen=True, slots=True)
class LineAnswer:
    """Outcome of a question: registers (``data``), an exception code, noise, or nothing."""

    question: RegisterQuestion
    data: bytes = b""
    exception: int = 0
    noise: bytes = b""
    """Bytes received that were no answer to it."""
    at_s: float = inf
    """Arrival of its last byte, s."""
    delay_s: float = inf
    """Time from the end of the request to the answer, less the answer's time on the wire, s."""
    took_s: float = inf
    """Time from the request's first byte to the answer's last, s."""

    @property
    def ok(self) -> bool:
        """Whether registers came."""
        return bool(self.data)

    @property
    def there(self) -> bool:
        """Whether a device answered, with registers or an exception."""
        return bool(self.data) or self.exception != 0

    def describe(self) -> str:
        """Return the outcome for people."""
        if self.data:
            return "an answer"
        if self.exception:
            text = codec.EXCEPTION_TEXTS.get(self.exception, "unknown")
            return f"exception {self.exception} ({text})"
        if self.noise:
            return f"{len(self.noise)} bytes that are no answer ({self.noise[:8].hex(' ')})"
        return "nothing"


class LineScan:
    """Asks one question after the other: ``ask``, then ``feed`` and ``service`` until ``answer`` is set."""

    def __init__(self, framing: LineFraming, baud: int, parity: Parity, stop_bits: int = 1) -> None:
        """Take the line; ``baud`` in bit/s, ``parity`` and ``stop_bits`` matter on a serial line only."""
        rtu = framing != "socket"
        self.framing: codec.Framing = "rtu" if rtu else "socket"
        bits = byte_bits(framing, parity, stop_bits)
        self._character_s = bits / baud if rtu else 0.0
        self._gap_s = silent_gap_s(bits, baud) if rtu else 0.0
        self._question: RegisterQuestion | None = None
        self._timeout_s = 0.0
        self._sent_s: float | None = None
        self._request_s = 0.0
        self._quiet_s = -inf
        self._buffer = b""
        self._transaction = 0
        self._frame = b""
        self.hears_itself = False
        """Whether the adapter returns what it sends: the request of a read is never an answer to it."""
        self.answer: LineAnswer | None = None

    def ask(self, question: RegisterQuestion, timeout_s: float) -> None:
        """Begin a question; it is sent by ``service``. The answer may begin ``timeout_s`` after the request."""
        self._question, self._timeout_s = question, timeout_s
        self._sent_s, self._buffer, self.answer = None, b"", None

    def feed(self, chunks: list[tuple[float, bytes]], now: float) -> None:
        """Take what arrived up to ``now`` s."""
        question = self._question
        for t, chunk in chunks:
            if question is None or self._sent_s is None or self.answer is not None:
                self._quiet_s = max(self._quiet_s, t + SETTLE_S)  # late bytes of a question that was given up
                continue
            self._buffer += chunk
            self._examine(question, t)

    def service(self, port: LinePort, now: float) -> None:
        """Send the question when the line is free, or give it up when it is overdue at ``now`` s; raises BusLost."""
        question = self._question
        if question is None or self.answer is not None:
            return
        if self._sent_s is None:
            if now >= self._quiet_s:
                self._send(question, port, now)
        elif now >= self._sent_s + self._request_s + self._timeout_s + self._reply_s(question):
            self.answer = LineAnswer(question, noise=self._buffer)
            self._quiet_s = now + SETTLE_S

    def _send(self, question: RegisterQuestion, port: LinePort, now: float) -> None:
        frame = codec.read_request(self.framing, question.unit_id, question.function, question.address, question.count)
        if self.framing == "socket":
            self._transaction = self._transaction % 0xFFFF + 1
            frame = self._transaction.to_bytes(2, "big") + frame[2:]
        port.write(frame, now)
        self._frame, self._sent_s = frame, now
        self._request_s = len(frame) * self._character_s

    def _reply_s(self, question: RegisterQuestion) -> float:
        return codec.reply_length(self.framing, question.function, question.count) * self._character_s

    def _examine(self, question: RegisterQuestion, t: float) -> None:
        """Find the answer in the bytes received; the rest is kept, and reported as noise when the time is over."""
        if self.framing == "rtu" and self._buffer.startswith(self._frame):
            self.hears_itself = True
            self._buffer = self._buffer.removeprefix(self._frame)
        at, data = 0, self._buffer
        while at < len(data):
            used, unit_id, transaction, pdu = codec.next_frame(self.framing, data[at:], question.function)
            if not used:
                return
            at += used
            if not pdu or unit_id != question.unit_id:
                continue
            if self.framing == "socket" and transaction != self._transaction:
                continue
            found = codec.classify(pdu, question.function, question.address, (), question.count)
            if found is codec.DecodedAnswer.OTHER:
                continue
            sent_s = self._sent_s or 0.0
            wire_s = self._request_s + self._gap_s + len(pdu) * self._character_s + 3 * self._character_s
            delay_s = max(t - sent_s - wire_s, 0.0)
            if found is codec.DecodedAnswer.EXCEPTION:
                self.answer = LineAnswer(question, exception=codec.exception_code(pdu), at_s=t, delay_s=delay_s,
                                         took_s=t - sent_s)  # fmt: skip
            else:
                self.answer = LineAnswer(question, data=pdu[2:], at_s=t, delay_s=delay_s, took_s=t - sent_s)
            self._quiet_s = t + self._gap_s
            return
