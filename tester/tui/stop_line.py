"""STOP's own way to the service: taken where the terminal is read, in a thread of its own, past the screen's loop.

A screen that is drawing, or that stands still because nobody reads its terminal, does not keep STOP waiting: the thread
opens a connection of its own, says who it is and STOP in one breath, and waits for the answer.
"""

from __future__ import annotations

from concurrent.futures import Future
from threading import Thread

from textual.driver import Driver
from textual.events import Key
from textual.message import Message
from websockets.exceptions import WebSocketException
from websockets.sync.client import ClientConnection, connect, unix_connect

from tester.service.address import Address, AddressError, UnixAddress, default_address
from tester.service.commands import Command, Join, Stop
from tester.service.protocol import Accepted, BadMessageError, encode, from_server
from tester.trouble import in_words

KEYS = ("f12", "ctrl+x")
"""A terminal may take the function keys for itself, so there are two."""
WITHIN_S = 3.0
"""Without an answer by then it is tried over the screen's own connection, s."""
ANSWER_BYTES = 2000
"""An answer is shorter; the hello that comes before it is long, and nobody needs it here."""
MAX_INCOMING = 64 * 1024 * 1024


class NotTakenError(Exception):
    """STOP has not arrived this way; the message says why."""


class StopLine:
    """Says STOP, in a thread of its own each time."""

    def __init__(self, address: Address | None, name: str) -> None:
        """Nothing is connected before ``press``. ``name``: who stops, as the service records it."""
        self._address, self._name = address, name
        self._sent: Future[None] | None = None

    def press(self) -> None:
        """Send STOP; from any thread."""
        sent: Future[None] = Future()
        self._sent = sent
        Thread(target=self._send, args=(sent,), name="stop", daemon=True).start()

    def take(self) -> Future[None] | None:
        """Return what becomes of the newest press (an exception: NotTakenError), once; None where there was none."""
        sent, self._sent = self._sent, None
        return sent

    def _send(self, sent: Future[None]) -> None:
        try:
            with _open(self._address or default_address()) as connection:
                connection.send(encode(Join(self._name)), text=True)
                connection.send(encode(Command(1, Stop())), text=True)
                while not _taken(connection.recv(WITHIN_S)):
                    pass
        except (OSError, AddressError, WebSocketException, BadMessageError) as error:  # TimeoutError is an OSError
            sent.set_exception(NotTakenError(in_words(error)))
        else:
            sent.set_result(None)


def _taken(text: str | bytes) -> bool:
    return len(text) <= ANSWER_BYTES and isinstance(from_server(text), Accepted)


def _open(address: Address) -> ClientConnection:
    if isinstance(address, UnixAddress):
        return unix_connect(
            str(address.path), uri="ws://localhost/", compression=None, max_size=MAX_INCOMING, open_timeout=WITHIN_S,
            close_timeout=WITHIN_S, proxy=None,
        )  # fmt: skip
    return connect(
        f"ws://{address.host}:{address.port}/", compression=None, max_size=MAX_INCOMING, open_timeout=WITHIN_S,
        close_timeout=WITHIN_S, proxy=None, additional_headers={"Authorization": f"Bearer {address.token}"},
    )  # fmt: skip


def stopping(driver: type[Driver], line: StopLine) -> type[Driver]:
    """Return a terminal driver that presses ``line`` with STOP's keys before anybody else hears of them."""

    class StoppingDriver(driver):
        """What reads the keys, in a thread of its own."""

        def process_message(self, message: Message) -> None:
            """Have STOP go its way, then everything as ever."""
            if isinstance(message, Key) and message.key in KEYS:
                line.press()
            super().process_message(message)

    return StoppingDriver
