"""A client's end of STOP's own lane: a connection that stays open, a line that goes out, a line that comes back.

    with StopCall(None, "script") as call:
        call.stop()

It needs no event loop, and waits for the answer: use a thread where somebody draws.
"""

from __future__ import annotations

import socket
from contextlib import suppress

from tester.base import clock
from tester.base.trouble import in_words
from tester.service.address import Address, AddressError, UnixAddress, default_address, stop_path
from tester.service.stop_door import TAKEN

WITHIN_S = 3.0
"""Without an answer by then STOP was not taken, s."""


AGAIN_S = 0.005
"""Between two tries to get into a full queue before the door, s: the door lets some hundred in a second."""


class NotTakenError(Exception):
    """STOP has not arrived; the message says why."""


class StopCall:
    """Says STOP."""

    def __init__(self, address: Address | None, name: str) -> None:
        """Nothing is connected. ``address``: of the service, None = the user's own; ``name``: who stops, on record."""
        self._address = address
        self.name = name
        self._connection: socket.socket | None = None

    def __enter__(self) -> StopCall:
        """Return itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Hang up."""
        self.close()

    @property
    def open(self) -> bool:
        """The door holds a connection of ours, as far as it is known here."""
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
        """Be connected, for the moment when it counts. Raises NotTakenError."""
        if self._connection is not None:
            return
        try:
            self._connection = _connected(self._address or default_address())
        except (OSError, AddressError) as error:
            raise NotTakenError(in_words(error)) from error

    def stop(self, *, fast: bool = False) -> None:
        """Say STOP and wait until it is in control; a connection that is gone is renewed. Raises NotTakenError."""
        if self._connection is not None:
            with suppress(OSError):
                self._say(self._connection, fast)
                return
            self.close()
        self.connect()
        assert self._connection is not None
        try:
            self._say(self._connection, fast)
        except OSError as error:  # TimeoutError is one
            self.close()
            raise NotTakenError(in_words(error) or "no answer") from error

    def close(self) -> None:
        """Hang up."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _say(self, connection: socket.socket, fast: bool) -> None:
        name = "".join(c for c in self.name if c.isprintable())
        connection.sendall(f"{'fast' if fast else 'stop'} {name}\n".encode())
        end_s = clock.monotonic() + WITHIN_S
        said = b""
        while not said.endswith(TAKEN):
            connection.settimeout(max(end_s - clock.monotonic(), 0.001))
            data = connection.recv(64)
            if not data:
                raise ConnectionError("the service hung up")
            said += data


def takes_stop(address: Address | None) -> bool:
    """Return whether STOP can be said to a service; nothing is said."""
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
            connection.settimeout(WITHIN_S)
            _queue_up(connection, str(stop_path(address.path)))
        except OSError:
            connection.close()
            raise
        return connection
    connection = socket.create_connection((address.host, address.stop_port), timeout=WITHIN_S)
    connection.sendall(address.token.encode() + b"\n")
    return connection


def _queue_up(connection: socket.socket, path: str) -> None:
    """Connect; where the queue before the door is full, which a Unix socket says at once, try again. Raises OSError."""
    end_s = clock.monotonic() + WITHIN_S
    while True:
        try:
            connection.connect(path)
        except BlockingIOError:
            if clock.monotonic() >= end_s:
                raise TimeoutError("too many others are calling") from None
            clock.sleep_until(clock.monotonic() + AGAIN_S)
        else:
            return
