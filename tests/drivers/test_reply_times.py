"""The time-out of a station: measured at connect, derived from that, lengthened where replies come late."""

from __future__ import annotations

import pytest

from drivers.modbus import Request
from drivers.modbus.line import RTU_MARGIN_S
from drivers.modbus.request import REPLIES, REPLY_FACTOR, UNMEASURED_S, ReplyTimes
from drivers.profiles import Timing
from tests.drivers.modbus_bench import TIMING, Bench, reply

NINE = tuple(range(9))


def measured(*held_s: float) -> tuple[Bench, Request]:
    """Return a bench on which every reply came this long after the request's last bit."""
    bench = Bench(known=False)
    request = bench.link.read(bench.station(), 3, 0, 9, 0.0)
    bench.link.enable(request)
    for number, one_s in enumerate(held_s):
        bench.serve(number)
        arrival = number + request.wire_s + one_s
        bench.serve(arrival, (arrival, reply(*NINE)), scan=False)
    return bench, request


def test_before_it_is_measured_a_reply_is_waited_for_long() -> None:
    _, request = measured()
    assert request.timeout_s == pytest.approx(request.wire_s + UNMEASURED_S + RTU_MARGIN_S)


def test_the_time_out_follows_the_longest_measured() -> None:
    _, request = measured(0.004, 0.017, 0.010, 0.002, 0.009)
    assert request.station.reply.greatest_s == pytest.approx(0.017)
    assert request.timeout_s == pytest.approx(request.wire_s + REPLY_FACTOR * 0.017 + RTU_MARGIN_S)


def test_a_quick_line_keeps_the_limit_of_its_profile() -> None:
    _, request = measured(*[0.001] * REPLIES)
    assert request.timeout_s == pytest.approx(request.wire_s + TIMING.reply_max_s + RTU_MARGIN_S)


def test_no_reply_is_waited_for_longer_than_before_measuring() -> None:
    _, request = measured(*[0.09] * REPLIES)
    assert request.timeout_s == pytest.approx(request.wire_s + UNMEASURED_S + RTU_MARGIN_S)


def test_a_longer_time_in_a_profile_is_used() -> None:
    assert ReplyTimes().limit_s(Timing(0.1, 0.3)) == 0.3


def late(longest_s: float) -> tuple[Bench, Request]:
    """Return a quick line, after a reply that came 15 ms late."""
    bench, request = measured(*[0.001] * REPLIES)
    request.station.longest_s = longest_s
    bench.serve(10.0)
    bench.serve(10.0 + request.timeout_s, scan=False)
    arrival = 10.0 + request.wire_s + 0.016
    bench.serve(arrival, (arrival, reply(*NINE)), scan=False)
    assert request.station.counters.late == 1
    return bench, request


def test_replies_that_come_late_but_in_time_for_the_stale_limit_lengthen_the_time_out() -> None:
    _, request = late(0.025)
    assert request.timeout_s == pytest.approx(request.wire_s + REPLY_FACTOR * 0.016 + RTU_MARGIN_S)


def test_replies_too_late_for_the_stale_limit_do_not() -> None:
    _, request = late(0.015)
    assert request.timeout_s == pytest.approx(request.wire_s + TIMING.reply_max_s + RTU_MARGIN_S)


def test_three_replies_in_a_row_15_ms_late_lose_no_station() -> None:
    bench, request = late(0.025)
    for begun in (11.0, 12.0):
        bench.serve(begun)
        arrival = begun + request.wire_s + 0.016
        bench.serve(arrival, (arrival, reply(*NINE)), scan=False)
    assert not request.station.is_lost
    assert len(bench.notes.replies) == REPLIES + 2


def test_where_an_exchange_takes_longer_than_a_scan_the_next_begins_at_once() -> None:
    bench, request = measured(*[0.017] * REPLIES)
    bench.link.scan_s = 0.01
    bench.serve(10.0)
    assert bench.link.deadline == pytest.approx(10.0 + request.expected_s)
    arrival = bench.link.deadline
    bench.serve(arrival, (arrival, reply(*NINE)), scan=False)
    bench.serve(bench.link.deadline, scan=False)
    assert bench.times[-1] == pytest.approx(10.0 + request.expected_s + 0.00175, abs=1e-5)


def test_a_line_that_keeps_up_with_the_scans_waits_for_them() -> None:
    bench, _ = measured(*[0.001] * REPLIES)
    bench.link.scan_s = 0.01
    sent = len(bench.frames)
    bench.serve(10.0, scan=False)
    assert len(bench.frames) == sent


def test_it_can_be_measured_anew() -> None:
    bench, request = measured(*[0.017] * REPLIES)
    bench.link.measure()
    assert not request.station.reply.measured
    assert request.timeout_s == pytest.approx(request.wire_s + UNMEASURED_S + RTU_MARGIN_S)
