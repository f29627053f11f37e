from __future__ import annotations

import socket
from collections.abc import Iterator

import pytest

from tester.service import link
from tester.service.commands import Stop
from tester.service.link import FROM_GATEWAY, LINES_AT_ONCE, LinkLost, Order, OwnerEnd, Presence


@pytest.fixture
def pair() -> Iterator[tuple[OwnerEnd, socket.socket]]:
    ours, theirs = socket.socketpair()
    end = OwnerEnd(ours)
    with theirs:
        yield end, theirs
    end.close()


def test_lines_arrive_in_order(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    end.say(b"e1 {}")
    end.say_state(b"s{}")
    end.say(b"e2 {}")
    assert theirs.recv(100) == b"e1 {}\ns{}\ne2 {}\n"


def test_of_states_that_cannot_leave_only_the_newest_does_and_no_event_is_lost(
    pair: tuple[OwnerEnd, socket.socket],
) -> None:
    end, theirs = pair
    for number in range(300):
        end.say_state(b"s%d " % number + 10_000 * b"x")
        end.say(b"e%d" % number)
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
    monkeypatch.setattr(link, "MOST_QUEUED", 1_000_000)
    end, _ = pair
    with pytest.raises(LinkLost, match="does not read"):
        for _ in range(1000):
            end.say(100_000 * b"x")


def test_nobody_can_hold_up_a_scan_by_talking(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    order = FROM_GATEWAY.dump_json(Order(1, "x", 1, Stop())) + b"\n"
    theirs.sendall(50 * order)
    counts: list[int] = []
    while found := end.hear():
        counts.append(len(found))
    assert max(counts) == LINES_AT_ONCE and sum(counts) == 50


def test_half_a_line_waits_for_its_end(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    line = FROM_GATEWAY.dump_json(Presence("me", 1, 0, False)) + b"\n"
    theirs.sendall(line[:20])
    assert end.hear() == []
    theirs.sendall(line[20:])
    assert end.hear() == [Presence("me", 1, 0, False)]


def test_the_end_of_the_gateway_is_noticed(pair: tuple[OwnerEnd, socket.socket]) -> None:
    end, theirs = pair
    theirs.close()
    with pytest.raises(LinkLost):
        end.hear()
