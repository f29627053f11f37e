"""What python-can's socketcand client leaves to its user: the address, sending at once, and the end of the stream.

Measured with python-can 4.6.1: without a listener it tries for ten seconds without a pause, and without a greeting
it waits for ever; its small frames wait for each other (Nagle's algorithm) unless ``tcp_tune`` is set, which Windows
does not have; and where the server closed the connection, ``recv`` returns None for ever, without waiting. The latter
two are set right at the client's socket, which it does not give out: a client that keeps it elsewhere one day is used
as it is, and what ends such a connection is then the loss of the drives' heartbeats.
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
"""A server that has not answered by then is not there, s."""
_GREETING = b"< hi >"
_SOCKET = "_SocketCanDaemonBus__socket"

# Without a handler of its own the library's remarks would go to stderr; what they are about ends in BusLost.
logging.getLogger("can.interfaces.socketcand").addHandler(logging.NullHandler())


def settings_of(channel: str) -> dict[str, str | int]:
    """Return what the client wants to know, from ``bus@host:port``.

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
    """Let every frame of a socketcand client leave at once; other buses stay as they are."""
    connection = _socket_of(bus)
    if connection is not None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)


def ended(bus: can.BusABC) -> bool:
    """Return whether a socketcand client's server has closed the connection.

    For the thread that receives, when nothing was received: it looks at the next byte and takes none.
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
