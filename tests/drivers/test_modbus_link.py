"""The Modbus link when all goes well: timing, frames, the schedule."""

from __future__ import annotations

import copy
from math import inf

import pytest

from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink, codec
from drivers.modbus.line import silent_gap_s
from drivers.modbus.schedule import POLL_S
from drivers.ports import BusLost
from drivers.profiles import Timing
from tests.drivers.modbus_bench import TIMING, Bench, Notes, reply

NINE = tuple(range(9))


def test_a_read_is_sent_when_enabled() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, 0.0)
    bench.serve(0.0)
    assert bench.frames == []
    bench.link.enable(request)
    bench.serve(0.01)
    assert bench.line.sent == [(0.01, codec.read_request("rtu", 1, 3, 0, 9))]


def test_a_reply_reaches_the_owner_with_its_arrival() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    bench.serve(0.0)
    bench.serve(0.01, (0.0055, reply(*NINE)))
    assert bench.notes.replies == [(0.0055, b"".join(n.to_bytes(2, "big") for n in NINE))]


def test_a_reply_in_three_pieces_is_put_together() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 1.0))
    bench.serve(0.0)
    whole = reply(*NINE)
    bench.serve(0.01, (0.003, whole[:2]), (0.004, whole[2:20]))
    assert bench.notes.replies == []
    bench.serve(0.012, (0.011, whole[20:]))
    assert [t for t, _ in bench.notes.replies] == [0.011]


def test_only_one_request_is_under_way() -> None:
    bench = Bench()
    station = bench.station()
    for address in (0, 20):
        bench.link.enable(bench.link.read(station, 3, address, 9, 1.0))
    bench.serve(0.0)
    bench.serve(0.005)
    assert len(bench.frames) == 1


def test_the_next_request_keeps_the_silence_after_a_reply() -> None:
    bench = Bench()
    station = bench.station()
    for address in (0, 20):
        bench.link.enable(bench.link.read(station, 3, address, 9, 1.0))
    bench.serve(0.0)
    bench.serve(0.006, (0.0055, reply(*NINE)))
    assert len(bench.frames) == 1
    assert bench.link.deadline == pytest.approx(0.0055 + 0.00175)
    bench.serve(bench.link.deadline)
    assert len(bench.frames) == 2


@pytest.mark.parametrize(("baud", "gap_s"), [(9600, 35 / 9600), (19200, 35 / 19200), (115200, 0.00175)])
def test_silence_is_three_and_a_half_characters_up_to_19200(baud: int, gap_s: float) -> None:
    assert silent_gap_s(10, baud) == pytest.approx(gap_s)


def test_a_read_of_period_0_goes_out_with_every_scan_and_no_other_tick() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    for number in range(3):
        now = 0.05 * number
        bench.serve(now)
        bench.serve(now + 0.0155, (now + 0.0055, reply(*NINE)), scan=False)
        assert bench.link.deadline == inf
        bench.serve(now + 0.03, scan=False)
    assert bench.times == [0.0, 0.05, 0.1]


def test_a_hundred_scans_a_second_give_a_hundred_reads() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    for number in range(100):
        now = 0.01 * number
        chunks = ((now - 0.0045, reply(*NINE)),) if number else ()
        bench.serve(now, *chunks)
    assert len(bench.frames) == 100
    assert len(bench.notes.replies) == 99


def test_a_period_is_kept_on_average_with_scans_that_do_not_fit_it() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.18))
    for number in range(201):
        now = 0.05 * number
        waiting = bench.line.sent and bench.line.sent[-1][0] == pytest.approx(now - 0.05)
        bench.serve(now, *(((now - 0.04, reply(*NINE)),) if waiting else ()))
    assert len(bench.frames) == pytest.approx(10.0 / 0.18, abs=1.0)


def test_a_changed_period_counts_from_the_last_request() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, 10.0)
    bench.link.enable(request)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(*NINE)))
    bench.link.retime(request, 0.1)
    bench.serve(0.05)
    bench.serve(0.1)
    assert bench.times == [0.0, 0.1]


