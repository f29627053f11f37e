"""A client's end of the separate connection for STOP. It stays open; each request and each answer is one line.

    with StopCall(None, "script") as call:
        call.stop()

``stop`` needs no event loop and blocks until the answer, so a screen should call it in a thread.
"""

from __future__ import annotations

import socket
import struct
import sys
from contextlib import suppress

from tester.base import clock
from tester.base.trouble import in_words
from tester.service.address import Address, AddressError, UnixAddress, default_address, stop_path

TAKEN = b"taken\n"
"""The door's answer."""
WITHIN_S = 3.0
"""Time without an answer after which STOP has failed, s."""
AGAIN_S = 0.005
"""Time between two attempts to connect while the queue is full, s, on a system where a full queue refuses at once."""


class NotTakenError(Exception):
    """STOP has not arrived; the message gives the reason."""


class StopCall:
    """Sends STOP."""

    def __init__(self, address: Address | None, name: str) -> None:
        """Connect nothing yet.

        ``address``: of the service, None = the user's own; ``name``: the sender of STOP, for the record.
        """
        self._address = address
        self.name = name
        self._connection: socket.socket | None = None

    def __enter__(self) -> StopCall:
        return self

    def __exit__(self, *_: object) -> None:
        """Close the connection."""
        self.close()

    @property
    def open(self) -> bool:
        """Whether the connection to the door is open, as far as this end knows."""
        connection = self._connection
        if connection is None:
            return False
        connection.setblocking(False)
        try:
            gone = not connection.recv(1, socket.MSG_PEEK)
        except BlockingIOError:
            return True
        except OSError:
            gone = True
        if gone:
            self.close()
        return not gone

    def connect(self) -> None:
        """Connect in advance, so that STOP takes no time to connect later. Raises NotTakenError."""
        if self._connection is not None:
            return
        try:
            self._connection = _connected(self._address or default_address())
        except (OSError, AddressError) as error:
            raise NotTakenError(in_words(error)) from error

    def stop(self, *, fast: bool = False) -> None:
        """Send STOP and wait until control has received it; reconnect first if the connection is broken. Raises
        NotTakenError.
        """
        if self._connection is not None:
            with suppress(OSError):
                self._say(self._connection, fast)
                return
            self.close()
        self.connect()
        assert self._connection is not None
        try:
            self._say(self._connection, fast)
        except OSError as error:  # includes TimeoutError
            self.close()
            raise NotTakenError(in_words(error) or "no answer") from error

    def close(self) -> None:
        """Close the connection."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _say(self, connection: socket.socket, fast: bool) -> None:
        name = "".join(c for c in self.name if c.isprintable())
        connection.sendall(f"{'fast' if fast else 'stop'} {name}\n".encode())
        end_s = clock.monotonic() + WITHIN_S
        reply = b""
        while not reply.endswith(TAKEN):
            connection.settimeout(max(end_s - clock.monotonic(), 0.001))
            data = connection.recv(64)
            if not data:
                raise ConnectionError("the service hung up")
            reply += data


def takes_stop(address: Address | None) -> bool:
    """Return whether a service would accept STOP; send none."""
    with StopCall(address, "") as call:
        try:
            call.connect()
        except NotTakenError:
            return False
    return True


def _connected(address: Address) -> socket.socket:
    if isinstance(address, UnixAddress):
        connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            _queue_up(connection, str(stop_path(address.path)))
        except OSError:
            connection.close()
            raise
        return connection
    connection = socket.create_connection((address.host, address.stop_port), timeout=WITHIN_S)
    connection.sendall(address.token.encode() + b"\n")
    return connection


def _queue_up(connection: socket.socket, path: str) -> None:
    """Connect, and wait while the door's queue is full. Raises OSError, TimeoutError."""
    if sys.platform == "linux":
        # The kernel serves blocked callers in turn. A caller that retries later would lose every race.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, struct.pack("@ll", int(WITHIN_S), 0))
    else:
        connection.settimeout(WITHIN_S)
    end_s = clock.monotonic() + WITHIN_S
    while True:
        try:
            connection.connect(path)
        except BlockingIOError:  # the queue is full, or was for the whole time
            if clock.monotonic() >= end_s:
                raise TimeoutError("too many others are calling") from None
            clock.sleep_until(clock.monotonic() + AGAIN_S)
        else:
            return
