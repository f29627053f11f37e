"""The gateway's end of the process that sends notices: it starts that process where somebody wants notices, and again
if it dies, and repeats all notes to it. The sender knows those that it has on disk.
"""

from __future__ import annotations

import subprocess
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Final

from pydantic import ValidationError

from tester.base import clock
from tester.base.processes import module_command
from tester.notices.notice import MOST_KEPT, NOTE, SENDER, NextNeeded, SenderSettings
from tester.notices.notice_settings import settings_path

LOOK_S: Final = 10.0
"""Period of looking whether the sender lives, and whether there are settings, s."""
AGAIN_S: Final = (1.0, 5.0, 20.0, 60.0)
"""Times before the sender is started again, s; the last one from then on. A wrong setting ends it each time."""
CLOSE_S: Final = 2.0
"""Longest time for the last notes, s."""


def started() -> subprocess.Popen[bytes]:
    """Start the process that sends notices. Raises OSError."""
    return subprocess.Popen(
        module_command("tester.notices.sender_process"), stdin=subprocess.PIPE, stdout=subprocess.DEVNULL
    )


class NoticeForwarder:
    """A thread that writes notes to the sender; ``take`` never waits."""

    def __init__(self, settings: SenderSettings, start: Callable[[], subprocess.Popen[bytes]] = started) -> None:
        """Start nothing before ``open``."""
        self.settings = settings
        self._start_process = start
        self._lines: SimpleQueue[bytes | None] = SimpleQueue()
        self._kept: deque[bytes] = deque(maxlen=MOST_KEPT)
        self._next = b""
        self._process: subprocess.Popen[bytes] | None = None
        self._starts = 0
        self._again_s = float("-inf")
        self._thread = Thread(target=self._work, name="notices", daemon=True)

    def open(self) -> None:
        """Begin."""
        self._thread.start()

    def take(self, line: bytes) -> None:
        """Forward a note."""
        self._lines.put(line)

    def close(self) -> None:
        """Forward what waits, and close the sender's input; the sender works for a while."""
        self._lines.put(None)
        self._thread.join(CLOSE_S)

    @property
    def wanted(self) -> bool:
        """Whether anything is to be sent anywhere."""
        return bool(self.settings.command) or settings_path().exists()

    def _work(self) -> None:
        self._look()
        while True:
            try:
                line = self._lines.get(timeout=LOOK_S)
            except Empty:
                self._look()
                continue
            if line is None:
                break
            self._keep(line)
            if self._look():
                self._write(line)
        if self._process is not None and self._process.stdin is not None:
            with suppress(OSError):
                self._process.stdin.close()

    def _keep(self, line: bytes) -> None:
        with suppress(ValidationError):
            if isinstance(NOTE.validate_json(line), NextNeeded):
                self._next = line
                return
            self._kept.append(line)

    def _look(self) -> bool:
        """Start the sender if it is wanted and does not run; return whether it ran before, so that it lacks only what
        has just arrived.
        """
        if self._process is not None and self._process.poll() is None:
            return True
        now_s = clock.monotonic()
        if now_s >= self._again_s and self.wanted:
            self._again_s = now_s + AGAIN_S[min(self._starts, len(AGAIN_S) - 1)]
            self._starts += 1
            with suppress(OSError):
                self._process = self._start_process()
                self._write(SENDER.dump_json(self.settings))
                for line in (*self._kept, *((self._next,) if self._next else ())):
                    self._write(line)
        return False

    def _write(self, line: bytes) -> None:
        process = self._process
        if process is None or process.stdin is None:
            return
        try:
            process.stdin.write(line + b"\n")
            process.stdin.flush()
        except OSError:  # it has died; the next look starts another, which gets everything
            process.kill()
            process.wait()
