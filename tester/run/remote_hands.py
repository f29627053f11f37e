"""The hands at a simulated machine in another process: a run's attendant that speaks to the machine's console.

The console is no wire of the machine. What a kind asks of its attendant becomes a line there (``sim.hands``), and the
executor waits for the answer (``tester.machine.executor.Hands``): nothing moves before the work is done.
"""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable, Sequence
from math import nan
from typing import TYPE_CHECKING, Final, Protocol

from drivers.ports import BusLost
from tester.base.trouble import in_words
from tester.inputs.rig import Rig
from tester.inputs.rig.risks import counts_as_simulated
from tester.run.kind_lookup import run_parts
from tester.store.recorder import Recorder

if TYPE_CHECKING:
    from sim.hands import Verb

CONNECT_S: Final = 5.0
"""Time limit for reaching the console, s [A]."""
PATIENCE_S: Final = 5.0
"""Time limit for an answer, s [A]: a console answers within milliseconds."""
_CHUNK: Final = 4096


class ConsoleStream(Protocol):
    """A stream of bytes to a console, which never blocks. Both methods raise OSError if it has ended."""

    def send(self, data: bytes) -> None:
        """Send bytes."""
        ...

    def receive(self) -> bytes:
        """Return the bytes that have arrived, b"" for none."""
        ...

    def close(self) -> None:
        """Close the stream."""
        ...


class SocketStream:
    """A connection to a console over TCP."""

    def __init__(self, place: str) -> None:
        """Connect; ``place``: HOST:PORT. Raises OSError, ValueError."""
        host, port = split_place(place)
        self._socket = socket.create_connection((host, port), timeout=CONNECT_S)
        self._socket.setblocking(False)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def send(self, data: bytes) -> None:
        """Send bytes: a line is shorter than the system's buffer."""
        self._socket.sendall(data)

    def receive(self) -> bytes:
        """Return the bytes that have arrived, b"" for none."""
        try:
            data = self._socket.recv(_CHUNK)
        except (BlockingIOError, InterruptedError):
            return b""
        if not data:
            raise ConnectionResetError("the console has closed the connection")
        return data

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()


class RemoteHands:
    """An attendant whose every method becomes a line at the console; ``failed``: why one was not done, or ""."""

    def __init__(self, channel: ConsoleStream, verbs: Sequence[Verb], place: str, recorder: Recorder) -> None:
        """``verbs``: of the simulated machine; ``place``: the console's address, for people; ``recorder``: gets what
        was done.
        """
        self.failed = ""
        self._channel, self._place, self._recorder = channel, place, recorder
        self._verbs = {verb.method: verb for verb in verbs}
        self._asked: deque[str] = deque()
        """Lines without an answer, oldest first."""
        self._received = b""
        self._since_s = nan

    def __getattr__(self, name: str) -> Callable[..., None]:
        """Return the call that sends the line of this method."""
        if name.startswith("_"):
            raise AttributeError(name)

        def ask(*values: object, **named: object) -> None:
            verb = self._verbs.get(name)
            if verb is None:
                self._fail(f"this kind of machine has no verb for {name}")
            else:
                rest = (named.get(argument.name) for argument in verb.arguments[len(values) :])
                self._send(verb.line(*values, *rest))

        return ask

    def busy(self, now: float) -> bool:
        """Return whether an answer is missing at ``now``, s; record the work that has been done."""
        if not self._asked or self.failed:
            return False
        try:
            self._received += self._channel.receive()
        except OSError as error:
            self._fail(f"{self._asked[0]}: {in_words(error)}")
            return False
        *answers, self._received = self._received.split(b"\n\n")
        for answer in answers:
            self._take(answer.decode("utf-8", "replace"), now)
        if not self._asked or self.failed:
            self._since_s = nan
            return False
        if self._since_s != self._since_s:
            self._since_s = now
        if now - self._since_s > PATIENCE_S:
            self._fail(f"{self._asked[0]}: no answer within {PATIENCE_S:g} s")
            return False
        return True

    def close(self) -> None:
        """Close the connection."""
        self._channel.close()

    def _send(self, line: str) -> None:
        self._asked.append(line)
        try:
            self._channel.send(f"{line}\n".encode())
        except OSError as error:
            self._fail(f"{line}: {in_words(error)}")

    def _take(self, answer: str, now: float) -> None:
        from sim.hands import DONE

        line = self._asked.popleft() if self._asked else "?"
        self._since_s = nan
        if answer.startswith(DONE):
            self._recorder.event(now, "hands", line)
        else:
            self._fail(f"{line}: {answer}")

    def _fail(self, why: str) -> None:
        self.failed = self.failed or f"the hands at {self._place}: {why}"


def remote_hands(place: str, rig: Rig, recorder: Recorder) -> RemoteHands:
    """Return the hands at the console of a simulated machine, connected. Raises BusLost if the console does not answer.
    """
    from sim import machines

    try:
        channel = SocketStream(place)
    except OSError as error:
        raise BusLost(f"no console at {place} (tester sim --control): {in_words(error)}") from error
    return RemoteHands(channel, machines.find(run_parts(rig).plant).verbs, place, recorder)


def split_place(place: str) -> tuple[str, int]:
    """Return host and port of HOST:PORT; raises ValueError."""
    host, colon, port = place.rpartition(":")
    if not (colon and host and port.isascii() and port.isdigit() and 0 < int(port) <= 65535):
        raise ValueError(f"--hands: expected HOST:PORT of a console such as 127.0.0.1:4711, not {place!r}")
    return host, int(port)


def refused_hands(place: str, rig: Rig) -> str:
    """Return why hands are no option for a rig; "" if they are, or if ``place`` is ""."""
    if not place:
        return ""
    if rig.can.interface == "sim":
        return "--hands: this rig is simulated in this process, and does by itself what its prompts ask for"
    if not counts_as_simulated(rig):
        return "--hands: this rig is real, and only a person does what its prompts ask for"
    try:
        split_place(place)
    except ValueError as error:
        return str(error)
    return ""


def unattended(place: str, rig: Rig, *, answered: bool) -> str:
    """Return a warning that prompts are answered (``answered``) and nothing is done at the machine, or ""."""
    if place or not answered or rig.can.interface == "sim" or not counts_as_simulated(rig):
        return ""
    return "warning: --yes answers prompts, and without --hands nothing of what they ask is done at the machine"
