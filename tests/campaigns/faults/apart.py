"""Work on a stage that leaves it unchanged: in a fork of this process, or on a copy where forks are unavailable.

A fork also duplicates what cannot be copied, such as a conversation with a drive and compiled classes, so the campaign
also runs on a compiled installation.
"""

from __future__ import annotations

import os
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from multiprocessing.connection import Connection
from traceback import format_exc
from typing import Generic, TypeVar

Order = TypeVar("Order")
Result = TypeVar("Result")
FORKS = hasattr(os, "fork")


class ApartError(Exception):
    """The work failed in its fork; the message is its traceback."""


def apart(work: Callable[[], Result]) -> Result:
    """Return what ``work`` returns, done in a fork. Raises ApartError."""
    ours, theirs = Pipe(duplex=False)
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        try:
            payload = pickle.dumps((True, work()))
        except BaseException:  # noqa: BLE001 - reported to the parent
            payload = pickle.dumps((False, format_exc()))
        theirs.send_bytes(payload)
        os._exit(0)
    theirs.close()
    try:
        well, result = pickle.loads(ours.recv_bytes())  # noqa: S301 - our own child's
    except EOFError:
        raise ApartError("it ended without a result") from None
    finally:
        ours.close()
        os.waitpid(child, 0)
    if not well:
        raise ApartError(result)
    return result


class Post(Generic[Order, Result]):
    """A permanent fork: it executes each order in a fork of its own, from the state in which it was made.

    Ends with its parent process.
    """

    def __init__(self, work: Callable[[Order], Result]) -> None:
        """Fork here."""
        self._ours, theirs = Pipe()
        sys.stdout.flush()
        if os.fork() == 0:
            self._ours.close()
            with suppress(EOFError, OSError):
                _serve(theirs, work)
            os._exit(0)
        theirs.close()

    def do(self, order: Order) -> Result:
        """Return the result of the work for an order. Raises ApartError."""
        self._ours.send(order)
        well, result = self._ours.recv()
        if not well:
            raise ApartError(result)
        return result


def _serve(link: Connection, work: Callable[[Order], Result]) -> None:
    while True:
        order: Order = link.recv()
        try:
            link.send((True, apart(lambda order=order: work(order))))
        except ApartError as error:
            link.send((False, str(error)))
