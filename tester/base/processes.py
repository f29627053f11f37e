"""Processes of this program: starting one, its real-time priority, the signals that ask it to end, its exit codes.

The signals are INT, TERM, and HUP where the system has it (not Windows). A process started with HUP ignored (nohup, a
service) keeps ignoring it: it must outlive its terminal.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Generator, Iterable
from contextlib import AbstractContextManager, contextmanager
from types import FrameType
from typing import Final, TypeAlias

Handler: TypeAlias = Callable[[int, FrameType | None], object]

HANG_UP: Final[int] = getattr(signal, "SIGHUP", 0)
"""The terminal is gone; 0 where the system has no such signal."""
QUIT: Final[int] = getattr(signal, "SIGQUIT", 0)
"""Ctrl+\\: leave at once; 0 where the system has no such signal."""
SUSPENDING: Final = tuple(
    int(getattr(signal, name)) for name in ("SIGTSTP", "SIGTTIN", "SIGTTOU") if hasattr(signal, name)
)
"""Signals that would suspend a process in the middle of a motion (Ctrl+Z, and a terminal in use by another process)."""


def asking_to_end() -> list[int]:
    """Return the numbers of the signals that ask this process to end, as it was started."""
    numbers = [int(signal.SIGINT), int(signal.SIGTERM), *([QUIT] if QUIT else [])]
    if HANG_UP and signal.getsignal(HANG_UP) is not signal.SIG_IGN:
        numbers.append(HANG_UP)
    return numbers


@contextmanager
def caught(
    handler: Handler | signal.Handlers, numbers: Iterable[int], ignored: Iterable[int] = ()
) -> Generator[None]:
    """Within the block, call a handler for some signals and ignore others, by number (0 is skipped).

    Only the main thread receives signals: in another one the block runs without a handler.
    """
    before: dict[int, Handler | signal.Handlers | int | None] = {}
    if threading.current_thread() is threading.main_thread():
        before = {number: signal.signal(number, handler) for number in numbers if number}
        before |= {number: signal.signal(number, signal.SIG_IGN) for number in ignored if number}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)


def handled(handler: Handler) -> AbstractContextManager[None]:
    """Return a block that calls a handler for signals that ask this process to end, and ignores those that suspend it.
    """
    return caught(handler, asking_to_end(), SUSPENDING)


def stopped_by_signals(stop: Callable[..., object]) -> AbstractContextManager[None]:
    """Return a block that calls ``stop(fast=...)`` for signals that ask this process to end.

    ``fast`` from the second signal on.
    """
    signals = 0

    def on_signal(_number: int, _frame: FrameType | None) -> None:
        nonlocal signals
        signals += 1
        stop(fast=signals > 1)

    return handled(on_signal)


def not_inherited() -> AbstractContextManager[None]:
    """Return a block in which a started process ignores Ctrl+C and a hang-up: both reach its parent."""
    return caught(signal.SIG_IGN, [number for number in asking_to_end() if number != signal.SIGTERM])


@contextmanager
def end_asked() -> Generator[Callable[[], bool]]:
    """Yield a function that returns whether TERM or INT has asked this process to end since the block began."""
    asked = threading.Event()
    with caught(lambda _number, _frame: asked.set(), (signal.SIGINT, signal.SIGTERM)):
        yield asked.is_set


def leave_to_parent() -> None:
    """Ignore Ctrl+C and a hang-up from now on: the parent receives them as well, and decides."""
    for number in (int(signal.SIGINT), HANG_UP, QUIT, *SUSPENDING):
        if number:
            signal.signal(number, signal.SIG_IGN)


_COMMAND = "from tester.cli.main import main; main()"


def tester_command(*arguments: str) -> list[str]:
    """Return the command line of ``tester ARGUMENTS`` as a process of its own."""
    return [sys.executable, "-P", "-c", _COMMAND, *arguments]


def module_command(module: str, *arguments: str) -> list[str]:
    """Return the command line that runs one of our modules as a process of its own."""
    return [sys.executable, "-P", "-m", module, *arguments]


LEVEL = 10
"""Of scans. 1 to 99; low: kernel threads that serve interrupts run at 50."""
BELOW_SCANS = LEVEL - 1
"""Of a process whose work must not wait for others, but for a scan."""


class RealTimePriority:
    """Real-time priority of this process, until ``close``; ``refused``: why it was not granted, else ""."""

    def __init__(self, level: int = LEVEL) -> None:
        """Request the priority for every running thread.

        A thread without it could hold the interpreter's lock, and the others would wait.
        """
        self.refused = ""
        self._threads: list[int] = []
        if sys.platform != "linux":
            self.refused = f"not asked for on {sys.platform}"
            return
        for thread in threading.enumerate():
            if thread.native_id is None:
                continue
            try:
                os.sched_setscheduler(
                    thread.native_id, os.SCHED_RR | os.SCHED_RESET_ON_FORK, os.sched_param(level)
                )
            except OSError as error:
                self.refused = error.strerror or "refused"
                return
            self._threads.append(thread.native_id)

    def close(self) -> None:
        """Return to normal priority; threads that have ended need nothing."""
        if sys.platform != "linux":
            return
        for number in self._threads:
            try:
                os.sched_setscheduler(number, os.SCHED_OTHER, os.sched_param(0))
            except OSError:
                continue
        self._threads.clear()


EXIT_DONE = 0
EXIT_FAILED = 1
"""A run failed, a service refused, a record differs."""
EXIT_USAGE = 2
EXIT_INVALID = 3
"""Invalid recipe or rig file; or recipe, rig or calibration differ from those of the run to be resumed."""
EXIT_UNREACHABLE = 4
EXIT_TRIPPED = 5
"""Tripped or stopped."""
EXIT_INCOMPLETE = 6
EXIT_INTERRUPTED = 130
EXIT_READER_GONE = 141
"""The reader of the output is gone (`tester runs | head -1`): a shell's code for the end by SIGPIPE."""
