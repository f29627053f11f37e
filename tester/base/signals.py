"""The signals that ask a process to end, behind one door: INT, TERM, and HUP where the system has it (not Windows).

A process that was started with HUP ignored (nohup, a service) goes on ignoring it: somebody wanted it to outlive its
terminal.
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator
from contextlib import contextmanager
from types import FrameType
from typing import Final, TypeAlias

Handler: TypeAlias = Callable[[int, FrameType | None], object]

HANG_UP: Final[int] = getattr(signal, "SIGHUP", 0)
"""The terminal is gone; 0 where there is no such signal."""
QUIT: Final[int] = getattr(signal, "SIGQUIT", 0)
"""Ctrl+\\: out, at once; 0 where there is no such signal."""
SUSPENDING: Final = tuple(
    int(getattr(signal, name)) for name in ("SIGTSTP", "SIGTTIN", "SIGTTOU") if hasattr(signal, name)
)
"""What would suspend a process in the middle of a motion (Ctrl+Z, and a terminal that another one has)."""


def asking_to_end() -> list[int]:
    """Return the numbers of the signals that ask this process to end, as it was started."""
    numbers = [int(signal.SIGINT), int(signal.SIGTERM), *([QUIT] if QUIT else [])]
    if HANG_UP and signal.getsignal(HANG_UP) is not signal.SIG_IGN:
        numbers.append(HANG_UP)
    return numbers


@contextmanager
def handled(handler: Handler) -> Generator[None]:
    """Have a handler called with what asks this process to end, and do not be suspended, while the block lasts.

    Main thread only.
    """
    before = {number: signal.signal(number, handler) for number in asking_to_end()}
    before |= {number: signal.signal(number, signal.SIG_IGN) for number in SUSPENDING}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)


@contextmanager
def not_inherited() -> Generator[None]:
    """Let a process that is started in the block ignore Ctrl+C and a hang-up: both reach its parent (main thread)."""
    numbers = [number for number in asking_to_end() if number != signal.SIGTERM]
    before = {number: signal.signal(number, signal.SIG_IGN) for number in numbers}
    try:
        yield
    finally:
        for number, previous in before.items():
            signal.signal(number, previous)


def leave_to_parent() -> None:
    """Ignore Ctrl+C and a hang-up from now on: the parent hears them too, and says what is to be done."""
    for number in (int(signal.SIGINT), HANG_UP, QUIT, *SUSPENDING):
        if number:
            signal.signal(number, signal.SIG_IGN)
