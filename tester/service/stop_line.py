"""A connection for STOP that stays open, served by a thread of its own: pressing takes no time to connect.

The caller's loop may be busy, or hang because its screen is not read: STOP does not wait for it.
"""

from __future__ import annotations

from concurrent.futures import Future
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Thread

from tester.service.address import Address
from tester.service.stop_call import NotTakenError, StopCall

LOOK_S = 1.0
"""Period at which a lost connection is opened again, s."""


class StopLine:
    """Sends STOP from a separate thread."""

    def __init__(self, address: Address | None, name: str) -> None:
        """Connect nothing before ``open`` or ``press``. ``name``: the sender of STOP, for the record."""
        self._call = StopCall(address, name)
        self._pressed: SimpleQueue[tuple[bool, Future[None]] | None] = SimpleQueue()
        self._sent: Future[None] | None = None
        self._thread: Thread | None = None

    def open(self) -> None:
        """Keep the connection open from now on."""
        if self._thread is None:
            self._thread = Thread(target=self._work, name="stop", daemon=True)
            self._thread.start()

    def press(self, *, fast: bool = False) -> None:
        """Send STOP; may be called from any thread."""
        sent: Future[None] = Future()
        self._sent = sent
        self._pressed.put((fast, sent))
        self.open()

    def take(self) -> Future[None] | None:
        """Return the result of the newest press (or its exception, NotTakenError), only once; None if there was no
        press.
        """
        sent, self._sent = self._sent, None
        return sent

    def close(self) -> None:
        """Close the connection."""
        if self._thread is not None:
            self._pressed.put(None)
            self._thread = None

    def _work(self) -> None:
        while True:
            try:
                pressed = self._pressed.get(timeout=LOOK_S)
            except Empty:
                if not self._call.open:
                    with suppress(NotTakenError):
                        self._call.connect()
                continue
            if pressed is None:
                self._call.close()
                return
            fast, sent = pressed
            try:
                self._call.stop(fast=fast)
            except NotTakenError as error:
                sent.set_exception(error)
            else:
                sent.set_result(None)
