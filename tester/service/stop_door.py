"""The door for STOP, ``python -m tester.service.stop_door LINK``: a process that accepts only STOP.

The gateway handles clients' messages, their limits and queues; STOP bypasses all of them. Request and answer are lines:

    stop NAME      a controlled stop           -> taken
    fast NAME      a fast stop                 -> taken

On TCP the first line is the token. The door sends the owner a single line for all waiting callers (``s NUMBER fast|stop
NAME``), and the next line only after the answer (``NUMBER``). The owner therefore never has more than one request to
read, however many clients call.
"""

from __future__ import annotations

import hmac
import os
import selectors
import socket
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import TypeAdapter

from tester.base import clock
from tester.base.processes import BELOW_SCANS, RealTimePriority
from tester.service.address import peer_of, peer_text, unlink_socket, with_peer
from tester.service.child_process import link_to_owner
from tester.service.stop_call import TAKEN

MOST_CALLERS = 256
"""Greatest number of connections at a time. Above it, the oldest connection of the process with the most connections is
closed.
"""
WORK_S = 0.002
"""Longest CPU time for which the door accepts new connections before it handles the existing ones, s."""
PAUSE_SHARE = 4.0
"""Length of the pause after each turn, as a multiple of the turn's CPU time: no flood makes the door use more than a
fifth of a core, so real-time priority is safe. Not a multiple of the time that passed: a turn during which the system
ran other processes for 80 ms would add 320 ms to the STOPs that wait.
"""
LONGEST = 512
"""Upper limit of a line's length, bytes."""
NAME_LENGTH, NAMES_LENGTH = 100, 400
"""Greatest length of a caller's name, and of the list of names in a line, characters."""
BACKLOG = 64
"""Length of the listening queue: the door accepts all of it at a time, so no caller in it waits longer than a pause."""


@dataclass(frozen=True, slots=True)
class DoorSettings:
    """The owner's settings for its door: the socket's path, or a port (0: any) and the token."""

    path: str
    port: int = 0
    token: str = ""


SETTINGS: TypeAdapter[DoorSettings] = TypeAdapter(DoorSettings)


@dataclass(slots=True, eq=False)
class Caller:
    """One connection. ``admitted``: whether it has sent the token, or needs none."""

    connection: socket.socket
    process: int
    admitted: bool
    received: bytes = b""


@dataclass(slots=True)
class Wish:
    """The combined request of all waiting callers: their names as far as they fit; fast if any of them requests a fast
    stop.
    """

    name: str
    fast: bool
    callers: list[Caller] = field(default_factory=list[Caller])

    def join(self, name: str, fast: bool) -> None:
        """Add a caller's request."""
        self.fast = self.fast or fast
        if len(self.name) + len(name) < NAMES_LENGTH and name not in self.name.split(", "):
            self.name += f", {name}"


