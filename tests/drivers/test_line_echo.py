"""An RS-485 adapter with echo: the first read detects it, the echo is removed and never confirms a write."""

from __future__ import annotations

import pytest

from drivers.crc16 import with_crc
from drivers.modbus import Request
from tests.drivers.modbus_bench import Bench, refusal, reply

READ = with_crc(bytes.fromhex("010300000002"))
WRITE_ONE = with_crc(bytes.fromhex("010600C80001"))
WRITE_TWO = with_crc(bytes.fromhex("01100010000204000A000B"))
DONE_TWO = with_crc(bytes.fromhex("011000100002"))


def reading() -> tuple[Bench, Request]:
    """Return a bench with an unknown adapter whose read of two registers was sent at 0."""
    bench = Bench(known=False)
    request = bench.link.read(bench.station(), 3, 0, 2, 1.0)
    bench.link.enable(request)
    bench.serve(0.0)
    assert bench.frames == [READ]
    return bench, request


def writing(*, values: tuple[int, ...] = (1,)) -> tuple[Bench, Request]:
    """Return a bench on an adapter with echo, after a write was sent at 0.1."""
    bench, read = reading()
    bench.serve(0.02, (0.01, READ + reply(1, 2)), scan=False)
    function, address = (6, 200) if len(values) == 1 else (16, 16)
    request = bench.link.write(read.station, function, address, values)
    bench.link.enable(request)
    bench.serve(0.1)
    return bench, request


def test_a_reply_behind_its_own_request_shows_an_adapter_with_echo() -> None:
    bench, request = reading()
    bench.serve(0.02, (0.01, READ + reply(1, 2)))
    assert bench.link.ear.hears_itself is True
    assert [data for _, data in bench.notes.replies] == [bytes.fromhex("00010002")]
    assert request.station.counters.garbage == 0


def test_a_reply_alone_shows_an_adapter_that_does_not() -> None:
    bench, _ = reading()
    bench.serve(0.02, (0.01, reply(1, 2)))
    assert bench.link.ear.hears_itself is False


def test_an_exception_alone_shows_it_too() -> None:
    bench, _ = reading()
    bench.serve(0.02, (0.01, refusal(2)))
    assert bench.link.ear.hears_itself is False


@pytest.mark.parametrize("size", range(1, 9))
def test_the_echo_may_come_in_pieces(size: int) -> None:
    bench, _ = reading()
    data = READ + reply(1, 2)
    chunks = [(0.001 * at, data[at : at + size]) for at in range(0, len(data), size)]
    bench.serve(0.03, *chunks)
    assert bench.link.ear.hears_itself is True
    assert len(bench.notes.replies) == 1


def test_nothing_is_written_before_it_is_known() -> None:
    bench = Bench(known=False)
    station = bench.station()
    station.known_register = (4, 7)
    bench.link.enable(bench.link.write(station, 6, 200, (1,)))
    bench.serve(0.0)
    assert bench.frames == [with_crc(bytes.fromhex("010400070001"))]
    bench.serve(0.02, (0.01, reply(5, function=4)), scan=False)
    bench.serve(0.05)
    assert bench.frames[1:] == [WRITE_ONE]


def test_a_station_that_is_not_there_is_not_written_to() -> None:
    bench = Bench(known=False)
    bench.link.enable(bench.link.write(bench.station(), 6, 200, (1,)))
    for number in range(2000):
        bench.serve(0.005 * number)
    assert {frame[1] for frame in bench.frames} == {3}
    assert len(bench.frames) <= 11


def test_the_echo_of_a_single_write_does_not_confirm_it() -> None:
    bench, request = writing()
    bench.serve(0.11, (0.105, WRITE_ONE))
    assert len(bench.notes.replies) == 1
    bench.serve(0.1 + request.timeout_s, scan=False)
    assert request.station.counters.timeouts == 1


def test_echo_and_reply_of_a_single_write_confirm_it() -> None:
    bench, request = writing()
    bench.serve(0.11, (0.105, WRITE_ONE + WRITE_ONE))
    assert bench.notes.requests[-1] is request


def test_echo_and_reply_may_come_apart() -> None:
    bench, request = writing()
    bench.serve(0.11, (0.102, WRITE_ONE))
    bench.serve(0.12, (0.115, WRITE_ONE[:3]))
    bench.serve(0.13, (0.125, WRITE_ONE[3:]))
    assert bench.notes.requests[-1] is request


def test_a_write_of_several_registers_is_confirmed_by_its_reply_behind_the_echo() -> None:
    bench, request = writing(values=(10, 11))
    bench.serve(0.11, (0.105, WRITE_TWO))
    assert len(bench.notes.replies) == 1
    bench.serve(0.12, (0.115, DONE_TWO))
    assert bench.notes.requests[-1] is request


def test_an_exception_behind_the_echo_is_one() -> None:
    bench, request = writing()
    bench.serve(0.11, (0.105, WRITE_ONE + refusal(2, function=6)))
    assert request.station.counters.exceptions == {2: 1}


def test_a_disturbed_echo_confirms_nothing() -> None:
    bench, request = writing()
    bench.serve(0.11, (0.105, b"\x00" + WRITE_ONE[1:] + WRITE_ONE))
    assert len(bench.notes.replies) == 1
    assert request.station.counters.garbage == 1


def test_an_adapter_that_starts_to_echo_is_noticed_at_the_next_read() -> None:
    bench, read = reading()
    bench.serve(0.02, (0.01, reply(1, 2)), scan=False)
    bench.serve(1.1)
    bench.serve(1.12, (1.11, READ + reply(3, 4)), scan=False)
    assert bench.link.ear.hears_itself is True
    assert bench.notes.replies[-1][1] == bytes.fromhex("00030004")
    assert read.station.counters.garbage == 0
