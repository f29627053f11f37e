"""Plans a recipe in a process of its own, so that the owner keeps serving its clients and STOP can end the planning.

``python -m tester.service.planning LINK``: the first line from the link is a ``Task``. The answer is a series of
pickles from one pickler, each preceded by its length: the plan's steps in small pieces, then the object that refers to
them. Reading a piece therefore never occupies the owner for long, however many conditions there are.
"""

from __future__ import annotations

import gc
import io
import pickle
import select
import socket
import struct
from collections.abc import Callable
from dataclasses import dataclass

from pydantic import TypeAdapter

from recipes import UnknownRecipe
from tester.base.source import InvalidSource
from tester.run.endings import CannotStartError
from tester.run.preconditions import Prepared, prepared
from tester.service.child_process import link_to_owner, spawn

STEPS_AT_ONCE = 200
"""Number of steps in a piece, which takes some milliseconds of the owner's time."""
LOOK_S = 0.02
"""Period at which the owner serves its clients during planning, s, as between two ticks."""
NICE = 5
"""Lower priority: other rigs on this machine come first."""
LENGTH = struct.Struct("<I")


@dataclass(frozen=True, slots=True)
class Task:
    """A recipe to plan, with the options of the command line."""

    recipe: str
    rig: str
    overrides: tuple[str, ...] = ()
    accept_risk: str = ""


TASK: TypeAdapter[Task] = TypeAdapter(Task)


def planned(task: Task, meanwhile: Callable[[], str]) -> Prepared:
    """Return a recipe planned for a rig. Raises CannotStartError if the recipe or rig is wrong.

    ``meanwhile`` is called every ``LOOK_S`` and returns why planning must end, "" if it may continue.
    """
    process, link = spawn("tester.service.planning", ())
    try:
        with link, _collector_off():
            link.sendall(TASK.dump_json(task) + b"\n")
            return _received(link, meanwhile)
    finally:
        process.kill()
        process.wait()


class _collector_off:  # noqa: N801 - reads as a statement
    """Turns the garbage collector off. Planning makes millions of objects and drops none, so a collection would only
    delay STOP, by up to a second.
    """

    def __enter__(self) -> None:
        """Stop automatic collection."""
        gc.disable()

    def __exit__(self, *_: object) -> None:
        """Exclude the new objects from later collections, and resume collection."""
        gc.freeze()
        gc.enable()


def _received(link: socket.socket, meanwhile: Callable[[], str]) -> Prepared:
    link.setblocking(False)
    pieces = _Pieces()
    unpickler = pickle.Unpickler(pieces)  # noqa: S301 - from our own child, over a pair of sockets
    received = bytearray()
    while True:
        why = meanwhile()
        if why:
            raise CannotStartError(why)
        if not select.select([link], [], [], LOOK_S)[0]:
            continue
        data = link.recv(1 << 20)
        if not data:
            raise CannotStartError("the recipe's planning has broken off")
        received += data
        while (piece := _piece(received)) is not None:
            pieces.feed(piece)
            item: object = unpickler.load()
            if isinstance(item, Prepared):
                return item
            if isinstance(item, str):
                raise CannotStartError(item)
            why = meanwhile()
            if why:
                raise CannotStartError(why)


def _piece(received: bytearray) -> bytes | None:
    """Remove the next pickle from the received bytes and return it; None while it is incomplete."""
    if len(received) < LENGTH.size:
        return None
    (length,) = LENGTH.unpack_from(received)
    end = LENGTH.size + int(length)
    if len(received) < end:
        return None
    piece = bytes(received[LENGTH.size : end])
    del received[:end]
    return piece


class _Pieces:
    """A file object over pieces that arrive one at a time."""

    def __init__(self) -> None:
        """Begin empty."""
        self._piece = io.BytesIO()

    def feed(self, piece: bytes) -> None:
        """Set the piece to be read next."""
        self._piece = io.BytesIO(piece)

    def read(self, count: int = -1, /) -> bytes:
        """Return up to ``count`` bytes, as a file does."""
        return self._piece.read(count)

    def readline(self) -> bytes:
        """Return a line, as a file does."""
        return self._piece.readline()


# -- the process -------------------------------------------------------------------------------------------------------


def plan_for(link: socket.socket) -> None:
    """Plan the recipe for the owner at the other end of ``link``, and send the result."""
    with link.makefile("rb", buffering=0) as stream:
        task = TASK.validate_json(stream.readline())
    buffer = io.BytesIO()
    pickler = pickle.Pickler(buffer, pickle.HIGHEST_PROTOCOL)

    def send(what: object) -> None:
        pickler.dump(what)
        piece = buffer.getvalue()
        buffer.seek(0)
        buffer.truncate()
        link.sendall(LENGTH.pack(len(piece)) + piece)

    gc.disable()
    try:
        plan = prepared(task.recipe, task.rig, task.overrides, task.accept_risk)
    except (InvalidSource, UnknownRecipe, CannotStartError, OSError) as error:
        send(str(error) or type(error).__name__)
        return
    for pieces in (plan.work.plan.steps, plan.expected.steps):
        for first in range(0, len(pieces), STEPS_AT_ONCE):
            send(list(pieces[first : first + STEPS_AT_ONCE]))
    send(plan)


if __name__ == "__main__":
    plan_for(link_to_owner(NICE))
