"""Keeps the results of the run under way for the gateway's clients: worked out in a process of its own, sent when they
change.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Final

from pydantic_core import from_json

from tester.service.asked_process import AskedProcess, RefusedQuestionError

GROWS_S: Final = 2.0
"""Period at which a value that grows is worked out while a client is there, s: samples are committed once a second."""
LEAST_S: Final = 0.3
"""Shortest time between two questions, s: several events come together, and a commit may be a little later."""
WITHIN_S: Final = 60.0
"""Time for an answer, s [A]: the results of 1,000 conditions take 10 s."""
GIVES: Final = frozenset({"repeat", "condition", "run", "step", "trip", "wear", "exclusion"})
"""Kinds of events after which there may be another value."""
CHECKS: Final = 3
"""Times that a run that is over is looked at again: its last lines reach the disk after its last event."""


class LiveResults:
    """The results of the newest run. ``encoded``: as JSON, ``null`` before the first answer."""

    def __init__(self, runs: Path, publish: Callable[[bytes], None], watched: Callable[[], bool]) -> None:
        """``runs``: folder of the stored runs; ``publish`` receives changed results as JSON; ``watched`` returns
        whether a client is there.
        """
        self.encoded = b"null"
        self._send, self._watched = publish, watched
        self._process = AskedProcess("tester.service.results_process", str(runs), WITHIN_S)
        self._run = ""
        self._left = 0
        """Questions that are still to be asked about a run that is over."""
        self._wake = asyncio.Event()

    def event(self, encoded: bytes) -> None:
        """Note an event of the service."""
        event = from_json(encoded)
        if event["run"] and event["kind"] in GIVES:
            self._run, self._left = event["run"], CHECKS
            self._wake.set()

    async def work(self) -> None:
        """Ask while a client is there, until the task is cancelled."""
        try:
            while True:
                with suppress(TimeoutError):
                    async with asyncio.timeout(GROWS_S):
                        await self._wake.wait()
                self._wake.clear()
                if self._left and self._watched():
                    await asyncio.sleep(LEAST_S)
                    await self._look()
        finally:
            self._process.close()

    async def _look(self) -> None:
        try:
            found = await self._process.ask(self._run)
        except (RefusedQuestionError, TimeoutError, OSError):  # manual mode has no such record; the next event asks
            self._left -= 1
            return
        if from_json(found)["over"]:
            self._left -= 1
        self.publish(found)

    def publish(self, found: bytes) -> None:
        """Send results if they have changed."""
        if found != self.encoded:
            self.encoded = found
            self._send(found)
