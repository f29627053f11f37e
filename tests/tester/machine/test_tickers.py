"""The tickers: simulated time on a grid, real time on absolute deadlines."""

from __future__ import annotations

import gc
import os
import sys
from math import inf

import pytest

from tester.machine.tickers import TickStatistics, collector_at_rest, next_tick, run_real_time, run_simulated


class Ticks:
    """Wants a tick every 10 ms, a hundred of them."""

    def __init__(self, count: int = 100) -> None:
        self.times: list[float] = []
        self.count = count

    @property
    def finished(self) -> bool:
        return len(self.times) >= self.count

    @property
    def waiting(self) -> bool:
        return False

    def tick(self, now: float) -> float:
        self.times.append(now)
        return now + 0.01


class Still:
    urgent_s = inf

    def __init__(self) -> None:
        self.seen: list[float] = []

    def advance(self, now: float) -> None:
        self.seen.append(now)


def test_simulated_ticks_come_at_their_times_without_drift() -> None:
    ticks = Ticks(10_000)
    run_simulated(ticks, Still(), lapse=None, poll=lambda _: None)
    assert ticks.times == [i * 10_000 / 1e6 for i in range(10_000)]


def test_the_world_is_up_to_date_before_every_tick() -> None:
    ticks, world = Ticks(), Still()
    run_simulated(ticks, world, lapse=None, poll=lambda _: None)
    assert world.seen == ticks.times


def test_something_urgent_brings_the_next_tick_forward() -> None:
    assert next_tick(1.0, 1.01, 1.0042) == 1.0042


def test_a_tick_never_repeats_its_time() -> None:
    assert next_tick(1.0, 0.5, inf) == 1.000001


def test_a_time_lapse_is_kept() -> None:
    ticks = Ticks(50)
    run_simulated(ticks, Still(), lapse=50.0, poll=lambda _: None)
    assert len(ticks.times) == 50


@pytest.mark.skipif(sys.platform != "linux", reason="Linux's scheduling classes")
@pytest.mark.parametrize(("lapse", "asked"), [(1.0, True), (50.0, False), (None, False)])
def test_priority_is_asked_for_where_a_machines_time_is_kept(
    lapse: float | None, asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    classes: list[int] = []
    monkeypatch.setattr(os, "sched_setscheduler", lambda _thread, kind, _level: classes.append(kind))
    run_simulated(Ticks(2), Still(), lapse=lapse, poll=lambda _: None)
    assert (os.SCHED_RR | os.SCHED_RESET_ON_FORK in classes) is asked
    assert not asked or classes[-1] == os.SCHED_OTHER  # given back


def test_real_time_ticks_are_counted_and_on_time_in_the_mean() -> None:
    ticks, statistics = Ticks(20), TickStatistics()
    run_real_time(ticks, None, poll=lambda _: None, statistics=statistics)
    assert statistics.ticks == 20
    assert ticks.times[-1] >= 0.19


def test_the_collector_rests_inside_and_works_again_after() -> None:
    with collector_at_rest():
        assert not gc.isenabled()
    assert gc.isenabled()
