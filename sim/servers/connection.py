"""Sockets of the doors: they never block and never raise; a client that is gone is one that cannot be read."""

from __future__ import annotations

import socket
import sys

MOST_UNSENT = 256 * 1024
"""Bytes kept for a client that does not read; beyond them what is new is dropped, as a full adapter does [A]."""
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
        """Return what has arrived, b"" for nothing; ``gone`` is set at the end of the stream."""
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


def listen(host: str, port: int) -> socket.socket:
    """Listen on an address, port 0 = any free one; raises OSError where that cannot be."""
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
