"""Sockets of the doors: they never block and never raise; a client that left is ``gone``."""

from __future__ import annotations

import socket
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Sequence
from typing import Generic, TypeVar

from sim.servers.doors import Readable

Session = TypeVar("Session")

MOST_UNSENT = 256 * 1024
"""Bytes kept for a client that does not read; beyond them new bytes are dropped, as by a full adapter [A]."""
_CHUNK = 8192


class Connection:
    """One client."""

    def __init__(self, connected: socket.socket) -> None:
        """Take an accepted socket."""
        connected.setblocking(False)
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket = connected
        self.gone = False
        self.dropped = 0
        self._unsent = bytearray()

    def receive(self) -> bytes:
        """Return the bytes received, b"" for none; ``gone`` is set at the end of the stream."""
        try:
            data = self.socket.recv(_CHUNK)
        except (BlockingIOError, InterruptedError):
            return b""
        except OSError:
            data = b""
        self.gone = not data
        return data

    def send(self, data: bytearray) -> None:
        """Send bytes, now or with a later call, and empty ``data``."""
        if len(self._unsent) > MOST_UNSENT:
            self.dropped += len(data)
        else:
            self._unsent += data
        data.clear()
        if not self._unsent:
            return
        try:
            sent = self.socket.send(self._unsent)
        except (BlockingIOError, InterruptedError):
            return
        except OSError:
            self.gone = True
            return
        del self._unsent[:sent]

    def close(self) -> None:
        """Close the connection."""
        self.socket.close()


def accepted(listener: socket.socket) -> Connection | None:
    """Return the next client's connection; None if the client has left already."""
    try:
        return Connection(listener.accept()[0])
    except OSError:
        return None


class ClientsDoor(ABC, Generic[Session]):
    """A TCP door with several clients, each with a session; connections beyond ``most`` are closed at once."""

    def __init__(self, listener: socket.socket, most: int, begin: Callable[[], Session]) -> None:
        """Wait for clients; ``begin`` makes a client's session."""
        self.listener = listener
        self._most, self._begin = most, begin
        self.clients: dict[socket.socket, tuple[Connection, Session]] = {}

    @property
    def taken(self) -> bool:
        """Whether a client is connected."""
        return bool(self.clients)

    def sources(self) -> Sequence[Readable]:
        """Return the listener and the clients."""
        return [*self.clients, self.listener]

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Serve the clients, then accept others."""
        for client in [client for client in self.clients if client in ready]:
            self.serve(*self.clients[client], now)
        connection = accepted(self.listener) if self.listener in ready else None
        if connection is None:
            return
        if len(self.clients) >= self._most:
            connection.close()
        else:
            self.clients[connection.socket] = (connection, self._begin())

    @abstractmethod
    def serve(self, connection: Connection, session: Session, now: float) -> None:
        """Process a client's bytes, at ``now`` s."""

    def deliver(self, now: float) -> None:
        """Send what is queued, and forget clients that are gone."""
        for client, (connection, session) in tuple(self.clients.items()):
            connection.send(self.outgoing(session))
            if connection.gone:
                connection.close()
                del self.clients[client]
                self.left(session, now)

    def outgoing(self, session: Session) -> bytearray:
        """Return the queued bytes of a session; sending empties them."""
        return bytearray()

    def left(self, session: Session, now: float) -> None:
        """Act on a client that is gone."""

    def close(self) -> None:
        """Close the door and every client's connection."""
        self.listener.close()
        for connection, _ in self.clients.values():
            connection.close()
        self.clients.clear()


def listen(host: str, port: int) -> socket.socket:
    """Return a listener on an address, port 0 = any free one; raises OSError if that is impossible."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    try:
        if sys.platform == "win32":  # there SO_REUSEADDR would share the port with another program
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        else:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen(8)
        listener.setblocking(False)
    except OSError:
        listener.close()
        raise
    return listener
