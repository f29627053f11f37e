"""The Modbus TCP gateway in front of a simulated line, against bytes."""

from __future__ import annotations

from math import inf

import pytest

from sim.nodes.modbus_slave import READ_HOLDING, WRITE_ONE, ModbusSlave
from sim.servers.modbus_tcp import MOST_WAITING, PATIENCE_S, ModbusGateway, ModbusSession
from sim.wires.modbus_wire import Impairment, ModbusWire

READ = bytes.fromhex("1234 0000 0006 01 03 0000 0002")
REPLY = bytes.fromhex("1234 0000 0007 01 03 04 0007 0009")


@pytest.fixture
def gateway() -> ModbusGateway:
    """Return a gateway to one slave with address 1 and two registers, 7 and 9."""
    slave = ModbusSlave(1, 0.002, [(0, 2)], frozenset({READ_HOLDING, WRITE_ONE}))
    slave.put(0, bytes.fromhex("0007 0009"))
    return ModbusGateway(ModbusWire(115200, "N", [slave]))


def answers(gateway: ModbusGateway, session: ModbusSession) -> list[tuple[float, bytes]]:
    """Serve the gateway at its own times until nothing is due; return its replies with their times."""
    found: list[tuple[float, bytes]] = []
    while gateway.due_s < inf:
        now = gateway.due_s
        gateway.serve(now)
        if session.outgoing:
            found.append((now, bytes(session.outgoing)))
            session.outgoing.clear()
    return found


def test_a_read_is_answered_after_its_time_on_the_line(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, READ, 1.0)
    [(t, reply)] = answers(gateway, session)
    assert reply == REPLY
    # 8 and 9 characters of 10 bits, the silence that ends the request, the slave's turnaround
    assert t == pytest.approx(1.0 + 17 * 10 / 115200 + 0.00175 + 0.002)


def test_a_write_reaches_the_slave_and_is_echoed(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    write = bytes.fromhex("0001 0000 0006 01 06 0001 0055")
    gateway.take(session, write + READ, 1.0)
    first, second = answers(gateway, session)
    assert first[1] == write
    assert second[1] == bytes.fromhex("1234 0000 0007 01 03 04 0007 0055")


def test_an_exception_goes_back(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, bytes.fromhex("0001 0000 0006 01 03 0000 0009"), 1.0)
    [(_, reply)] = answers(gateway, session)
    assert reply == bytes.fromhex("0001 0000 0003 01 83 02")


def test_requests_sent_together_are_answered_one_after_the_other(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, READ * 3, 1.0)
    found = answers(gateway, session)
    assert [reply for _, reply in found] == [REPLY] * 3
    assert gateway.wire.collisions == 0


def test_an_absent_slave_is_silent_and_the_next_request_is_served(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, bytes.fromhex("0001 0000 0006 09 03 0000 0002") + READ, 1.0)
    [(t, reply)] = answers(gateway, session)
    assert reply == REPLY
    assert t > 1.0 + PATIENCE_S


def test_a_reply_that_was_spoilt_on_the_line_is_not_passed_on(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.wire.impair = Impairment("corrupt")
    gateway.take(session, READ, 1.0)
    assert answers(gateway, session) == []


def test_a_reply_in_two_pieces_is_put_together(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.wire.impair = Impairment("split", delay_s=0.01)
    gateway.take(session, READ, 1.0)
    assert [reply for _, reply in answers(gateway, session)] == [REPLY]


def test_a_broadcast_has_no_answer_and_takes_no_time(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, bytes.fromhex("0001 0000 0006 00 06 0000 0011"), 1.0)
    assert gateway.due_s == inf
    gateway.take(session, READ, 2.0)
    assert [reply for _, reply in answers(gateway, session)] == [bytes.fromhex("1234 0000 0007 01 03 04 0011 0009")]


def test_an_unplugged_line_is_silent(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.wire.disconnect()
    gateway.take(session, READ, 1.0)
    assert answers(gateway, session) == []


def test_each_client_gets_its_own_replies(gateway: ModbusGateway) -> None:
    one, other = ModbusSession(), ModbusSession()
    gateway.take(one, READ, 1.0)
    gateway.take(other, b"\x99\x99" + READ[2:], 1.0)
    while gateway.due_s < inf:
        gateway.serve(gateway.due_s)
    assert one.outgoing == REPLY
    assert other.outgoing == b"\x99\x99" + REPLY[2:]


def test_requests_of_a_gone_client_are_dropped(gateway: ModbusGateway) -> None:
    one, other = ModbusSession(), ModbusSession()
    gateway.take(one, READ * 3, 1.0)
    gateway.forget(one)
    gateway.take(other, READ, 1.0)
    assert len(answers(gateway, other)) == 1
    assert gateway.wire.requests == 2  # one's first was on the line already


def test_the_next_client_does_not_wait_for_a_slave_that_is_silent_to_a_gone_client(gateway: ModbusGateway) -> None:
    one, other = ModbusSession(), ModbusSession()
    gateway.take(one, bytes.fromhex("0001 0000 0006 09 03 0000 0002"), 1.0)
    gateway.take(other, READ, 1.0)
    gateway.forget(one)
    assert gateway.due_s <= 1.001
    gateway.serve(1.001)
    [(t, reply)] = answers(gateway, other)
    assert reply == REPLY
    assert t == pytest.approx(1.001 + 17 * 10 / 115200 + 0.00175 + 0.002)


def test_a_reply_to_a_gone_client_is_let_pass_before_the_next_request(gateway: ModbusGateway) -> None:
    one, other = ModbusSession(), ModbusSession()
    gateway.wire.impair = Impairment("split", delay_s=0.01)
    gateway.take(one, READ, 1.0)
    gateway.take(other, b"\x99\x99" + READ[2:], 1.0)
    gateway.forget(one)
    assert gateway.due_s > 1.0
    [(_, reply)] = answers(gateway, other)
    assert (reply, bytes(one.outgoing)) == (b"\x99\x99" + REPLY[2:], b"")
    assert gateway.wire.collisions == 0


def test_a_request_of_a_gone_client_on_an_unplugged_line_is_dropped(gateway: ModbusGateway) -> None:
    one = ModbusSession()
    gateway.take(one, READ, 1.0)
    gateway.wire.disconnect()
    gateway.forget(one)
    assert gateway.due_s == inf


def test_a_client_cannot_pile_requests_up(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    gateway.take(session, READ * 100, 1.0)
    assert len(answers(gateway, session)) == MOST_WAITING


def test_a_request_may_come_in_pieces(gateway: ModbusGateway) -> None:
    session = ModbusSession()
    for byte in READ:
        gateway.take(session, bytes((byte,)), 1.0)
    assert [reply for _, reply in answers(gateway, session)] == [REPLY]


@pytest.mark.parametrize("header", ["0001 0001 0006 01", "0001 0000 0001 01", "0001 0000 0100 01"])
def test_bytes_that_are_not_modbus_tcp_end_the_connection(header: str) -> None:
    session = ModbusSession()
    assert session.feed(bytes.fromhex(header) + b"\x03\x00\x00\x00\x02") == []
    assert session.ended
