"""A TCP connection as a line that carries Modbus."""

from __future__ import annotations

import socket

from drivers.ports import BusLost, WatchedLine

_CHUNK = 4096
"""Bytes fetched at once: a Modbus TCP frame has at most 260."""


class TcpLine(WatchedLine):
    """A port (``drivers.ports.LinePort``) over a connected socket. Nothing blocks: the kernel keeps what arrives.

    Bytes are stamped with the time they are fetched at, which is no earlier than they arrived.
    """

    def __init__(self, connection: socket.socket, peer: str) -> None:
        """Take a connected socket; ``peer`` names it in messages."""
        super().__init__()
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connection
        self._peer = peer
        self._unsent = b""

    def write(self, data: bytes, now: float) -> None:
        """Send bytes; what the kernel does not take now goes with the next call. Raises BusLost."""
        self._unsent += data
        self._send()
        if self.watchers:
            self.tell(now, data, True)

    def _send(self) -> None:
        try:
            sent = self._socket.send(self._unsent) if self._unsent else 0
        except (BlockingIOError, InterruptedError):
            return
        except OSError as error:
            raise BusLost(f"{self._peer}: {error}") from error
        self._unsent = self._unsent[sent:]

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return what has arrived, stamped ``now`` (s). Raises BusLost, also when the peer closed the connection."""
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
