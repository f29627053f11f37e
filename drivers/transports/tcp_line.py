"""A TCP connection as a line that carries Modbus."""

from __future__ import annotations

import select
import socket
from math import inf

from drivers.ports import BusLost, WatchedLine

_CHUNK = 4096
"""Bytes fetched at once: a Modbus TCP frame has at most 260."""
REOPEN_S = 0.5
"""Time within which a dropped connection is open again, or lost, s: the shortest time after which a further sensor's
reading is stale (drivers.sensor). A sensor that may be missing for less trips by its own row of the interlocks."""
_AGAIN_S = 0.02
"""Pause between two attempts to connect again, s [A]."""


class TcpLine(WatchedLine):
    """A port (``drivers.ports.LinePort``) over a connected socket. Nothing blocks: the kernel keeps what arrives.

    Bytes are stamped with the time of fetching, which is no earlier than their arrival. ``renewed`` counts how
    often the connection was dropped and opened anew (``renew``).
    """

    remedy = "look at the network and at the gateway's own reply and polling times"

    def __init__(self, connection: socket.socket, peer: str) -> None:
        """Take a connected socket; ``peer`` names it in messages."""
        super().__init__()
        self._family, self._address = connection.family, connection.getpeername()
        self._connecting = False
        self._until_s = self._again_s = inf
        self.renewed = 0
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connection
        self._peer = peer
        self._unsent = b""

    def write(self, data: bytes, now: float) -> None:
        """Send bytes; those that the kernel does not accept now are sent with the next call. Raises BusLost."""
        self._unsent += data
        self._send()
        if self.watchers:
            self.tell(now, data, True)

    def renew(self, now: float) -> None:
        """Drop the connection with all that is under way on it, and open another one.

        It is open at the latest ``REOPEN_S`` after ``now`` (s), or a read raises BusLost. Bytes written meanwhile are
        sent then.
        """
        self._unsent = b""
        if self._connecting:
            return
        self.renewed += 1
        self._connecting = True
        self._until_s = now + REOPEN_S
        self._attempt(now)

    def _attempt(self, now: float) -> None:
        self._socket.close()
        self._socket = socket.socket(self._family, socket.SOCK_STREAM)
        self._socket.setblocking(False)
        self._again_s = now + _AGAIN_S
        self._socket.connect_ex(self._address)

    def _connected(self, now: float) -> bool:
        """Return whether the connection is up; raises BusLost if it should be and is not."""
        if not self._connecting:
            return True
        _, writable, failed = select.select((), (self._socket,), (self._socket,), 0.0)
        error = self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) if writable or failed else 0
        if writable and not error:
            self._connecting = False
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            return True
        if now >= self._until_s:
            raise BusLost(f"{self._peer}: no connection within {1000 * REOPEN_S:g} ms after the last one was dropped")
        if (error or failed) and now >= self._again_s:
            self._attempt(now)
        return False

    def _send(self) -> None:
        if self._connecting:
            return
        try:
            sent = self._socket.send(self._unsent) if self._unsent else 0
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            raise BusLost(f"{self._peer}: {error}") from error
        self._unsent = self._unsent[sent:]

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return the bytes received, stamped ``now`` (s). Raises BusLost, also when the peer closed the connection."""
        if not self._connected(now):
            return []
        if self._unsent:
            self._send()
        try:
            data = self._socket.recv(_CHUNK)
        except (BlockingIOError, InterruptedError):
            return []
        except OSError as error:
            raise BusLost(f"{self._peer}: {error}") from error
        if not data:
            raise BusLost(f"{self._peer}: connection closed by the other side")
        if self.watchers:
            self.tell(now, data, False)
        return [(now, data)]

    def fileno(self) -> int:
        """Return the descriptor to wait on for arriving bytes."""
        return self._socket.fileno()

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


def open_tcp_line(host: str, port: int = 502, timeout_s: float = 3.0) -> TcpLine:
    """Connect to a Modbus TCP device; 502 is the registered port. Raises BusLost when it cannot be reached in time."""
    try:
        connection = socket.create_connection((host, port), timeout_s)
    except OSError as error:
        raise BusLost(f"{host}:{port}: {error}") from error
    return TcpLine(connection, f"{host}:{port}")
