"""The line between the process that owns the rig and the gateway that talks to clients: text lines over a socket.

The owner's side never waits. What it says: a letter, then JSON; the gateway passes most of it on unread.

    s STATE \\t ROW    the state and its row of the trend; only the newest counts
    m MACHINE         the tables of the kind of rig, before the first state, and when a run is on another kind
    p PLAN            the plan, or null
    e SEQ EVENT       an event message
    a CLIENT REPLY    the answer to a client's command
    f FRAMES          a frames message
    t ROW             a row of the trend alone: the past, told to a gateway that was started anew
    n NOTE            something for the notify hook
    b                 goodbye: the owner was told to end, and has; without it, it has died
    k COUNT           so many of the gateway's lines have been looked at: it may say as many more

What the gateway says: one JSON object a line, an ``Order`` or a ``Presence``. No more than ``LINES_AT_ONCE`` of them
are on their way: what waits waits in the gateway, STOP first, of presences the newest alone, of orders some a client.
"""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

from pydantic import Field, TypeAdapter, ValidationError

from tester.service.address import with_peer
from tester.service.commands import MAX_MESSAGE, RigAction, Stop

MOST_QUEUED = 8_000_000
"""Bytes that wait for a gateway which does not read; then it is given up and started anew."""
READ_AT_ONCE = 65_536
LINES_AT_ONCE = 8
"""The owner looks at no more between two ticks, so that nobody can hold up a scan by talking."""
ORDERS_WAIT = 8
"""Orders of one client that may wait in the gateway."""


@dataclass(frozen=True, slots=True)
class Order:
    """A client's command for the rig."""

    client: int
    name: str
    id: int
    action: Annotated[RigAction, Field(discriminator="command")]
    peer: str = ""
    """Who the system says is at the client's end: user id or address."""
    type: Literal["order"] = "order"

    @property
    def by(self) -> str:
        """Who gives it, for the record: the name that the client has given itself, and its peer."""
        return with_peer(self.name, self.peer)


@dataclass(frozen=True, slots=True)
class Presence:
    """Who is connected now, and whether anybody watches frames."""

    controller: str
    controller_id: int
    viewers: int
    frames: bool
    signs: int = 0
    """Signs of life of whoever controls, counted."""
    peer: str = ""
    """Of whoever controls, as of an order."""
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
        if not count:
            return []
        try:
            heard = [FROM_GATEWAY.validate_json(self._lines.popleft()) for _ in range(count)]
        except ValidationError as error:
            raise LinkLost("the gateway says what is none of the link's") from error
        self.say(b"k%d" % count)
        return heard

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
        if len(self._heard) > 4 * MAX_MESSAGE:
            raise LinkLost("the gateway's line does not end")

    def drain(self, seconds: float) -> None:
        """Send what waits, and that nothing more will come; give up after a time (s).

        Not closed yet: with something of the gateway's unread that would reset the link, and lose what was sent.
        """
        self.socket.settimeout(seconds)
        try:
            self.flush()
            self.socket.shutdown(socket.SHUT_WR)
        except (LinkLost, OSError):  # TimeoutError is one
            return

    def close(self) -> None:
        """Let go of the socket."""
        self.socket.close()


class GatewayEnd:
    """The gateway's end: at most ``LINES_AT_ONCE`` lines are before the owner, and little can wait behind them."""

    def __init__(self, write: Callable[[bytes], None]) -> None:
        """``write``: takes a line for the owner."""
        self._write = write
        self._may = LINES_AT_ONCE
        self._stops: dict[int, Order] = {}
        """By client: the newest, or the newest fast one."""
        self._presence: Presence | None = None
        self._orders: deque[Order] = deque()

    def stop(self, order: Order) -> Order | None:
        """Pass a STOP on, before all else; return the one of this client's that another one stands for now, if any."""
        before = self._stops.get(order.client)
        if before is not None and _is_fast(before) and not _is_fast(order):
            return order
        self._stops[order.client] = order
        self._flush()
        return before

    def order(self, order: Order) -> bool:
        """Pass an order on; False where too many of this client's wait already."""
        if sum(one.client == order.client for one in self._orders) >= ORDERS_WAIT:
            return False
        self._orders.append(order)
        self._flush()
        return True

    def presence(self, presence: Presence) -> None:
        """Tell who is there; a telling that has not left yet is replaced."""
        self._presence = presence
        self._flush()

    def looked_at(self, count: int) -> None:
        """Take word that the owner has looked at so many lines."""
        self._may += count
        self._flush()

    def _flush(self) -> None:
        while self._may > 0:
            one: Order | Presence
            if self._stops:
                one = self._stops.pop(next(iter(self._stops)))
            elif self._presence is not None:
                one, self._presence = self._presence, None
            elif self._orders:
                one = self._orders.popleft()
            else:
                return
            self._may -= 1
            self._write(FROM_GATEWAY.dump_json(one))


def _is_fast(order: Order) -> bool:
    return isinstance(order.action, Stop) and order.action.fast
