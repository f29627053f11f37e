"""The pace of a run in real time."""

from __future__ import annotations

from threading import Thread

from tester.base.clock import Pace, UrgentPace


def test_time_begins_at_zero_and_a_wait_ends_at_its_deadline() -> None:
    pace = Pace()
    assert 0.0 <= pace.now() < 0.05
    pace.wait_until(0.06)
    assert pace.now() >= 0.06


def test_a_faster_clock_waits_as_much_less() -> None:
    pace, slow = UrgentPace(times=1000.0), Pace()
    pace.wait_until(60.0)
    assert pace.now() >= 60.0 and 0.06 <= slow.now() < 30.0


def test_something_urgent_ends_the_wait_under_way() -> None:
    pace = UrgentPace()
    Thread(target=pace.hurry).start()
    pace.wait_until(60.0)
    assert pace.now() < 30.0


def test_something_urgent_before_the_wait_ends_it_at_once_and_only_once() -> None:
    pace = UrgentPace()
    pace.hurry()
    pace.wait_until(60.0)
    assert pace.now() < 30.0
    due = pace.now() + 0.02
    pace.wait_until(due)
    assert pace.now() >= due


def test_a_late_wait_lets_the_receiving_threads_catch_up() -> None:
    pace = UrgentPace(catch_up_s=0.02)
    pace.wait_until(-1.0)
    assert pace.now() >= 0.02


def test_a_wait_that_is_in_time_does_not() -> None:
    pace = UrgentPace(catch_up_s=60.0)
    pace.wait_until(pace.now())
    assert pace.now() < 30.0