class StopDoor:
    """Accepts STOP from callers and forwards it to the owner, one line at a time."""

    def __init__(self, listener: socket.socket, owner: socket.socket, *, uid: int | None, token: str = "") -> None:
        """``uid``: the only permitted user on a Unix socket; ``token``: the token required on TCP."""
        self.uid, self.token = uid, token
        self.owner = owner
        self.callers: dict[Caller, None] = {}
        """The connections, oldest first."""
        self.ended = False
        self._listener = listener
        self._selector = selectors.DefaultSelector()
        for end in (listener, owner):
            end.setblocking(False)
            self._selector.register(end, selectors.EVENT_READ)
        self._number = os.getpid() << 16  # each process of the door has its own range of numbers
        self._asked: Wish | None = None
        self._next: Wish | None = None
        self._answers = b""

    def serve(self) -> None:
        """Serve until the owner ends."""
        while not self.ended:
            used_s = self.turn(None)
            clock.sleep_until(clock.monotonic() + PAUSE_SHARE * used_s)

    def turn(self, within_s: float | None) -> float:
        """Wait for input and handle it: the owner first, then callers, then new ones. Return the CPU time, s."""
        began_s = clock.cpu_time()
        ready = {id(key.fileobj): key.data for key, _ in self._selector.select(within_s)}
        if id(self.owner) in ready:
            self._receive_answers()
        for caller in ready.values():
            if isinstance(caller, Caller) and caller in self.callers:
                self._receive(caller)
        if id(self._listener) in ready:
            self._admit()
        return clock.cpu_time() - began_s

    # -- callers ----------------------------------------------------------------------------------------------

    def _admit(self) -> None:
        end_s = clock.cpu_time() + WORK_S
        while clock.cpu_time() < end_s:
            try:
                connection, _ = self._listener.accept()
            except OSError:  # the queue is empty, or the caller has disconnected
                break
            self._welcome(connection)

    def _welcome(self, connection: socket.socket) -> None:
        process, uid = peer_of(connection)
        if not self.token and uid is not None and uid != self.uid:
            connection.close()
            return
        connection.setblocking(False)
        caller = Caller(connection, process, not self.token)
        self.callers[caller] = None
        # Nearly always its first line is already here. A flood's connections have already ended: they cost little.
        self._receive(caller)
        if caller in self.callers:
            self._selector.register(connection, selectors.EVENT_READ, caller)
            if len(self.callers) > MOST_CALLERS:
                self._make_room()

    def _make_room(self) -> None:
        """Close the oldest connection of the process that has the most connections."""
        count: dict[int, int] = {}
        for caller in self.callers:
            count[caller.process] = count.get(caller.process, 0) + 1
        most = max(count, key=lambda process: count[process])
        self._let_go(next(caller for caller in self.callers if caller.process == most))

    def _let_go(self, caller: Caller) -> None:
        del self.callers[caller]
        with suppress(KeyError):  # its first line was its last: it was never registered
            self._selector.unregister(caller.connection)
        caller.connection.close()

    def _receive(self, caller: Caller) -> None:
        try:
            data = caller.connection.recv(LONGEST)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        caller.received += data
        *lines, caller.received = caller.received.split(b"\n")
        for line in lines:
            if not self._understand(caller, line):
                data = b""
        if not data or len(caller.received) > LONGEST:
            self._let_go(caller)

    def _understand(self, caller: Caller, line: bytes) -> bool:
        """Handle one line; return False if the caller should be disconnected."""
        if not caller.admitted:
            caller.admitted = hmac.compare_digest(line, self.token.encode())
            return caller.admitted
        word, _, name = line.decode("utf-8", "replace").partition(" ")
        if word not in ("stop", "fast"):
            return False
        plain = "".join(c for c in name if c.isprintable())[:NAME_LENGTH] or "a client"
        self._want(caller, word == "fast", with_peer(plain, peer_text(caller.connection)))
        return True

    # -- the owner --------------------------------------------------------------------------------------------

    def _want(self, caller: Caller, fast: bool, name: str) -> None:
        if self._next is None:
            self._next = Wish(name, fast)
        else:
            self._next.join(name, fast)
        if caller not in self._next.callers:
            self._next.callers.append(caller)
        self._ask()

    def _ask(self) -> None:
        if self._asked is not None or self._next is None:
            return
        self._asked, self._next = self._next, None
        self._number += 1
        kind = "fast" if self._asked.fast else "stop"
        line = f"s {self._number} {kind} {self._asked.name}\n".encode()
        try:
            self.owner.sendall(line)  # at most one line is unanswered, so it always fits
        except OSError:
            self.ended = True

    def _receive_answers(self) -> None:
        try:
            data = self.owner.recv(4096)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self.ended = True
            return
        *answers, self._answers = (self._answers + data).split(b"\n")
        if self._asked is not None and str(self._number).encode() in answers:
            for caller in self._asked.callers:
                self._answer(caller)
            self._asked = None
            self._ask()

    def _answer(self, caller: Caller) -> None:
        if caller not in self.callers:
            return  # it has disconnected, but its STOP was accepted
        try:
            caller.connection.sendall(TAKEN)
        except OSError:  # the caller does not read
            self._let_go(caller)


def open_listener(settings: DoorSettings) -> socket.socket:
    """Return a listening socket: a Unix socket of mode 0600, or loopback TCP. Raises OSError, AddressError."""
    if settings.token:
        return socket.create_server(("127.0.0.1", settings.port), backlog=BACKLOG)
    path = Path(settings.path)
    unlink_socket(path)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    before = os.umask(0o177)
    try:
        listener.bind(str(path))
    finally:
        os.umask(before)
    listener.listen(BACKLOG)
    return listener


def main(link: socket.socket) -> None:
    """Serve the owner at the other end of ``link``.

    The owner sends the settings first; the door answers with its port (0: none).
    """
    with link.makefile("rb", buffering=0) as stream:  # unbuffered: the door itself reads the rest
        settings = SETTINGS.validate_json(stream.readline())
    listener = open_listener(settings)
    port = int(listener.getsockname()[1]) if settings.token else 0
    link.sendall(b"p %d\n" % port)
    RealTimePriority(BELOW_SCANS)  # where it is not granted, the door runs as it is
    StopDoor(listener, link, uid=None if settings.token else os.getuid(), token=settings.token).serve()
    if not settings.token:
        with suppress(OSError):
            unlink_socket(Path(settings.path))


if __name__ == "__main__":
    main(link_to_owner())
