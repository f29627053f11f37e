"""The owner's end of STOP's own lane: what the door's process says is heard by a thread that does nothing else.

While something ticks, the next poll, 20 ms away at most, carries out what is there before anything else a client has
said, and answers; it looks itself, so that it need not wait for the thread's turn. While nothing ticks - a recipe is
being planned, tables are written - the thread answers: what is being prepared does not begin any more, which whoever
prepares it asks (``wanted``).
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
from tester.service.child_socket import spawn
from tester.service.stop_door import SETTINGS, DoorSettings

AGAIN_S = 1.0
"""A door is started anew at most this often, s."""
UP_S = 20.0
"""A door has said where it listens by then, s [A]."""
END_S = 2.0


@dataclass(frozen=True, slots=True)
class StopWish:
    """Somebody wants the rig to stop. ``number``: the door's, 0 once it is answered."""

    name: str
    fast: bool
    number: int


class StopLane:
    """Keeps the door open, and what came through it until it is carried out."""

    def __init__(self) -> None:
        """Nothing is open."""
        self.ticking = False
        """A rig is under control: only control's own thread may say that STOP was taken."""
        self.restarts = 0
        self.port = 0
        ours, theirs = socket.socketpair()
        self.bell, self._rope = ours, theirs
        """Readable once STOP is there: ends a wait."""
        for one in (ours, theirs):
            one.setblocking(False)
        self._lock = Lock()
        self._wishes: list[StopWish] = []
        self._settings: DoorSettings | None = None
        self._link: socket.socket | None = None
        self._said = b""
        self._process: subprocess.Popen[bytes] | None = None
        self._again_s = float("-inf")

    # -- the door ---------------------------------------------------------------------------------------------

    def open(self, address: Address) -> None:
        """Open the door beside a service's address; returns once it is open. Raises OSError."""
        if isinstance(address, TcpAddress):
            self._settings = DoorSettings("", address.stop_port, address.token)
        else:
            self._settings = DoorSettings(str(stop_path(address.path)))
        link = self._start(self._settings)
        link.settimeout(UP_S)
        said = b""
        while not said.endswith(b"\n"):
            more = link.recv(1)
            if not more:
                raise OSError(f"STOP's door does not open: {stop_path(address.path)}"
                              if not isinstance(address, TcpAddress) else "STOP's door does not open")  # fmt: skip
            said += more
        self.port = int(said.split()[1])
        link.settimeout(None)
        self._listen(link)

    def look(self) -> None:
        """Open the door again where its process is gone; never waits."""
        if self._settings is None or self._link is not None or clock.monotonic() < self._again_s:
            return
        self._again_s = clock.monotonic() + AGAIN_S
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            return
        self.restarts += 1
        settings = self._settings
        again = DoorSettings(settings.path, self.port, settings.token)
        with suppress(OSError):
            self._listen(self._start(again))

    def close(self) -> None:
        """Close the door."""
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
        Thread(target=self._hear, args=(link,), name="stop lane", daemon=True).start()

    # -- what is heard ----------------------------------------------------------------------------------------

    def _hear(self, link: socket.socket) -> None:
        """Hear the door until it is gone; whoever ticks may have been quicker."""
        while self._link is link:
            select.select([link], [], [])
            with self._lock:
                self._read()
        link.close()

    def _read(self) -> None:
        """Take in what the door has said (locked)."""
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
            self._link, self._said = None, b""
            return
        *lines, self._said = (self._said + data).split(b"\n")
        for line in lines:
            self._take(line.decode("utf-8", "replace"))

    def _take(self, line: str) -> None:
        """Keep a wish; answer it where nothing ticks (locked)."""
        mark, _, rest = line.partition(" ")
        if mark != "s":
            return  # the port of a door that was opened again
        number, kind, name = rest.split(" ", 2)
        heard = StopWish(name, kind == "fast", int(number))
        wish = heard if self.ticking else StopWish(name, heard.fast, 0)
        if not self._wishes or wish.fast > self._wishes[-1].fast or wish.number:
            self._wishes.append(wish)
        if not self.ticking:
            self._answer(heard)  # only now: whoever hears the answer may rely on it
        with suppress(OSError):  # full: it has been rung already
            self._rope.send(b"!")

    @property
    def wanted(self) -> bool:
        """A STOP is there that has not been carried out yet."""
        return bool(self._wishes)

    def taken(self) -> list[StopWish]:
        """Return the wishes that are to be carried out now, oldest first; ``answer`` each afterwards."""
        with self._lock:
            self._read()
            wishes, self._wishes = self._wishes, []
        if wishes:
            with suppress(OSError):
                self.bell.recv(4096)
        return wishes

    def answer(self, wish: StopWish) -> None:
        """Say that a wish was carried out."""
        if wish.number:
            self._answer(wish)

    def _answer(self, wish: StopWish) -> None:
        link = self._link
        if link is not None:
            with suppress(OSError):
                link.sendall(b"%d\n" % wish.number)

    def begin_ticking(self) -> None:
        """From now on a rig is under control."""
        with self._lock:
            self.ticking = True

    def end_ticking(self) -> None:
        """No rig is under control any more: whoever waits is answered."""
        with self._lock:
            self.ticking = False
            for wish in self._wishes:
                self.answer(wish)
            self._wishes = [StopWish(wish.name, wish.fast, 0) for wish in self._wishes]
