"""The simulated Modbus line: wire times, silence, collisions, faults."""

from __future__ import annotations

import copy
from math import inf

import pytest

from drivers.crc16 import with_crc
from drivers.ports import BusLost
from sim.nodes.modbus_slave import ModbusSlave
from sim.wires.modbus_wire import Impairment, Kind, ModbusWire
from tests.drivers.modbus_rig import Log

READ_NINE = with_crc(bytes.fromhex("010300000009"))
WRITE = with_crc(bytes.fromhex("010600000007"))
CHARACTER_S = 10 / 115200


def wire(baud: int = 115200) -> tuple[ModbusWire, ModbusSlave]:
    slave = ModbusSlave(1, 0.001, [(0, 20)], frozenset({3, 6}))
    return ModbusWire(baud, "N", [slave]), slave


def exchange(line: ModbusWire, frame: bytes, now: float = 0.0) -> list[tuple[float, bytes]]:
    line.write(frame, now)
    return line.read(now + 1.0)


def test_a_reply_arrives_after_request_silence_turnaround_and_reply() -> None:
    line, _ = wire()
    ((arrival, data),) = exchange(line, READ_NINE)
    assert len(data) == 23
    assert arrival == pytest.approx(8 * CHARACTER_S + 0.00175 + 0.001 + 23 * CHARACTER_S)


def test_ten_registers_at_115200_without_turnaround_take_the_computed_time() -> None:
    # Design page, RTU wire limit: 6.36 ms with both silences; the last is the master's.
    slave = ModbusSlave(1, 0.0, [(0, 20)], frozenset({3}))
    line = ModbusWire(115200, "N", [slave])
    ((arrival, _),) = exchange(line, with_crc(bytes.fromhex("01030000000A")))
    assert arrival + 0.00175 == pytest.approx(6.36e-3, abs=0.01e-3)


def test_parity_makes_characters_of_eleven_bits_and_slow_lines_longer_silences() -> None:
    slave = ModbusSlave(1, 0.0, [(0, 20)], frozenset({3}))
    line = ModbusWire(19200, "E", [slave])
    ((arrival, _),) = exchange(line, with_crc(bytes.fromhex("01030000000A")))
    assert arrival + 3.5 * 11 / 19200 == pytest.approx(22.9e-3, abs=0.1e-3)


def test_nothing_is_there_before_its_arrival() -> None:
    line, _ = wire()
    line.write(READ_NINE, 0.0)
    assert line.read(0.0054) == []
    assert len(line.read(0.0055)) == 1
    assert line.read(1.0) == []


def test_the_slave_is_asked_when_the_request_has_arrived() -> None:
    times: list[float] = []

    class Watch(ModbusSlave):
        def refresh(self, t: float) -> None:
            times.append(t)

    line = ModbusWire(115200, "N", [Watch(1, 0.001, [(0, 20)], frozenset({3}))])
    line.write(READ_NINE, 2.0)
    assert times == [pytest.approx(2.0 + 8 * CHARACTER_S + 0.00175)]


def test_an_absent_address_is_silent() -> None:
    line, _ = wire()
    assert exchange(line, with_crc(bytes.fromhex("090300000009"))) == []


def test_a_request_with_a_bad_crc_is_ignored() -> None:
    line, _ = wire()
    assert exchange(line, READ_NINE[:-1] + b"\x00") == []


def test_a_broadcast_reaches_every_slave() -> None:
    line, first = wire()
    second = ModbusSlave(2, 0.001, [(0, 20)], frozenset({6}))
    line.attach(second)
    assert exchange(line, with_crc(bytes.fromhex("000600030005"))) == []
    assert (first.get(3), second.get(3)) == (5, 5)


def test_two_slaves_with_one_address_are_refused() -> None:
    line, slave = wire()
    with pytest.raises(ValueError, match="address 1"):
        line.attach(slave)


def test_speaking_while_a_slave_speaks_spoils_both() -> None:
    line, slave = wire()
    line.write(READ_NINE, 0.0)
    line.write(WRITE, 0.004)
    assert line.collisions == 1
    assert slave.get(0) == 0
    assert all(with_crc(data[:-2]) != data for _, data in line.read(1.0))


def test_a_watcher_sees_both_directions_with_their_times() -> None:
    line, _ = wire()
    log = Log()
    line.watch(log.frame)
    ((arrival, data),) = exchange(line, READ_NINE)
    assert log.frames == [(pytest.approx(8 * CHARACTER_S), READ_NINE, True), (arrival, data, False)]


def test_occupation_counts_characters_only() -> None:
    line, _ = wire()
    exchange(line, READ_NINE)
    assert line.occupied_s == pytest.approx(31 * CHARACTER_S)


def test_an_unplugged_adapter_raises_and_loses_pending_bytes() -> None:
    line, _ = wire()
    line.write(READ_NINE, 0.0)
    line.disconnect()
    with pytest.raises(BusLost):
        line.read(0.001)
    with pytest.raises(BusLost):
        line.write(READ_NINE, 0.002)
    line.reconnect()
    assert line.read(1.0) == []
    assert len(exchange(line, READ_NINE, 1.0)) == 1


def test_it_reports_when_there_is_something_to_read() -> None:
    line, _ = wire()
    assert line.arrives_s == inf
    line.write(READ_NINE, 0.0)
    due = line.arrives_s
    assert line.read(due - 1e-6) == []
    assert [t for t, _ in line.read(due)] == [due]
    assert line.arrives_s == inf
    line.disconnect()
    assert line.arrives_s == -inf
    line.reconnect()
    assert line.arrives_s == inf


