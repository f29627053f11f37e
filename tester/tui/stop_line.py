"""STOP's own way to the service: taken where the terminal is read, in a thread of its own, past the screen's loop.

A screen that is drawing, or that stands still because nobody reads its terminal, does not keep STOP waiting. The
connection to the service's lane for STOP is kept open, so that nothing has to be opened when it counts.
"""

from __future__ import annotations

from concurrent.futures import Future
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Protocol

from textual.driver import Driver
from textual.events import Key
from textual.message import Message

from tester.base.keys import FAST_STOP, STOP
from tester.service.address import Address
from tester.service.stop_call import NotTakenError, StopCall

LOOK_S = 1.0
"""A connection that was lost is opened again this often, s."""


class TakesStop(Protocol):
    """What takes STOP."""

    def press(self, *, fast: bool = False) -> None:
        """STOP; from any thread."""
        ...


class StopLine:
    """Says STOP, from a thread of its own."""

    def __init__(self, address: Address | None, name: str) -> None:
        """Nothing is connected before ``open`` or ``press``. ``name``: who stops, as the service records it."""
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
        """Send STOP; from any thread."""
        sent: Future[None] = Future()
        self._sent = sent
        self._pressed.put((fast, sent))
        self.open()

    def take(self) -> Future[None] | None:
        """Return what becomes of the newest press (an exception: NotTakenError), once; None where there was none."""
        sent, self._sent = self._sent, None
        return sent

    def close(self) -> None:
        """Hang up."""
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


def stopping(driver: type[Driver], line: TakesStop) -> type[Driver]:
    """Return a terminal driver that presses ``line`` with STOP's keys before anybody else hears of them."""

    class StoppingDriver(driver):
        """What reads the keys, in a thread of its own."""

        def process_message(self, message: Message) -> None:
            """Have STOP go its way, then everything as ever."""
            if isinstance(message, Key) and message.key in STOP.keys + FAST_STOP.keys:
                line.press(fast=message.key in FAST_STOP.keys)
            super().process_message(message)

    return StoppingDriver
