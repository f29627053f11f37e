"""Additions to python-can's socketcand client: the address, sending at once, and the end of the stream.

Measured with python-can 4.6.1: without a listener the client tries for ten seconds without a pause, and without a
greeting it waits for ever. Its small frames wait for each other (Nagle's algorithm) unless ``tcp_tune`` is set, which
Windows does not have. After the server closed the connection, ``recv`` returns None for ever, without waiting. The
last two are corrected at the client's socket, which is not a public attribute. A client that keeps it elsewhere one day
is used as it is; the loss of the drives' heartbeats then ends such a connection.
"""

from __future__ import annotations

import logging
import select
import socket
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import can

INTERFACE = "socketcand"
CONNECT_S = 3.0
"""Longest wait for a server's answer, s."""
_GREETING = b"< hi >"
_SOCKET = "_SocketCanDaemonBus__socket"

# Without this handler the library's messages would go to stderr; their causes end in BusLost.
logging.getLogger("can.interfaces.socketcand").addHandler(logging.NullHandler())


def settings_of(channel: str) -> dict[str, str | int]:
    """Return the client's arguments from ``bus@host:port``.

    Raises ValueError for another text, and OSError without a greeting in time: the client itself would wait for ever.
    """
    bus, at, address = channel.rpartition("@")
    host, colon, port = address.rpartition(":")
    if not (bus and at and host and colon and port.isdecimal()):
        raise ValueError("expected bus@host:port, for example can0@127.0.0.1:29536")
    _be_greeted(host, int(port))
    return {"channel": bus, "host": host, "port": int(port)}


def _be_greeted(host: str, port: int) -> None:
    with socket.create_connection((host, port), CONNECT_S) as connection:
        greeting = connection.recv(256)
    if greeting != _GREETING:
        shown = greeting.decode("ascii", errors="replace")[:80] or "nothing"
        raise OSError(f"expected {_GREETING.decode()}, got {shown}")


def tune(bus: can.BusABC) -> None:
    """Make a socketcand client send every frame at once; other buses stay as they are."""
    connection = _socket_of(bus)
    if connection is not None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def ended(bus: can.BusABC) -> bool:
    """Return whether a socketcand client's server has closed the connection.

    For the receive thread, after a call without a frame: it looks at the next byte and does not consume it.
    """
    connection = _socket_of(bus)
    if connection is None:
        return False
    try:
        readable, _, _ = select.select([connection], (), (), 0.0)
        return bool(readable) and not connection.recv(1, socket.MSG_PEEK)
    except OSError:
        return True


def _socket_of(bus: can.BusABC) -> socket.socket | None:
    found = getattr(bus, _SOCKET, None)
    return found if isinstance(found, socket.socket) else None
