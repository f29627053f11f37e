"""The line between the process that owns the rig and the gateway that talks to clients: text lines over a socket.

The owner's side never waits. What it says: a letter, then JSON; the gateway passes most of it on unread.

    s STATE \\t ROW    the state and its row of the trend; only the newest counts
    p PLAN            the plan, or null
    e SEQ EVENT       an event message
    a CLIENT REPLY    the answer to a client's command
    f FRAMES          a frames message
    t ROW             a row of the trend alone: the past, told to a gateway that was started anew
    n NOTE            something for the notify hook

What the gateway says: one JSON object a line, an ``Order`` or a ``Presence``.
"""

from __future__ import annotations

import socket
from collections import deque
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter

from tester.service.commands import RigAction

MOST_QUEUED = 8_000_000
"""Bytes that wait for a gateway which does not read; then it is given up and started anew."""
READ_AT_ONCE = 65_536
LINES_AT_ONCE = 8
"""The owner looks at no more between two ticks, so that nobody can hold up a scan by talking."""


@dataclass(frozen=True, slots=True)
class Order:
    """A client's command for the rig."""

    client: int
    name: str
    id: int
    action: Annotated[RigAction, Field(discriminator="command")]
    type: Literal["order"] = "order"


@dataclass(frozen=True, slots=True)
class Presence:
    """Who is connected now, and whether anybody watches frames."""

    controller: str
    controller_id: int
    viewers: int
    frames: bool
    type: Literal["presence"] = "presence"


FromGateway: TypeAlias = Annotated[Order | Presence, Field(discriminator="type")]
FROM_GATEWAY: TypeAdapter[FromGateway] = TypeAdapter(FromGateway)


class LinkLost(Exception):  # noqa: N818 - says what happened, as BusLost does
    """The other end is gone, or does not read any more."""


class OwnerEnd:
    """The owner's end: what cannot be sent at once waits; of states only the newest does."""

    def __init__(self, end: socket.socket) -> None:
        """Take one end of a socket pair."""
        end.setblocking(False)
        self.socket = end
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._state = b""
        self._sent = 0
        """Bytes of the first waiting line that are gone."""
        self._heard = b""
        self._lines: deque[bytes] = deque()

    def say(self, line: bytes) -> None:
        """Queue a line that must arrive. Raises LinkLost for a gateway that has stopped reading."""
        self._waiting.append(line + b"\n")
        self._waiting_bytes += len(line) + 1
        if self._waiting_bytes > MOST_QUEUED:
            raise LinkLost("the gateway does not read")
        self.flush()

    def say_state(self, line: bytes) -> None:
        """Send a state; one that has not left yet is replaced."""
        self._state = line + b"\n"
        self.flush()

    def flush(self) -> None:
        """Send what the socket takes. Raises LinkLost."""
        while True:
            if not self._waiting:
                if not self._state:
                    return
                self._waiting.append(self._state)
                self._waiting_bytes += len(self._state)
                self._state = b""
            first = self._waiting[0]
            try:
                self._sent += self.socket.send(first[self._sent :] if self._sent else first)
            except BlockingIOError:
                return
            except OSError as error:
                raise LinkLost(str(error)) from error
            if self._sent < len(first):
                return
            self._waiting.popleft()
            self._waiting_bytes -= len(first)
            self._sent = 0

    def hear(self) -> list[Order | Presence]:
        """Return what the gateway said, a bounded piece of it, without waiting. Raises LinkLost."""
        if len(self._lines) < LINES_AT_ONCE:
            self._read()
        count = min(len(self._lines), LINES_AT_ONCE)
        return [FROM_GATEWAY.validate_json(self._lines.popleft()) for _ in range(count)]

    @property
    def heard(self) -> bool:
        """Something read has not been looked at yet."""
        return bool(self._lines)

    def _read(self) -> None:
        try:
            data = self.socket.recv(READ_AT_ONCE)
        except BlockingIOError:
            return
        except OSError as error:
            raise LinkLost(str(error)) from error
        if not data:
            raise LinkLost("the gateway has ended")
        self._heard += data
        if b"\n" in data:
            *lines, self._heard = self._heard.split(b"\n")
            self._lines.extend(lines)

    def drain(self, seconds: float) -> None:
        """Send what waits, at the end; give up after a time (s)."""
        self.socket.settimeout(seconds)
        try:
            self.flush()
        except (LinkLost, TimeoutError):
            return

    def close(self) -> None:
        """Let go of the socket."""
        self.socket.close()
