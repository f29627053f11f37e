from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest

from tester.service import service_link
from tester.service.commands import Hold, Stop
from tester.service.service_link import (
    FROM_GATEWAY,
    LINES_AT_ONCE,
    ORDERS_WAIT,
    FromGateway,
    GatewayEnd,
    LinkLost,
    Order,
    OwnerEnd,
    Presence,
)


@pytest.fixture
def pair() -> Iterator[tuple[OwnerEnd, socket.socket]]:
    ours, theirs = socket.socketpair()
    end = OwnerEnd(ours)
    with theirs:
        yield end, theirs
    end.close()


def test_lines_arrive_in_order(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    end.send(b"e1 {}")
    end.send_state(b"s{}")
    end.send(b"e2 {}")
    assert theirs.recv(100) == b"e1 {}\ns{}\ne2 {}\n"


def test_of_states_that_cannot_leave_only_the_newest_does_and_no_event_is_lost(
    pair: tuple[OwnerEnd, socket.socket],
) -> None:
    end, theirs = pair
    for number in range(300):
        end.send_state(b"s%d " % number + 10_000 * b"x")
        end.send(b"e%d" % number)
    heard = b""
    theirs.setblocking(False)
    while not heard.endswith(b"e299\n") and b"\ns299 " not in heard[-20_000:]:
        end.flush()
        heard += theirs.recv(1 << 20)
    end.flush()
    heard += theirs.recv(1 << 20) if not heard.endswith(b"x\n") else b""
    kinds = [line.split(b" ")[0] for line in heard.splitlines()]
    assert [kind for kind in kinds if kind.startswith(b"e")] == [b"e%d" % number for number in range(300)]
    states = [kind for kind in kinds if kind.startswith(b"s")]
    assert len(states) < 100 and states[-1] == b"s299"


def test_a_gateway_that_does_not_read_is_given_up(
    pair: tuple[OwnerEnd, socket.socket], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(service_link, "MOST_QUEUED", 1_000_000)
    end, _ = pair
    with pytest.raises(LinkLost, match="does not read"):
        for _ in range(1000):
            end.send(100_000 * b"x")


def test_no_client_can_delay_a_scan_by_sending(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    order = FROM_GATEWAY.dump_json(Order(1, "x", 1, Stop())) + b"\n"
    theirs.sendall(50 * order)
    counts: list[int] = []
    while found := end.receive():
        counts.append(len(found))
    assert max(counts) == LINES_AT_ONCE and sum(counts) == 50


def test_half_a_line_waits_for_its_end(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    line = FROM_GATEWAY.dump_json(Presence("me", 1, 0, False)) + b"\n"
    theirs.sendall(line[:20])
    assert end.receive() == []
    theirs.sendall(line[20:])
    assert end.receive() == [Presence("me", 1, 0, False)]


def test_the_end_of_the_gateway_is_noticed(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    theirs.close()
    with pytest.raises(LinkLost):
        end.receive()


def test_the_owner_reports_how_much_it_has_read(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    theirs.sendall(3 * (FROM_GATEWAY.dump_json(Order(1, "x", 1, Stop())) + b"\n"))
    assert len(end.receive()) == 3 and theirs.recv(100) == b"k3\n"


def test_a_gateway_that_sends_nonsense_is_dropped(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    theirs.sendall(b"what?\n")
    with pytest.raises(LinkLost, match="an unknown message"):
        end.receive()


def gateway_end() -> tuple[GatewayEnd, list[FromGateway]]:
    said: list[FromGateway] = []
    return GatewayEnd(lambda line: said.append(FROM_GATEWAY.validate_json(line))), said


def test_no_more_lines_are_on_their_way_than_the_owner_looks_at_in_one_go() -> None:
    end, said = gateway_end()
    for client in range(40):
        assert end.order(Order(client, "x", 1, Hold()))
    assert len(said) == LINES_AT_ONCE
    end.looked_at(3)
    assert len(said) == LINES_AT_ONCE + 3


def test_of_presences_that_cannot_leave_only_the_newest_does() -> None:
    end, said = gateway_end()
    for viewers in range(100_000):
        end.presence(Presence("", 0, viewers, False))
    end.looked_at(LINES_AT_ONCE)
    assert [one.viewers for one in said if isinstance(one, Presence)] == [*range(LINES_AT_ONCE), 99_999]


def test_stop_goes_before_all_that_waits() -> None:
    end, said = gateway_end()
    for client in range(40):
        end.order(Order(client, "x", 1, Hold()))
    end.presence(Presence("", 0, 1, False))
    end.stop(Order(99, "me", 7, Stop()))
    end.looked_at(1)
    assert said[-1] == Order(99, "me", 7, Stop())


def test_a_client_that_stops_without_end_has_one_stop_waiting_and_a_fast_one_stays() -> None:
    end, said = gateway_end()
    for number in range(LINES_AT_ONCE):
        end.stop(Order(1, "x", number, Stop()))
    assert end.stop(Order(1, "x", 10, Stop())) is None
    first = Order(1, "x", 11, Stop(fast=True))
    assert end.stop(first) == Order(1, "x", 10, Stop())
    assert end.stop(Order(1, "x", 12, Stop())) == Order(1, "x", 12, Stop())
    end.looked_at(5)
    assert said[LINES_AT_ONCE:] == [first]


def test_a_client_with_waiting_orders_is_informed() -> None:
    end, _ = gateway_end()
    taken = [end.order(Order(1, "x", number, Hold())) for number in range(LINES_AT_ONCE + ORDERS_WAIT + 1)]
    assert taken == [True] * (LINES_AT_ONCE + ORDERS_WAIT) + [False]
