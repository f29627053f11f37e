"""Doors for commands: lines of text in, lines of text out, over TCP or on this process's own terminal."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Callable, Collection, Sequence
from math import inf

from sim.servers.connection import ClientsDoor, Connection
from sim.servers.doors import Place, Readable
from sim.servers.tcp_doors import address_of

LONGEST_LINE = 1024
"""Greatest length of a command, characters; a longer line does not come from a person."""
MOST_CLIENTS = 4

Command = Callable[[str, float], Sequence[str]]
"""Carries out a line at a time (s of the rig), and returns the lines of its answer."""


class TextLines:
    """Splits received bytes into lines."""

    def __init__(self) -> None:
        """Begin with an empty line."""
        self._buffer = b""

    def feed(self, data: bytes) -> list[str]:
        """Return the complete lines."""
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        self._buffer = self._buffer[-LONGEST_LINE:]
        return [line[-LONGEST_LINE:].decode("utf-8", errors="replace").strip() for line in lines]


class CommandDoor(ClientsDoor[TextLines]):
    """Commands over TCP on loopback: one in each line; an empty line ends the answer."""

    due_s = inf

    def __init__(self, listener: socket.socket, command: Command) -> None:
        """Wait for clients."""
        super().__init__(listener, MOST_CLIENTS, TextLines)
        self._command = command

    @property
    def place(self) -> Place:
        """Its address: host:port."""
        return Place("commands", address_of(self.listener))

    def serve(self, connection: Connection, session: TextLines, now: float) -> None:
        for line in session.feed(connection.receive()):
            answer = "".join(f"{text}\n" for text in self._command(line, now))
            connection.send(bytearray(f"{answer}\n".encode()))


class StandardInput:
    """Commands typed at this process.

    A terminal is read only while this process is in its foreground: a read from the background would stop it. Windows
    cannot wait for a console: there ``sources`` is empty, and commands go over TCP.
    """

    due_s = inf
    taken = False
    place = Place("commands", "standard input")

    def __init__(self, command: Command, say: Callable[[str], None]) -> None:
        """Read from the process's standard input; ``say`` prints an answer."""
        self._command = command
        self._say = say
        self._lines = TextLines()
        self._open = sys.platform != "win32" and sys.stdin is not None and not sys.stdin.closed

    def sources(self) -> Sequence[Readable]:
        """Return standard input while it may be read."""
        return [sys.stdin] if self._open and _in_foreground(sys.stdin.fileno()) else []

    def read(self, ready: Collection[Readable], now: float) -> None:
        """Carry out the typed commands."""
        if not self._open or sys.stdin not in ready:
            return
        try:
            data = os.read(sys.stdin.fileno(), LONGEST_LINE)
        except OSError:
            data = b""
        self._open = bool(data)  # at its end the rig continues without commands
        for line in self._lines.feed(data):
            for text in self._command(line, now):
                self._say(text)

    def deliver(self, now: float) -> None:
        """Do nothing: answers are printed at once."""

    def close(self) -> None:
        """Leave standard input as it is."""
        self._open = False


def _in_foreground(descriptor: int) -> bool:
    if sys.platform == "win32":
        return False
    if not os.isatty(descriptor):
        return True
    try:
        return os.tcgetpgrp(descriptor) == os.getpgrp()
    except OSError:
        return False
