"""Punctuality of a run's scan, as reported to clients."""

from __future__ import annotations

from threading import Event, current_thread

import pytest

from tester.machine.tickers import TickStatistics
from tester.service.running import Punctuality, aside


def test_lateness_is_reported_for_a_second_or_two_and_its_worst_for_the_whole_run() -> None:
    statistics, punctual = TickStatistics(), Punctuality()
    told: list[tuple[float, float]] = []
    for number in range(8):
        statistics.note(0.004 if number == 2 else 0.001)
        view = punctual.look(statistics, 100.0 + 0.5 * number)
        told.append((view.late_s, view.late_max_s))
    assert told[:2] == [(0.001, 0.001)] * 2
    assert told[2:6] == [(0.004, 0.004)] * 4
    assert told[6:] == [(0.001, 0.004)] * 2


def test_a_run_that_begins_after_a_pause_forgets_earlier_scans() -> None:
    statistics, punctual = TickStatistics(), Punctuality()
    statistics.note(0.1)
    punctual.look(statistics, 100.0)
    assert punctual.look(statistics, 110.0).late_s == 0.0


def test_clients_are_looked_after_until_the_work_is_done() -> None:
    enough, looks = Event(), list[str]()

    def look() -> None:
        looks.append(current_thread().name)
        if len(looks) == 3:
            enough.set()

    assert aside(lambda: enough.wait(60.0), look)
    assert len(looks) >= 3 and set(looks) == {current_thread().name}


def test_errors_of_the_work_are_raised_here() -> None:
    with pytest.raises(ZeroDivisionError):
        aside(lambda: 1 // 0, lambda: None)
