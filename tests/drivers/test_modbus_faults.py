"""The Modbus link when something goes wrong: time-outs, late replies, bad frames, exceptions, lost devices."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.crc16 import with_crc
from drivers.modbus import ModbusLink, Request
from drivers.ports import BusLost, LineWatcher, Unwatch
from drivers.profiles import Timing, load_profile
from drivers.sensor import Sensor
from drivers.temperature_controller import TemperatureController
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave
from sim.wires.modbus_wire import Impairment
from tests.drivers.modbus_bench import Bench, Notes, refusal, reply
from tests.drivers.modbus_rig import Quantities, Rig

NINE = tuple(range(9))
GOOD = reply(*NINE)


def polling(period_s: float = 0.0) -> tuple[Bench, Request]:
    """Return a bench whose first request was sent at 0."""
    bench = Bench()
    request = bench.link.read(bench.station(), 3, 0, 9, period_s)
    bench.link.enable(request)
    bench.serve(0.0)
    return bench, request


def test_silence_until_the_time_out_is_counted_and_asked_again_after_the_quarantine() -> None:
    bench, request = polling()
    bench.serve(request.timeout_s)
    assert request.station.counters.timeouts == 1
    assert bench.link.deadline == pytest.approx(request.timeout_s + 0.008)
    bench.serve(bench.link.deadline, scan=False)
    assert bench.times == [0.0, pytest.approx(request.timeout_s + 0.008, abs=1e-6)]


def test_nothing_is_sent_during_the_quarantine() -> None:
    bench, request = polling()
    for now in (request.timeout_s, request.timeout_s + 0.004, request.timeout_s + 0.0079):
        bench.serve(now)
    assert bench.times == [0.0]


def test_a_late_reply_is_counted_not_used_and_starts_the_silence_anew() -> None:
    bench, request = polling()
    bench.serve(request.timeout_s)
    late = request.timeout_s + 0.005
    bench.serve(late + 0.001, (late, GOOD))
    assert bench.notes.replies == []
    assert request.station.counters.late == 1
    assert bench.link.deadline == pytest.approx(late + 0.008)


def test_a_late_reply_of_another_shape_is_not_taken_for_the_answer() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.005, reply(1, 2)), (0.006, GOOD))
    assert request.station.counters.late == 1
    assert len(bench.notes.replies) == 1


def asked_over_tcp() -> tuple[Bench, Request]:
    """Return a bench whose first request of one register, number 1, was sent at 0."""
    bench = Bench("socket")
    request = bench.link.read(bench.station(), 3, 0, 1, 0.0)
    bench.link.enable(request)
    bench.serve(0.0)
    return bench, request


def test_a_time_out_over_tcp_drops_the_connection_and_is_counted() -> None:
    bench, request = asked_over_tcp()
    bench.serve(request.timeout_s)
    assert bench.line.renewed == [request.timeout_s]
    assert request.station.counters.timeouts == 1
    assert "no reply" in bench.link.doubts
    bench.serve(0.1, (0.09, bytes.fromhex("0002000000050103020002")))
    assert bench.notes.replies == [(0.09, b"\x00\x02")]


@pytest.mark.parametrize(
    "data",
    [
        "0002000000050103020001", "0001000100050103020001", "0001000000060103020001", "0001000000050203020001",
        "0001000000050104020001", "0001000000050103040001", "000100000005010302000100", "000100000005010302" * 2,
    ],
    ids=["transaction", "protocol", "length", "unit", "function", "byte count", "bytes behind it", "cut, and another"],
)
def test_a_tcp_frame_in_doubt_drops_the_connection_and_gives_no_value(data: str) -> None:
    bench, request = asked_over_tcp()
    bench.serve(0.01, (0.005, bytes.fromhex(data)))
    assert bench.notes.replies == []
    assert bench.line.renewed == [0.01]
    assert request.station.counters.late + request.station.counters.garbage == 1


def test_a_tcp_reply_in_pieces_is_put_together() -> None:
    bench, _ = asked_over_tcp()
    whole = bytes.fromhex("0001000000050103020001")
    for at in range(len(whole)):
        bench.link.feed([(0.001 * at, whole[at : at + 1])], 0.001 * at)
    assert [data for _, data in bench.notes.replies] == [b"\x00\x01"]
    assert bench.line.renewed == []


def test_doubtful_bytes_are_not_decoded() -> None:
    bench, _ = asked_over_tcp()
    good = bytes.fromhex("0001000000050103020001")
    bench.serve(0.01, (0.005, b"\xff"), (0.006, good))
    assert bench.notes.replies == []


def test_unrequested_bytes_over_tcp_drop_the_connection() -> None:
    bench, _ = asked_over_tcp()
    good = bytes.fromhex("0001000000050103020001")
    bench.serve(0.01, (0.005, good), (0.006, good), scan=False)
    assert len(bench.notes.replies) == 1
    assert len(bench.line.renewed) == 1


def test_a_line_that_cannot_be_begun_anew_is_lost_by_a_doubt() -> None:
    link, line = ModbusLink("socket"), SerialStub()
    request = link.read(link.station(1, Timing(0.001, 0.008), Notes()), 3, 0, 1, 0.0)
    link.enable(request)
    link.service(line, 0.0)
    with pytest.raises(BusLost, match="no reply on reading 1 register"):
        link.service(line, 1.0)


class SerialStub:
    """A line without a connection to reopen."""

    def write(self, data: bytes, now: float) -> None: ...

    def read(self, now: float) -> list[tuple[float, bytes]]:
        return []

    def watch(self, watcher: LineWatcher) -> Unwatch:
        raise NotImplementedError


def test_a_bad_crc_is_counted_and_asked_again_when_the_line_is_quiet() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, GOOD[:-1] + bytes((GOOD[-1] ^ 1,))))
    assert request.station.counters.crc_errors == 1
    assert bench.times == [0.0, 0.01]
    assert bench.notes.replies == []


@given(st.integers(min_value=0, max_value=8 * len(GOOD) - 1))
def test_no_single_wrong_bit_gets_through(bit: int) -> None:
    bench, _ = polling()
    data = bytearray(GOOD)
    data[bit // 8] ^= 1 << bit % 8
    bench.serve(0.01, (0.0055, bytes(data)))
    assert bench.notes.replies == []


@given(st.binary(max_size=300))
def test_after_any_garbage_the_link_can_continue(garbage: bytes) -> None:
    bench, _ = polling()
    bench.link.feed([(0.002, garbage)], 0.01)
    now = 0.01
    for _ in range(20):
        now = max(now + 0.001, min(bench.link.deadline, now + 0.05))
        if bench.times[-1] > 0.0:
            break
        bench.serve(now)
    bench.serve(now + 0.01, (now + 0.0055, GOOD))
    assert bench.notes.replies[-1][1] == GOOD[3:-2]


def test_a_broken_off_reply_is_a_time_out_and_garbage() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, GOOD[:11]))
    bench.serve(request.timeout_s)
    assert (request.station.counters.timeouts, request.station.counters.garbage) == (1, 1)
    bench.serve(bench.link.deadline)
    bench.serve(0.04, (0.03, GOOD))
    assert len(bench.notes.replies) == 1


def test_noise_before_a_reply_does_not_harm_it() -> None:
    bench, _ = polling()
    bench.serve(0.01, (0.0055, b"\x00\xff\xfe" + GOOD))
    assert bench.notes.replies == [(0.0055, GOOD[3:-2])]


def test_a_reply_with_another_address_is_garbage_and_the_right_one_behind_it_counts() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, reply(*NINE, unit_id=7) + GOOD))
    assert request.station.counters.garbage == 1
    assert len(bench.notes.replies) == 1


def test_nothing_at_all_is_not_a_reply() -> None:
    bench, _ = polling()
    bench.serve(0.01, (0.0055, b""))
    assert bench.notes.replies == []


def test_unrequested_bytes_are_counted() -> None:
    bench = Bench()
    bench.link.enable(bench.link.read(bench.station(), 3, 0, 9, 0.0))
    bench.serve(0.0, (-0.1, b"\x55"))
    assert bench.link.garbage == 1
    assert bench.notes.replies == []


def test_one_failed_attempt_is_followed_by_another_at_once() -> None:
    bench, _ = polling(period_s=1.0)
    bench.serve(0.01, (0.0055, GOOD[:-1] + b"\x00"))
    bench.serve(0.02, (0.0155, GOOD))
    assert bench.times == [0.0, 0.01]
    assert len(bench.notes.replies) == 1


def test_without_retries_the_next_attempt_waits_for_its_period() -> None:
    bench = Bench()
    request = bench.link.read(bench.station(timing=Timing(0.001, 0.008, retries=0)), 3, 0, 9, 1.0)
    bench.link.enable(request)
    bench.serve(0.0)
    bench.serve(0.02)
    bench.serve(0.5)
    assert bench.times == [0.0]
    bench.serve(1.02)
    assert bench.times == [0.0, 1.02]


def starve(bench: Bench, until: float) -> None:
    """Serve the link at its own deadlines without answers."""
    now = 0.0
    while now < until:
        now = min(max(bench.link.deadline, now + 0.0005), now + 0.01)
        bench.serve(now)


def test_three_misses_in_a_row_make_a_station_lost() -> None:
    bench, request = polling()
    starve(bench, 0.045)
    assert not request.station.is_lost
    starve(bench, 0.075)
    assert request.station.is_lost
    assert len(bench.notes.losses) == 1


def test_a_lost_station_is_asked_once_a_second_without_further_attempts() -> None:
    bench, request = polling()
    starve(bench, 0.075)
    sent = len(bench.frames)
    starve(bench, 5.0)
    assert 4 <= len(bench.frames) - sent <= 6
    assert len(bench.notes.losses) == 1
    assert request.station.is_lost


def test_a_good_reply_ends_the_loss() -> None:
    bench, request = polling()
    starve(bench, 0.075)
    sent = len(bench.frames)
    now = 0.075
    while len(bench.frames) == sent:
        now += 0.01
        bench.serve(now)
    bench.serve(now + 0.01, (now + 0.006, GOOD))
    assert not request.station.is_lost
    assert request.station.misses == 0


def test_a_silent_station_leaves_the_line_to_the_others() -> None:
    bench = Bench()
    dead = bench.link.read(bench.station(1), 3, 0, 9, 0.1)
    alive = bench.link.read(bench.station(2), 3, 0, 9, 0.1)
    bench.link.enable(dead)
    bench.link.enable(alive)
    for number in range(500):
        now = 0.01 * number
        fresh = bench.line.sent and bench.line.sent[-1] == (pytest.approx(now - 0.01), alive.frame)
        bench.serve(now, *(((now - 0.004, reply(*NINE, unit_id=2)),) if fresh else ()))
    assert bench.frames.count(alive.frame) > 45


@pytest.mark.parametrize(
    ("code", "text"), [(1, "illegal function"), (2, "illegal data address"), (3, "illegal data value")]
)
def test_exceptions_1_to_3_are_a_wrong_configuration_and_latch(code: int, text: str) -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, refusal(code)))
    bench.serve(5.0)
    assert request.station.refused == f"exception {code} ({text}) on reading 9 registers from address 0"
    assert request.station.counters.exceptions == {code: 1}
    assert len(bench.frames) == 1


def test_exception_8_on_a_write_is_a_wrong_configuration_and_on_a_read_is_asked_again() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, refusal(8)))
    assert request.station.refused is None
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (500,))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.serve(0.005, (0.004, refusal(8, function=6)))
    assert "exception 8 (write-protected" in (write.station.refused or "")


@pytest.mark.parametrize("code", [4, 6])
def test_exceptions_4_and_6_are_asked_again_after_a_pause(code: int) -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, refusal(code)))
    assert bench.times == [0.0]
    bench.serve(0.03)
    bench.serve(0.04, (0.036, GOOD))
    assert bench.times[:2] == [0.0, 0.03]
    assert request.station.refused is None
    assert len(bench.notes.replies) == 1


def test_a_device_that_stays_busy_is_lost() -> None:
    bench, request = polling()
    for number in range(1, 10):
        now = 0.03 * number
        bench.serve(now, (now - 0.01, refusal(6)))
    assert request.station.is_lost


def test_a_device_to_which_a_write_does_not_get_through_is_lost_although_it_is_read() -> None:
    bench, request = polling()
    write = bench.link.write(request.station, 6, 26, (500,), 0.45)
    bench.link.enable(write)
    for number in range(1, 200):
        now = 0.02 * number
        asked = bench.frames[-1][1]
        bench.serve(now, (now - 0.01, refusal(4, function=6) if asked == 6 else GOOD))
        if request.station.is_lost:
            break
    assert bench.notes.losses and bench.notes.replies
    assert request.station.counters.exceptions == {4: 3}


def test_a_reply_that_does_not_come_is_reported_unless_the_device_is_lost() -> None:
    bench, request = polling()
    for number in range(1, 100):
        bench.serve(0.05 * number)
        if request.station.is_lost:
            break
    assert (bench.notes.misses, len(bench.notes.losses)) == (2, 1)


@pytest.mark.parametrize("code", [10, 11])
def test_exceptions_of_a_gateway_mean_that_the_device_is_lost(code: int) -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, refusal(code)))
    assert request.station.is_lost
    assert bench.notes.losses == [0.0055]


def test_the_exception_to_another_function_is_not_ours() -> None:
    bench, request = polling()
    bench.serve(0.01, (0.0055, refusal(2, function=6)))
    assert request.station.refused is None
    assert request.station.counters.late == 1


def test_an_echo_of_another_value_does_not_confirm_a_write() -> None:
    bench = Bench()
    write = bench.link.write(bench.station(), 6, 26, (500,))
    bench.link.enable(write)
    bench.serve(0.0)
    bench.serve(0.005, (0.004, with_crc(bytes.fromhex("0106001A01F5"))))
    assert bench.notes.replies == []
    assert write.station.counters.late == 1


IMPAIRMENTS = (None, "late", "silence", "split", "corrupt", "noise", "lost", "wrong_id", "stale", "exception")


def three_devices_in_trouble(sparing: bool, period_s: float) -> Rig:
    """Return a line after 20 s with three devices, changing setpoints and every kind of impairment."""
    source, profiles = Quantities(), [load_profile(n) for n in ("simulated_jacket", "calex_pyrominibus")]
    cell = load_profile("four_axis_transmitter")
    slaves = (ControllerSlave(profiles[0], 1, source), IrSlave(profiles[1], 2, source), CellSlave(cell, 3, source))
    rig = Rig(38400, *slaves, period_s=period_s, sparing=sparing)
    jacket = TemperatureController("jacket", profiles[0], 1, rig.link)
    Sensor(profiles[1], 2, rig.link)
    Sensor(cell, 3, rig.link)
    for number, kind in enumerate(IMPAIRMENTS):
        if kind is not None:
            rig.wire.impair = Impairment(kind, count=4, skip=3, unit_id=number % 4)  # type: ignore[arg-type]

        def command(number: int = number) -> None:
            jacket.enable(number % 3 > 0)
            jacket.set_setpoint(40.0 + number + rig.now // 0.7)

        rig.run(2.0, command if number != 5 else None)
    return rig


@pytest.mark.parametrize("period_s", [0.01, 0.05])
def test_serving_the_link_only_on_request_sends_the_same_frames(period_s: float) -> None:
    always, sparing = (three_devices_in_trouble(mode, period_s) for mode in (False, True))
    assert len(always.log.frames) > 400
    frames, expected = ([(round(t, 9), *what) for t, *what in rig.log.frames] for rig in (sparing, always))
    assert frames == expected
    for one, other in zip(sparing.link.stations, always.link.stations, strict=True):
        assert one.counters == other.counters
        assert one.counters.timeouts > 0