def spoilt(kind: str, **more: float) -> tuple[list[tuple[float, bytes]], tuple[float, bytes], ModbusSlave]:
    """Return the received bytes of a corrupted write, the sent ones, and the slave."""
    good, _ = wire()
    (expected,) = exchange(good, WRITE)
    line, slave = wire()
    line.impair = Impairment(kind, **more)  # type: ignore[arg-type]
    return exchange(line, WRITE), expected, slave


def test_silence_means_that_the_slave_does_nothing() -> None:
    chunks, _, slave = spoilt("silence")
    assert chunks == []
    assert slave.get(0) == 0


def test_lost_means_that_the_slave_acts_and_the_reply_is_gone() -> None:
    chunks, _, slave = spoilt("lost")
    assert chunks == []
    assert slave.get(0) == 7


def test_late_means_later_by_the_delay() -> None:
    ((arrival, data),), expected, _ = spoilt("late", delay_s=0.03)
    assert data == expected[1]
    assert arrival == pytest.approx(expected[0] + 0.03)


def test_split_means_in_two_pieces() -> None:
    chunks, expected, _ = spoilt("split", delay_s=0.01)
    assert b"".join(data for _, data in chunks) == expected[1]
    assert chunks[1][0] - chunks[0][0] > 0.01


@pytest.mark.parametrize("kind", ["corrupt", "truncate"])
def test_a_spoilt_reply_has_no_good_crc(kind: str) -> None:
    ((_, data),), _, _ = spoilt(kind)
    assert with_crc(data[:-2]) != data


def test_noise_comes_before_the_reply() -> None:
    ((_, data),), expected, _ = spoilt("noise")
    assert data.endswith(expected[1])
    assert len(data) > len(expected[1])


def test_a_wrong_id_has_a_good_crc() -> None:
    ((_, data),), _, _ = spoilt("wrong_id")
    assert data[0] != 1
    assert with_crc(data[:-2]) == data


def test_an_exception_comes_instead_of_the_action() -> None:
    ((_, data),), _, slave = spoilt("exception", code=6)
    assert data == with_crc(bytes.fromhex("018606"))
    assert slave.get(0) == 0


def test_stale_is_the_reply_before() -> None:
    line, _ = wire()
    ((_, first),) = exchange(line, READ_NINE)
    line.impair = Impairment("stale")
    ((_, data),) = exchange(line, WRITE, 2.0)
    assert data == first


def registers(frame: bytes) -> list[int]:
    assert with_crc(frame[:-2]) == frame
    return [int.from_bytes(frame[at : at + 2], "big") for at in range(3, len(frame) - 2, 2)]


def test_swapped_words_change_places_in_pairs_and_the_crc_is_good() -> None:
    line, slave = wire()
    slave.put(0, bytes.fromhex("000100020003000400050006000700080009"))
    line.impair = Impairment("swapped")
    ((_, data),) = exchange(line, READ_NINE)
    assert registers(data) == [2, 1, 4, 3, 6, 5, 8, 7, 9]


def test_a_torn_value_has_its_first_word_from_the_reply_before() -> None:
    line, slave = wire()
    slave.put(0, bytes.fromhex("FFFFFFFE"))
    exchange(line, READ_NINE)
    slave.put(0, bytes.fromhex("00000003"))
    line.impair = Impairment("torn")
    ((_, data),) = exchange(line, READ_NINE, 1.0)
    assert registers(data)[:2] == [0xFFFF, 0x0003]


@pytest.mark.parametrize("kind", ["swapped", "torn"])
def test_the_confirmation_of_a_write_has_no_words_to_mix_up(kind: Kind) -> None:
    line, _ = wire()
    line.impair = Impairment(kind, -1)
    ((_, data),) = exchange(line, WRITE)
    assert data == WRITE


def test_every_second_of_merged_replies_comes_with_the_next_in_one_piece() -> None:
    line, slave = wire()
    line.impair = Impairment("merged", -1)
    slave.put(0, b"\x00\x01")
    assert exchange(line, READ_NINE) == []
    slave.put(0, b"\x00\x02")
    ((_, data),) = exchange(line, READ_NINE, 1.0)
    assert (registers(data[:23])[0], registers(data[23:])[0]) == (1, 2)
    assert exchange(line, READ_NINE, 2.0) == []


def test_an_impairment_waits_for_its_turn_and_ends_with_its_count() -> None:
    line, _ = wire()
    line.impair = Impairment("silence", count=2, skip=1)
    answered = [bool(exchange(line, READ_NINE, 2.0 * number)) for number in range(5)]
    assert answered == [True, False, False, True, True]


def test_an_impairment_concerns_its_slave_only() -> None:
    line, _ = wire()
    line.attach(ModbusSlave(2, 0.001, [(0, 20)], frozenset({3})))
    line.impair = Impairment("silence", count=-1, unit_id=2)
    assert exchange(line, READ_NINE)
    assert not exchange(line, with_crc(bytes.fromhex("020300000009")), 2.0)


def test_a_copy_of_a_line_lives_on_its_own() -> None:
    line, slave = wire()
    line.write(READ_NINE, 0.0)
    twin = copy.deepcopy(line)
    line.disconnect()
    assert len(twin.read(1.0)) == 1
    exchange(twin, WRITE, 2.0)
    assert slave.get(0) == 0
