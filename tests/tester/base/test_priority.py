"""Real-time priority, where it is granted and where it is not."""

from __future__ import annotations

import os
import sys

import pytest

from tester.base.priority import RealTimePriority

linux = pytest.mark.skipif(sys.platform != "linux", reason="Linux's scheduling classes")


@linux
def test_it_is_granted_for_a_time_or_refused_with_a_reason() -> None:
    priority = RealTimePriority()
    granted = os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR
    assert granted == (priority.refused == "")
    priority.close()
    assert os.sched_getscheduler(0) == os.SCHED_OTHER


@linux
def test_where_it_is_refused_the_process_goes_on_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
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
