"""STOP's keys: the thread that reads the terminal sends STOP, independently of the screen's loop.

A screen that is drawing, or that hangs because its terminal is not read, does not delay STOP.
"""

from __future__ import annotations

from typing import Protocol

from textual.driver import Driver
from textual.events import Key
from textual.message import Message

from tester.base.keys import FAST_STOP, STOP


class TakesStop(Protocol):
    """An object that accepts STOP."""

    def press(self, *, fast: bool = False) -> None:
        """Send STOP; may be called from any thread."""
        ...


def stopping(driver: type[Driver], line: TakesStop) -> type[Driver]:
    """Return a terminal driver that presses ``line`` on STOP's keys before the screen receives them."""

    class StoppingDriver(driver):
        """Reads the keys, in a separate thread."""

        def process_message(self, message: Message) -> None:
            """Send STOP, then handle the message as usual."""
            if isinstance(message, Key) and message.key in STOP.keys + FAST_STOP.keys:
                line.press(fast=message.key in FAST_STOP.keys)
            super().process_message(message)

    return StoppingDriver
