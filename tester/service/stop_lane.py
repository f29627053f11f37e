"""The owner's end of the separate connection for STOP: a thread that only reads from the door's process.

While a rig ticks, the next poll, at most 20 ms later, carries STOP out before every other message of a client, and
answers it. The poll reads the connection itself instead of waiting for the thread's turn. While nothing ticks - during
planning, or while tables are written - the thread answers: the preparing code checks ``wanted`` and begins nothing.
"""

from __future__ import annotations

import select
import socket
import subprocess
from contextlib import suppress
from dataclasses import dataclass
from threading import Lock, Thread

from tester.base import clock
from tester.service.address import Address, TcpAddress, stop_path
from tester.service.child_process import spawn
from tester.service.stop_door import SETTINGS, DoorSettings

AGAIN_S = 1.0
"""Shortest time between two starts of a door, s."""
UP_S = 20.0
"""Time within which a door must report where it listens, s [A]."""
END_S = 2.0


@dataclass(frozen=True, slots=True)
class StopWish:
    """A request to stop the rig. ``number``: the number that the door gave it, 0 once it is answered."""

    name: str
    fast: bool
    number: int


class StopLane:
    """Keeps the process that accepts STOP running, and stores each STOP until it is carried out."""

    def __init__(self) -> None:
        """Open nothing yet."""
        self.ticking = False
        """Whether a rig is under control: then only control's own thread may confirm STOP."""
        self.port = 0
        ours, theirs = socket.socketpair()
        self.bell, self._rope = ours, theirs
        """Two ends of a socket pair. ``bell`` becomes readable when a STOP arrives, which ends a wait."""
        for end in (ours, theirs):
            end.setblocking(False)
        self._lock = Lock()
        self._wishes: list[StopWish] = []
        self._settings: DoorSettings | None = None
        self._link: socket.socket | None = None
        self._received = b""
        self._process: subprocess.Popen[bytes] | None = None
        self._again_s = float("-inf")

    # -- the door ---------------------------------------------------------------------------------------------

    def open(self, address: Address) -> None:
        """Open the door next to a service's address; return once it accepts connections. Raises OSError."""
        if isinstance(address, TcpAddress):
            self._settings = DoorSettings("", address.stop_port, address.token)
        else:
            self._settings = DoorSettings(str(stop_path(address.path)))
        link = self._start(self._settings)
        link.settimeout(UP_S)
        reply = b""
        while not reply.endswith(b"\n"):
            more = link.recv(1)
            if not more:
                raise OSError(f"STOP's door does not open: {stop_path(address.path)}"
                              if not isinstance(address, TcpAddress) else "STOP's door does not open")  # fmt: skip
            reply += more
        self.port = int(reply.split()[1])
        link.settimeout(None)
        self._listen(link)

    def look(self) -> None:
        """Start the door again if its process has ended; never wait."""
        if self._settings is None or self._link is not None or clock.monotonic() < self._again_s:
            return
        self._again_s = clock.monotonic() + AGAIN_S
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            return
        settings = self._settings
        again = DoorSettings(settings.path, self.port, settings.token)
        with suppress(OSError):
            self._listen(self._start(again))

    def close(self) -> None:
        """Close the entrance for STOP and end its process."""
        self._settings = None
        if self._link is not None:
            with suppress(OSError):
                self._link.shutdown(socket.SHUT_RDWR)
        if self._process is not None:
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        self.bell.close()
        self._rope.close()

    def _start(self, settings: DoorSettings) -> socket.socket:
        self._process, link = spawn("tester.service.stop_door", ())
        link.sendall(SETTINGS.dump_json(settings) + b"\n")
        return link

    def _listen(self, link: socket.socket) -> None:
        link.setblocking(False)
        self._link = link
        Thread(target=self._listen_to_door, args=(link,), name="stop lane", daemon=True).start()

    # -- requests ---------------------------------------------------------------------------------------------

    def _listen_to_door(self, link: socket.socket) -> None:
        """Read from the door until it ends; the ticking thread may read a line first."""
        while self._link is link:
            select.select([link], [], [])
            with self._lock:
                self._read()
        link.close()

    def _read(self) -> None:
        """Read the door's lines; call with the lock held."""
        link = self._link
        if link is None:
            return
        try:
            data = link.recv(4096)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._link, self._received = None, b""
            return
        *lines, self._received = (self._received + data).split(b"\n")
        for line in lines:
            self._take(line.decode("utf-8", "replace"))

    def _take(self, line: str) -> None:
        """Store a request; answer it if nothing ticks. Call with the lock held."""
        mark, _, rest = line.partition(" ")
        if mark != "s":
            return  # the port of a door that was started again
        number, kind, name = rest.split(" ", 2)
        request = StopWish(name, kind == "fast", int(number))
        wish = request if self.ticking else StopWish(name, request.fast, 0)
        if not self._wishes or wish.fast > self._wishes[-1].fast or wish.number:
            self._wishes.append(wish)
        if not self.ticking:
            self._answer(request)  # only after the request is stored: the caller may rely on the answer
        with suppress(OSError):  # full: the bell has already rung
            self._rope.send(b"!")

    @property
    def wanted(self) -> bool:
        """Whether a STOP waits to be carried out."""
        return bool(self._wishes)

    def taken(self) -> list[StopWish]:
        """Return the requests to carry out now, oldest first; afterwards call ``answer`` for each."""
        with self._lock:
            self._read()
            wishes, self._wishes = self._wishes, []
        if wishes:
            with suppress(OSError):
                self.bell.recv(4096)
        return wishes

    def answer(self, wish: StopWish) -> None:
        """Confirm that a request has been carried out."""
        if wish.number:
            self._answer(wish)

    def _answer(self, wish: StopWish) -> None:
        link = self._link
        if link is not None:
            with suppress(OSError):
                link.sendall(b"%d\n" % wish.number)

    def begin_ticking(self) -> None:
        """Record that a rig is under control from now on."""
        with self._lock:
            self.ticking = True

    def end_ticking(self) -> None:
        """Record that no rig is under control any more, and answer the waiting callers."""
        with self._lock:
            self.ticking = False
            for wish in self._wishes:
                self.answer(wish)
            self._wishes = [StopWish(wish.name, wish.fast, 0) for wish in self._wishes]
