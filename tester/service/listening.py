"""Listens for clients: a Unix socket for one user, or loopback TCP for clients with the token."""

from __future__ import annotations

import hmac
import os
import socket
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from http import HTTPStatus
from typing import Any, cast

from websockets.asyncio.server import Server, ServerConnection, serve, unix_serve
from websockets.http11 import Request, Response

from tester.service.address import Address, TcpAddress, UnixAddress, peer_of, unlink_socket
from tester.service.commands import MAX_MESSAGE
from tester.service.gateway import Gateway
from tester.service.manners import counted, sparse_logger

BACKLOG_BYTES = 65_536
"""Bytes that a client may leave unread before the server waits with the next message to it."""
LOG = "tester.gateway"
CLOSE_S = 2.0
"""Time for a client to complete the closing handshake, s."""


class Door:
    """Decides who may connect, before any message is read."""

    def __init__(self, uid: int | None, token: str) -> None:
        """``uid``: the only permitted user on a Unix socket; ``token``: the token required on TCP."""
        self.uid = uid
        self.token = token

    def __call__(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return None to admit the client, else the response that rejects it."""
        if self.token:
            shown = request.headers.get("Authorization", "")
            if not hmac.compare_digest(shown.encode(), f"Bearer {self.token}".encode()):
                return connection.respond(HTTPStatus.UNAUTHORIZED, "a token is needed\n")
            return None
        raw = cast("socket.socket | None", connection.transport.get_extra_info("socket"))
        try:
            uid = peer_of(raw)[1] if raw is not None else None
        except OSError:  # the client has disconnected
            return connection.respond(HTTPStatus.FORBIDDEN, "\n")
        if uid is not None and uid != self.uid:
            return connection.respond(HTTPStatus.FORBIDDEN, "this service belongs to another user\n")
        return None


@asynccontextmanager
async def listening(gateway: Gateway, address: Address, uid: int | None = None) -> AsyncGenerator[Address]:
    """Serve clients at an address until the block ends; yield the address with its port.

    ``uid``: the permitted user on a Unix socket, by default the user of this process.
    """
    if isinstance(address, UnixAddress):
        unlink_socket(address.path)
        before = os.umask(0o177)
        try:
            door = Door(os.getuid() if uid is None else uid, "")
            server = await unix_serve(gateway.serve, str(address.path), process_request=door, **_settings(gateway))
        finally:
            os.umask(before)
        async with server:
            yield address
        unlink_socket(address.path)
        return
    door = Door(None, address.token)
    server = await serve(gateway.serve, address.host, address.port, process_request=door, **_settings(gateway))
    async with server:
        yield TcpAddress(address.host, _port(server), address.token, address.stop_port)


def _settings(gateway: Gateway) -> dict[str, Any]:
    """Return the settings common to both kinds of server."""
    return {
        "origins": [None], "compression": None, "max_size": MAX_MESSAGE, "write_limit": BACKLOG_BYTES,
        "close_timeout": CLOSE_S, "server_header": None, "create_connection": counted(gateway.strangers),
        "logger": sparse_logger(LOG),
    }  # fmt: skip


def _port(server: Server) -> int:
    """Return the port that the system assigned."""
    return int(next(iter(server.sockets)).getsockname()[1])