def test_a_periodic_read_waits_for_a_scan_before_it_asks_for_a_tick() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.2))
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(*NINE)))
    bench.serve(0.02)
    assert bench.link.deadline == pytest.approx(0.26)


def test_while_a_reply_is_awaited_the_deadline_is_the_time_out() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    bench.serve(0.0)
    wire_s = (8 + 23) * 10 / 115200 + 0.00175
    assert bench.link.deadline == pytest.approx(wire_s + 0.008 + 0.003)


def test_a_load_cell_read_is_over_within_ten_milliseconds_and_two_attempts_within_fifty() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, 0.0)
    assert request.expected_s < 0.010
    assert 0.015 < request.timeout_s < 0.020
    assert request.timeout_s + 0.008 + request.timeout_s < 0.050


def test_others_waiting_the_reply_is_fetched_when_it_should_be_there() -> None:
    bench = Bench()
    station = bench.station()
    first = bench.link.read(station, 3, 0, 9)
    bench.link.enable(first)
    bench.link.enable(bench.link.read(station, 3, 20, 9))
    bench.serve(0.0)
    assert bench.link.deadline == pytest.approx(first.expected_s)
    bench.serve(0.01)
    assert bench.link.deadline == pytest.approx(first.expected_s + 3 * POLL_S)


def test_the_longest_waiting_goes_first() -> None:
    bench = Bench()
    station = bench.station()
    late = bench.link.read(station, 3, 0, 9, 1.0)
    early = bench.link.read(station, 3, 20, 9, 1.0)
    bench.link.enable(late, 0.2)
    bench.link.enable(early, 0.1)
    bench.serve(0.3)
    assert bench.frames == [early.frame]


def test_the_same_read_is_the_same_bytes_object() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    bench.serve(0.0)
    bench.serve(0.01, (0.005, reply(*NINE)))
    assert bench.frames[0] is bench.frames[1]


def test_a_tick_that_came_late_still_takes_the_reply() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, 0.0)
    bench.link.enable(request)
    bench.serve(0.0)
    bench.serve(0.2, (0.2, reply(*NINE)))
    assert request.station.counters.timeouts == 0
    # ... but the reading is not newer than the time-out.
    assert bench.notes.replies[0][0] == pytest.approx(request.timeout_s)


def test_the_newest_of_several_writes_wins() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (0,))
    bench.link.enable(write, inf)
    for value in (1, 2, 3):
        bench.link.rewrite(write, (value,))
    bench.serve(0.0)
    bench.serve(0.01, (0.005, codec.write_request("rtu", 1, 6, 26, (3,))))
    bench.serve(0.02)
    assert bench.frames == [codec.write_request("rtu", 1, 6, 26, (3,))]


def test_a_value_that_comes_while_the_last_is_under_way_is_written_after_it() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (1,))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.link.rewrite(write, (2,))
    bench.serve(0.01, (0.005, codec.write_request("rtu", 1, 6, 26, (1,))))
    assert bench.frames[1] == codec.write_request("rtu", 1, 6, 26, (2,))
    assert write.station.counters.late == 0


def test_the_same_value_again_is_not_written() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (1,))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, write.frame))
    bench.link.rewrite(write, (1,))
    bench.serve(0.02)
    assert len(bench.frames) == 1


def test_a_write_is_renewed() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (1,), renew_s=0.5)
    bench.link.enable(write)
    for number in range(110):
        now = 0.01 * number
        waiting = bench.line.sent and bench.line.sent[-1][0] == pytest.approx(now - 0.01)
        bench.serve(now, *(((now - 0.005, write.frame),) if waiting else ()))
    assert bench.times == [0.0, 0.5, 1.0]


def test_an_urgent_write_goes_before_requests_that_waited_longer() -> None:
    bench = Bench()
    station = bench.station()
    bench.link.enable(bench.link.read(station, 3, 0, 9, 1.0), 0.0)
    write = bench.link.write(station, 6, 199, (0,), 10.0)
    bench.link.enable(write, inf)
    bench.link.rewrite(write, (1,), urgent=True)
    bench.serve(1.0)
    assert bench.frames == [write.frame]


