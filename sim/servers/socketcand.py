"""The server's half of the socketcand protocol, as far as a client in raw mode uses it; sans-IO.

Source: github.com/linux-can/socketcand, doc/protocol.md. The server greets a client with ``< hi >``. The client opens a
bus by name, asks for ``< rawmode >``, then sends ``< send id length b0 b1 ... >`` and gets
``< frame id seconds data >``. The protocol has no remote and FD frames.
"""

from __future__ import annotations

from math import inf

from drivers.ports import CanFrame

GREETING = b"< hi >"
BUSY = b"< error another program is connected >"
"""Answer to a second client instead of the greeting: only one client has control."""
HOLD_BACK_S = 0.05
"""Time after the begin of raw mode in which no frame is sent to a client unless it sends one first, s [A].

Clients compare the answer ``< ok >`` with a whole piece of received bytes (python-can 4.6): a frame in the same
piece would end their connection.
"""
LONGEST_ELEMENT = 256
"""Greatest length of an element, characters; the longest valid element has less than 60."""

_OK = b"< ok >"
_STANDARD_DIGITS = 3
_HIGHEST_ID = 0x7FF


class SocketcandSession:
    """One client's conversation: ``feed`` takes the client's bytes, ``outgoing`` holds the bytes for the client.

    ``ended`` is the reason for the end of the conversation, "" before it. ``ignored`` counts frames that the simulated
    bus does not carry (29-bit identifiers), ``refused`` elements that are no valid command.
    """

    def __init__(self) -> None:
        """Queue the greeting."""
        self.outgoing = bytearray(GREETING)
        self.bus = ""
        self.ended = ""
        self.ignored = 0
        self.refused = 0
        self._buffer = b""
        self._frames_from_s = inf

    @property
    def raw(self) -> bool:
        """Return whether frames are exchanged in both directions."""
        return self._frames_from_s < inf

    def feed(self, data: bytes, now: float) -> list[tuple[int, bytes]]:
        """Process the client's bytes; return the frames for the bus as (identifier, data), in order."""
        frames: list[tuple[int, bytes]] = []
        buffer = self._buffer + data
        while True:
            start = buffer.find(b"<")
            end = buffer.find(b">", start)
            if start < 0 or end < 0:
                break
            words = buffer[start + 1 : end].split()
            buffer = buffer[end + 1 :]
            if words and words[0] == b"send" and self.raw:
                self._send(words, frames)
            else:
                self._command(words, now)
        self._buffer = buffer[start:] if start >= 0 else b""
        if len(self._buffer) > LONGEST_ELEMENT:
            self.ended = "sent an element without an end"
        return frames

    def relay(self, frames: list[CanFrame], now: float) -> None:
        """Queue frames of the bus for the client; before it can accept them they are dropped, as on any other bus."""
        if now < self._frames_from_s:
            return
        for t, can_id, data in frames:
            self.outgoing += f"< frame {can_id:03X} {t:.6f} {data.hex().upper()} >".encode("ascii")

    def _command(self, words: list[bytes], now: float) -> None:
        match words:
            case [b"open", name] if not self.bus:
                self.bus = name.decode("ascii", errors="replace")
                self.outgoing += _OK
            case [b"rawmode"] if self.bus:
                self._frames_from_s = now + HOLD_BACK_S
                self.outgoing += _OK
            case [b"echo"]:
                self.outgoing += b"< echo >"
            case _:
                self.refused += 1
                self.outgoing += b"< error unknown command >"

    def _send(self, words: list[bytes], frames: list[tuple[int, bytes]]) -> None:
        self._frames_from_s = -inf  # the client has completed its handshake
        try:
            can_id = int(words[1], 16)
            length = int(words[2], 16)
            data = bytes(int(word, 16) for word in words[3:])
        except (IndexError, ValueError):
            self._refuse()
            return
        if length != len(data) or length > 8:
            self._refuse()
        elif len(words[1]) > _STANDARD_DIGITS or not 0 <= can_id <= _HIGHEST_ID:
            self.ignored += 1
        else:
            frames.append((can_id, data))

    def _refuse(self) -> None:
        self.refused += 1
        self.outgoing += b"< error could not parse frame >"
