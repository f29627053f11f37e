"""The process that sends notices, `python -m tester.notices.sender_process`: settings and notes on its standard input.

One line each: first ``SenderSettings``, then notes (``tester.notices.notice``). The process ends with its input, after
an attempt of what waits.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Event, Thread
from typing import BinaryIO, Final

from pydantic import ValidationError

from tester.base import clock
from tester.base.lock import ExclusiveUse, RigInUseError
from tester.base.processes import leave_to_parent
from tester.base.source import InvalidSource
from tester.notices.channels.every_channel import channels_of
from tester.notices.dispatch import NoticeDispatch
from tester.notices.notice import NOTE, SENDER
from tester.notices.notice_settings import NoticeSettings, read_settings, settings_path
from tester.notices.outbox_file import OutboxFile, outbox_path
from tester.notices.secrets_file import NoticeSecrets, read_secrets, secrets_path

NICE: Final = 10
"""Lower priority: the scan comes first."""
LAST_S: Final = 30.0
"""Longest time to send what waits after the service has ended, s; the rest waits on disk for its next start."""
LOCK_EVERY_S: Final = 0.5
"""Period of asking for the outbox while an earlier sender still has it, s."""
CHANNELS: Final = ("mail", "ntfy", "apprise", "command")
"""A thread for each: a slow relay delays no other channel."""


class SettingsOnDisk:
    """The user's settings and secrets, read again when a file has changed."""

    def __init__(self, command: str) -> None:
        """Read both files. Raises InvalidSource, OSError."""
        self.command = command
        self._stamp = self._stamps()
        self.settings, self.secrets = self._read()

    def changed(self) -> bool:
        """Read the files again if one has changed; return whether that gave settings. Invalid ones change nothing."""
        stamp = self._stamps()
        if stamp == self._stamp:
            return False
        self._stamp = stamp
        try:
            self.settings, self.secrets = self._read()
        except (InvalidSource, OSError) as error:
            complain(f"the earlier settings stay in use: {error}")
            return False
        return True

    def _read(self) -> tuple[NoticeSettings, NoticeSecrets]:
        return read_settings(settings_path(), self.command), read_secrets(secrets_path(), os.environ)

    def _stamps(self) -> list[tuple[int, int, int]]:
        paths = (settings_path(), secrets_path())
        states = [path.stat() for path in paths if path.exists()]
        return [(state.st_mtime_ns, state.st_size, state.st_mode) for state in states]


class Sender:
    """The threads of one process around a dispatch."""

    def __init__(self, dispatch: NoticeDispatch, disk: SettingsOnDisk) -> None:
        """Start nothing yet."""
        self.dispatch = dispatch
        self.disk = disk
        self.ended = Event()
        self._bells = {name: Event() for name in ("tend", *CHANNELS)}

    def run(self, lines: BinaryIO) -> None:
        """Serve until the input ends and what waits has been tried."""
        self._start("reader", lambda: self._read(lines))
        for channel in CHANNELS:
            self._start(channel, lambda channel=channel: self._deliver(channel))
        while not self.ended.is_set():
            if self.disk.changed():
                self.dispatch.change(self.disk.settings, channels_of(self.disk.settings, self.disk.secrets),
                                     self.disk.secrets)  # fmt: skip
            due_s = self.dispatch.tend(clock.wall_s())
            self._ring(*CHANNELS)
            self._wait("tend", due_s)
        self.dispatch.tend(clock.wall_s())
        self._ring(*CHANNELS)
        until_s = clock.monotonic() + LAST_S
        while not self.dispatch.idle and clock.monotonic() < until_s:
            clock.sleep_until(clock.monotonic() + 0.05)

    def _start(self, name: str, work: Callable[[], None]) -> None:
        Thread(target=work, name=name, daemon=True).start()

    def _ring(self, *names: str) -> None:
        for name in names:
            self._bells[name].set()

    def _wait(self, name: str, until_s: float) -> None:
        self._bells[name].wait(max(until_s - clock.wall_s(), 0.0))
        self._bells[name].clear()

    def _read(self, lines: BinaryIO) -> None:
        for line in lines:
            try:
                self.dispatch.take(NOTE.validate_json(line), clock.wall_s())
            except ValidationError as error:
                complain(f"an unknown note: {error.errors(include_input=False, include_url=False)}")
            self._ring("tend")
        self.ended.set()
        self._ring("tend")

    def _deliver(self, channel: str) -> None:
        while True:
            while self.dispatch.attempt(channel, clock.wall_s()):
                pass
            self._wait(channel, self.dispatch.next_attempt_s(channel, clock.wall_s()))


def complain(text: str) -> None:
    """Write a line to standard error, which the service's log keeps."""
    sys.stderr.write(f"notices: {text}\n")
    sys.stderr.flush()


def serve(lines: BinaryIO) -> int:
    """Send what arrives on ``lines``; return the exit code."""
    settings = SENDER.validate_json(lines.readline())
    path = outbox_path(Path(settings.runs))
    try:
        disk = SettingsOnDisk(settings.command)
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with ExclusiveUse() as use:
            _lock(use, path)
            file = OutboxFile(path)
            dispatch = NoticeDispatch(
                file, settings.service, disk.settings, channels_of(disk.settings, disk.secrets), clock.wall_s(),
                disk.secrets, rig=settings.rig,
            )  # fmt: skip
            Sender(dispatch, disk).run(lines)
    except (InvalidSource, OSError) as error:
        complain(str(error))
        return 1
    return 0


def _lock(use: ExclusiveUse, path: Path) -> None:
    """Wait until no earlier sender has the outbox."""
    while True:
        try:
            use.lock_file("the outbox", path.with_name("lock"), "")
        except RigInUseError:
            clock.sleep_until(clock.monotonic() + LOCK_EVERY_S)
        else:
            return


if __name__ == "__main__":
    leave_to_parent()
    if hasattr(os, "nice"):
        os.nice(NICE)
    code = serve(sys.stdin.buffer)
    sys.stderr.flush()
    os._exit(code)  # a thread may wait for a relay; the outbox is on the disk