def test_a_value_that_changes_in_every_scan_does_not_starve_a_read() -> None:
    bench = Bench()
    station = bench.station()
    read = bench.link.read(station, 3, 0, 9, 0.05)
    write = bench.link.write(station, 6, 26, (0,))
    bench.link.enable(read)
    bench.link.enable(write)
    for number in range(100):
        now = 0.01 * number
        bench.link.rewrite(write, (number,))
        chunks: list[tuple[float, bytes]] = []
        if bench.frames:
            last = bench.frames[-1]
            chunks = [(now - 0.004, reply(*NINE) if last == read.frame else last)]
        bench.serve(now, *chunks)
    assert bench.frames.count(read.frame) > 15
    assert len(bench.frames) - bench.frames.count(read.frame) > 30


def test_a_fast_reader_does_not_starve_a_slow_one() -> None:
    bench = Bench()
    station, other = bench.station(1), bench.station(2)
    fast = bench.link.read(station, 3, 0, 9, 0.0)
    slow = bench.link.read(other, 3, 0, 9, 0.05)
    bench.link.enable(fast)
    bench.link.enable(slow)
    for number in range(100):
        now = 0.01 * number
        chunks = ()
        if bench.frames:
            chunks = ((now - 0.004, reply(*NINE, unit_id=bench.frames[-1][0])),)
        bench.serve(now, *chunks)
    assert bench.frames.count(slow.frame) == pytest.approx(20, abs=2)


def test_tcp_requests_are_numbered() -> None:
    bench = Bench("socket")
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 1, 0.0))
    bench.serve(0.0)
    bench.serve(0.01, (0.005, bytes.fromhex("000100000005010302002A")))
    assert [frame[:2] for frame in bench.frames] == [b"\x00\x01", b"\x00\x02"]
    assert bench.notes.replies == [(0.005, b"\x00\x2a")]


def test_a_lost_port_is_reported() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    bench.line.lost = True
    with pytest.raises(BusLost):
        bench.serve(0.0)


@pytest.mark.parametrize("unit_id", [0, 248])
def test_an_address_outside_the_standard_is_refused(unit_id: int) -> None:
    with pytest.raises(ValueError, match=r"1\.\.247"):
        Bench().station(unit_id)


def test_two_stations_with_one_address_are_refused() -> None:
    bench = Bench()
    bench.station(5)
    with pytest.raises(ValueError, match="two devices have Modbus address 5"):
        bench.station(5)


def test_a_link_can_be_copied_in_the_middle_of_a_transaction() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(timing=Timing(0.001, 0.008)), 3, 0, 9, 0.0))
    bench.serve(0.0)
    twin = copy.deepcopy(bench)
    twin.serve(0.01, (0.005, reply(*NINE)))
    assert len(twin.notes.replies) == 1
    assert bench.notes.replies == []


def test_a_write_of_many_registers_is_confirmed_by_address_and_count() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 16, 1, (10, 258))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, with_crc(bytes.fromhex("011000010002"))))
    assert bench.notes.replies == [(0.005, b"")]


def test_a_write_over_tcp_is_confirmed_by_its_echo() -> None:
    bench = Bench("socket")
    write = bench.link.write(bench.station(), 6, 26, (3,))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.serve(0.01, (0.005, bench.frames[0]))
    assert bench.notes.replies == [(0.005, b"")]


def test_a_disabled_request_is_not_sent_again() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, 0.0)
    bench.link.enable(request)
    bench.serve(0.0)
    bench.link.disable(request)
    bench.serve(0.01, (0.005, reply(*NINE)))
    bench.serve(0.02)
    assert len(bench.frames) == 1


def test_lines_with_parity_have_longer_characters() -> None:
    plain, even = ModbusLink("rtu", 19200, "N"), ModbusLink("rtu", 19200, "E")
    requests = [link.read(link.station(1, TIMING, Notes()), 3, 0, 9) for link in (plain, even)]
    assert requests[1].expected_s - 0.001 == pytest.approx(1.1 * (requests[0].expected_s - 0.001))
