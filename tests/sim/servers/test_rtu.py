"""The far end of a serial port on a simulated line: the end of a request, and the arrival of its reply."""

from __future__ import annotations

from math import inf

import pytest

from drivers.crc16 import with_crc
from drivers.profiles import load_profile
from sim.nodes.sensor_slave import CellSlave
from sim.servers.rtu import LONGEST_FRAME, RtuEar
from sim.wires.modbus_wire import ModbusWire
from tests.drivers.modbus_rig import Quantities

READ = with_crc(bytes.fromhex("01 03 0000 0001"))
OTHER = with_crc(bytes.fromhex("02 03 0000 0001"))
REPLY_BYTES = 7


def line(baud: int = 9600) -> RtuEar:
    cells = [CellSlave(load_profile("four_axis_transmitter"), unit, Quantities()) for unit in (1, 2)]
    return RtuEar(ModbusWire(baud, "N", cells))


def reply(ear: RtuEar) -> tuple[float, bytes]:
    """Serve the line when it asks for it, until something arrives."""
    for _ in range(4):
        t = ear.due_s
        if data := ear.serve(t):
            return t, data
    return inf, b""


@pytest.mark.parametrize("baud", [9600, 19200, 38400, 115200])
def test_a_reply_takes_the_characters_and_the_silence_of_its_line(baud: int) -> None:
    ear = line(baud)
    ear.hear(READ, 1.0)
    character_s = 10 / baud
    gap_s = 3.5 * character_s if baud <= 19200 else 0.00175
    turnaround_s = CellSlave(load_profile("four_axis_transmitter"), 1, Quantities()).turnaround_s
    t, data = reply(ear)
    assert t - 1.0 == pytest.approx((len(READ) + REPLY_BYTES) * character_s + gap_s + turnaround_s)
    assert (data[0], len(data)) == (1, REPLY_BYTES)


def test_a_request_in_pieces_is_one_while_the_line_is_not_silent() -> None:
    ear = line()
    ear.hear(READ[:3], 1.0)
    assert ear.serve(1.004) == b""
    ear.hear(READ[3:], 1.005)
    assert reply(ear)[1][0] == 1


def test_a_request_in_two_is_none_when_silence_came_between() -> None:
    ear = line()
    ear.hear(READ[:3], 1.0)
    assert ear.serve(1.1) == b""
    ear.hear(READ[3:], 1.1)
    assert reply(ear) == (inf, b"")


def test_several_slaves_answer_on_one_line() -> None:
    ear = line()
    units: list[int] = []
    for t, request in ((1.0, READ), (2.0, OTHER), (3.0, READ)):
        ear.hear(request, t)
        units.append(reply(ear)[1][0])
    assert units == [1, 2, 1]


def test_a_request_during_a_reply_spoils_both() -> None:
    ear = line()
    ear.hear(READ, 1.0)
    ear.serve(ear.due_s)  # the slave has the line now
    ear.hear(OTHER, ear.due_s - 0.003)
    _, data = reply(ear)
    assert data[:2] != b"\x01\x03"
    assert ear.wire.collisions == 1


def test_bytes_at_another_baud_rate_are_not_understood() -> None:
    ear = line()
    ear.hear(READ, 1.0, understood=False)
    assert (ear.due_s, ear.garbled) == (inf, len(READ))


def test_a_frame_that_is_too_long_reaches_no_slave() -> None:
    ear = line(115200)
    ear.hear(bytes(LONGEST_FRAME + 1), 1.0)
    assert reply(ear) == (inf, b"")
    assert ear.garbled == LONGEST_FRAME + 1


def test_an_unplugged_line_is_silent_and_asks_for_nothing() -> None:
    ear = line()
    ear.wire.disconnect()
    ear.hear(READ, 1.0)
    assert ear.serve(ear.due_s) == b""
    assert ear.due_s == inf
