r"""The link between the process that owns the rig and the gateway that talks to clients: text lines over a socket.

The owner's side never waits. Each of its lines is a letter, then JSON; the gateway forwards most of the JSON unread.

    s STATE \t ROW    the state and its row of the trend; only the newest counts
    m MACHINE         the tables of the kind of rig, before the first state, and when a run uses another kind
    p PLAN            the plan, or null
    q QUEUE           the queue
    e SEQ EVENT       an event message
    a CLIENT REPLY    the answer to a client's command
    f FRAMES          a frames message
    t ROW             a row of the trend alone: history for a gateway that has restarted
    n NOTE            a note for the process that sends notices (``tester.notices.notice``)
    b                 goodbye: the owner has ended on request; without it, the owner has died
    k COUNT           the owner has read this many of the gateway's lines: the gateway may send as many more

The gateway sends one JSON object a line, an ``Order`` or a ``Presence``. At most ``LINES_AT_ONCE`` of them are unread.
Further ones wait in the gateway: STOP first, only the newest presence, and a few orders of each client.
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
"""Greatest number of bytes waiting for a gateway that does not read; above it the gateway is abandoned and
restarted.
"""
READ_AT_ONCE = 65_536
LINES_AT_ONCE = 8
"""Greatest number of lines that the owner reads between two ticks, so that busy clients cannot delay a scan."""
ORDERS_WAIT = 8
"""Greatest number of orders of one client that wait in the gateway."""


@dataclass(frozen=True, slots=True)
class Order:
    """A client's command for the rig."""

    client: int
    name: str
    id: int
    action: Annotated[RigAction, Field(discriminator="command")]
    peer: str = ""
    """The client's user id or address, as the operating system reports it."""
    type: Literal["order"] = "order"

    @property
    def by(self) -> str:
        """The recorded sender: the client's name for itself, and its user id or address."""
        return with_peer(self.name, self.peer)


@dataclass(frozen=True, slots=True)
class Presence:
    """The connected clients, and whether any of them watches frames."""

    controller: str
    controller_id: int
    viewers: int
    frames: bool
    signs: int = 0
    """Number of signs of life from the controller."""
    peer: str = ""
    """The controller's peer, as in an order."""
    type: Literal["presence"] = "presence"


FromGateway: TypeAlias = Annotated[Order | Presence, Field(discriminator="type")]
FROM_GATEWAY: TypeAdapter[FromGateway] = TypeAdapter(FromGateway)


class LinkLost(Exception):  # noqa: N818 - an event, as BusLost
    """The other end has gone, or has stopped reading."""


class OwnerEnd:
    """The owner's end. It queues unsent lines; of the unsent states it keeps only the newest."""

    def __init__(self, end: socket.socket) -> None:
        """Take one end of a socket pair."""
        end.setblocking(False)
        self.socket = end
        self._waiting: deque[bytes] = deque()
        self._waiting_bytes = 0
        self._state = b""
        self._sent = 0
        """Number of bytes of the first waiting line that are already sent."""
        self._received = b""
        self._lines: deque[bytes] = deque()

    def send(self, line: bytes) -> None:
        """Queue a line that must arrive. Raises LinkLost if the gateway has stopped reading."""
        self._waiting.append(line + b"\n")
        self._waiting_bytes += len(line) + 1
        if self._waiting_bytes > MOST_QUEUED:
            raise LinkLost("the gateway does not read")
        self.flush()

    def send_state(self, line: bytes) -> None:
        """Send a state; it replaces an earlier state that is still waiting."""
        self._state = line + b"\n"
        self.flush()

    def flush(self) -> None:
        """Send as much as the socket accepts. Raises LinkLost."""
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

    def receive(self) -> list[Order | Presence]:
        """Return the gateway's messages, a limited number at a time, without waiting. Raises LinkLost."""
        if len(self._lines) < LINES_AT_ONCE:
            self._read()
        count = min(len(self._lines), LINES_AT_ONCE)
        if not count:
            return []
        try:
            messages = [FROM_GATEWAY.validate_json(self._lines.popleft()) for _ in range(count)]
        except ValidationError as error:
            raise LinkLost("the gateway sent an unknown message") from error
        self.send(b"k%d" % count)
        return messages

    @property
    def has_lines(self) -> bool:
        """Whether a line has arrived that ``receive`` has not returned."""
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
        self._received += data
        if b"\n" in data:
            *lines, self._received = self._received.split(b"\n")
            self._lines.extend(lines)
        if len(self._received) > 4 * MAX_MESSAGE:
            raise LinkLost("the gateway's line does not end")

    def drain(self, seconds: float) -> None:
        """Send the waiting lines and close the sending side; give up after ``seconds``.

        The socket stays open: closing it with unread input would reset the link and lose the lines just sent.
        """
        self.socket.settimeout(seconds)
        try:
            self.flush()
            self.socket.shutdown(socket.SHUT_WR)
        except (LinkLost, OSError):  # OSError includes TimeoutError
            return

    def close(self) -> None:
        """Close the socket."""
        self.socket.close()


class GatewayEnd:
    """The gateway's end. It sends while fewer than ``LINES_AT_ONCE`` of its lines are unread by the owner.

    Further messages wait here: each client's latest STOP, the latest presence, and a few orders of each client.
    """

    def __init__(self, write: Callable[[bytes], None]) -> None:
        """``write`` sends a line to the owner."""
        self._write = write
        self._may = LINES_AT_ONCE
        self._stops: dict[int, Order] = {}
        """By client number: the newest STOP, or the newest fast STOP."""
        self._presence: Presence | None = None
        self._orders: deque[Order] = deque()

    def stop(self, order: Order) -> Order | None:
        """Forward a STOP before everything else; return this client's waiting STOP that it replaces, if there is
        one.
        """
        before = self._stops.get(order.client)
        if before is not None and _is_fast(before) and not _is_fast(order):
            return order
        self._stops[order.client] = order
        self._flush()
        return before

    def order(self, order: Order) -> bool:
        """Forward an order; return False if too many of this client's orders wait."""
        if sum(queued.client == order.client for queued in self._orders) >= ORDERS_WAIT:
            return False
        self._orders.append(order)
        self._flush()
        return True

    def presence(self, presence: Presence) -> None:
        """Send which clients are connected; this replaces an earlier presence that is still waiting."""
        self._presence = presence
        self._flush()

    def looked_at(self, count: int) -> None:
        """Record that the owner has read ``count`` more lines."""
        self._may += count
        self._flush()

    def _flush(self) -> None:
        while self._may > 0:
            message: Order | Presence
            if self._stops:
                message = self._stops.pop(next(iter(self._stops)))
            elif self._presence is not None:
                message, self._presence = self._presence, None
            elif self._orders:
                message = self._orders.popleft()
            else:
                return
            self._may -= 1
            self._write(FROM_GATEWAY.dump_json(message))


def _is_fast(order: Order) -> bool:
    return isinstance(order.action, Stop) and order.action.fast
