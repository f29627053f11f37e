"""Signals that end a process, and the processes they reach."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Generator
from types import FrameType

import pytest

from tester.base.processes import (
    HANG_UP,
    QUIT,
    SUSPENDING,
    RealTimePriority,
    asking_to_end,
    handled,
    leave_to_parent,
    not_inherited,
)

posix = pytest.mark.skipif(not HANG_UP, reason="this system has no SIGHUP")


@pytest.fixture(autouse=True)
def as_before() -> Generator[None]:
    """Restore every handler after a test."""
    numbers = [signal.SIGINT, signal.SIGTERM, *([HANG_UP, QUIT, *SUSPENDING] if HANG_UP else [])]
    before = {number: signal.getsignal(number) for number in numbers}
    if HANG_UP:
        signal.signal(HANG_UP, signal.SIG_DFL)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


class SignalLog:
    def __init__(self) -> None:
        self.numbers: list[int] = []

    def __call__(self, number: int, _frame: FrameType | None) -> None:
        self.numbers.append(number)


def test_interrupt_and_termination_are_handled() -> None:
    received = SignalLog()
    with handled(received):
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGTERM)
    assert received.numbers == [signal.SIGINT, signal.SIGTERM]


@posix
def test_a_hang_up_is_handled() -> None:
    received = SignalLog()
    with handled(received):
        signal.raise_signal(HANG_UP)
    assert received.numbers == [HANG_UP]


@posix
def test_a_process_that_ignores_hang_ups_keeps_ignoring_them() -> None:
    signal.signal(HANG_UP, signal.SIG_IGN)
    received = SignalLog()
    with handled(received):
        signal.raise_signal(HANG_UP)
    assert received.numbers == [] and HANG_UP not in asking_to_end()


def test_the_handlers_of_before_come_back() -> None:
    before = [signal.getsignal(number) for number in asking_to_end()]
    with handled(SignalLog()):
        pass
    assert [signal.getsignal(number) for number in asking_to_end()] == before


@posix
def test_a_process_started_meanwhile_ignores_the_signals_of_its_parent() -> None:
    with not_inherited():
        assert signal.getsignal(signal.SIGINT) is signal.getsignal(HANG_UP) is signal.SIG_IGN
    assert signal.getsignal(HANG_UP) is signal.SIG_DFL


@posix
def test_a_worker_leaves_interrupts_and_hang_ups_to_its_parent() -> None:
    leave_to_parent()
    signal.raise_signal(HANG_UP)
    assert asking_to_end() == [signal.SIGINT, signal.SIGTERM, *([QUIT] if QUIT else [])]
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


@posix
def test_quit_is_handled_and_nothing_suspends() -> None:
    received = SignalLog()
    with handled(received):
        signal.raise_signal(QUIT)
        for number in SUSPENDING:
            signal.raise_signal(number)
    assert received.numbers == [QUIT] and len(SUSPENDING) == 3


linux = pytest.mark.skipif(sys.platform != "linux", reason="Linux's scheduling classes")


@linux
def test_it_is_granted_for_a_time_or_refused_with_a_reason() -> None:
    priority = RealTimePriority()
    granted = os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR
    assert granted == (priority.refused == "")
    priority.close()
    assert os.sched_getscheduler(0) == os.SCHED_OTHER


@linux
def test_where_it_is_refused_the_process_continues_unchanged(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    priority = RealTimePriority()
    assert priority.refused == "Operation not permitted"
    priority.close()


def test_elsewhere_it_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    priority = RealTimePriority()
    assert priority.refused
    priority.close()
