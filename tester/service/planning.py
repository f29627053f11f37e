"""A recipe is planned by a process of its own: the owner goes on hearing its clients, and a STOP ends the planning.

``python -m tester.service.planning LINK``: the link's first line is a ``Task``; back come pickles, each behind its
length, of one pickler: the plan's steps in small pieces, then what refers to them. So no piece keeps the owner for
long, however many conditions there are.
"""

from __future__ import annotations

import gc
import io
import os
import pickle
import select
import signal
import socket
import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass

from pydantic import TypeAdapter

from recipes import UnknownRecipe
from tester.base.source import InvalidSource
from tester.run.endings import CannotStartError
from tester.run.preparing import Prepared, prepared
from tester.service.child_socket import link_of, spawn

STEPS_AT_ONCE = 200
"""Steps of one piece: some milliseconds of the owner's time."""
LOOK_S = 0.02
"""The owner looks after its clients this often, s, as between two ticks."""
NICE = 5
"""Other rigs of this machine come first."""
LENGTH = struct.Struct("<I")


@dataclass(frozen=True, slots=True)
class Task:
    """What is to be planned, as the command line has it."""

    recipe: str
    rig: str
    overrides: tuple[str, ...] = ()
    accept_risk: str = ""


TASK: TypeAdapter[Task] = TypeAdapter(Task)


def planned(task: Task, meanwhile: Callable[[], str]) -> Prepared:
    """Return what a recipe is on a rig. Raises CannotStartError for what is wrong with it.

    ``meanwhile`` is called every ``LOOK_S``; it returns why the planning is to end, "" to go on.
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
    """Millions of objects come, none goes: looking for garbage among them would keep STOP waiting for a second."""

    def __enter__(self) -> None:
        """Stop automatic collection."""
        gc.disable()

    def __exit__(self, *_: object) -> None:
        """Leave what has come out of every later collection."""
        gc.freeze()
        gc.enable()


def _received(link: socket.socket, meanwhile: Callable[[], str]) -> Prepared:
    link.setblocking(False)
    pieces = _Pieces()
    unpickler = pickle.Unpickler(pieces)  # noqa: S301 - from our own child, over a pair of sockets
    heard = bytearray()
    while True:
        why = meanwhile()
        if why:
            raise CannotStartError(why)
        if not select.select([link], [], [], LOOK_S)[0]:
            continue
        data = link.recv(1 << 20)
        if not data:
            raise CannotStartError("the recipe's planning has broken off")
        heard += data
        while (piece := _piece(heard)) is not None:
            pieces.feed(piece)
            found: object = unpickler.load()
            if isinstance(found, Prepared):
                return found
            if isinstance(found, str):
                raise CannotStartError(found)
            why = meanwhile()
            if why:
                raise CannotStartError(why)


def _piece(heard: bytearray) -> bytes | None:
    """Take the next pickle from what was heard; None while it is not whole."""
    if len(heard) < LENGTH.size:
        return None
    (length,) = LENGTH.unpack_from(heard)
    end = LENGTH.size + int(length)
    if len(heard) < end:
        return None
    piece = bytes(heard[LENGTH.size : end])
    del heard[:end]
    return piece


class _Pieces:
    """A file whose content comes piece by piece."""

    def __init__(self) -> None:
        """Empty."""
        self._piece = io.BytesIO()

    def feed(self, piece: bytes) -> None:
        """Go on with this."""
        self._piece = io.BytesIO(piece)

    def read(self, count: int = -1, /) -> bytes:
        """Read as files do."""
        return self._piece.read(count)

    def readline(self) -> bytes:
        """Read as files do."""
        return self._piece.readline()


# -- the process -------------------------------------------------------------------------------------------------------


def plan_for(link: socket.socket) -> None:
    """Plan what the owner at the other end of ``link`` wants, and send it."""
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
        found = prepared(task.recipe, task.rig, task.overrides, task.accept_risk)
    except (InvalidSource, UnknownRecipe, CannotStartError, OSError) as error:
        send(str(error) or type(error).__name__)
        return
    for pieces in (found.work.plan.steps, found.expected.steps):
        for first in range(0, len(pieces), STEPS_AT_ONCE):
            send(list(pieces[first : first + STEPS_AT_ONCE]))
    send(found)


if __name__ == "__main__":
    for _number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(_number, signal.SIG_IGN)  # its owner ends it
    if hasattr(os, "nice"):
        os.nice(NICE)
    plan_for(link_of(sys.argv[1]))
