"""The STOP lane with its real process."""

from __future__ import annotations

import os
import select
import socket
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from threading import Thread

import pytest

from tester.service.address import Address, TcpAddress, UnixAddress, new_tcp_address, stop_path
from tester.service.stop_call import NotTakenError, StopCall
from tester.service.stop_lane import StopLane, StopWish

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Unix sockets")


ME = f"me (user id {os.getuid()})" if hasattr(socket, "SO_PEERCRED") else "me (user id not known)"


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> UnixAddress:
    return UnixAddress(tmp_path_factory.mktemp("lane") / "service.sock")


@pytest.fixture(scope="module")
def lane(address: UnixAddress) -> Iterator[StopLane]:
    made = StopLane()
    made.open(address)
    yield made
    made.close()


def test_while_nothing_ticks_stop_is_answered_at_once_and_kept(lane: StopLane, address: Address) -> None:
    with StopCall(address, "me") as call:
        call.stop(fast=True)
    assert lane.wanted and lane.taken() == [StopWish(ME, True, 0)] and not lane.wanted


def test_at_most_two_unread_stops_are_kept(lane: StopLane, address: Address) -> None:
    with StopCall(address, "me") as call:
        for fast in (False, False, True, False, True):
            call.stop(fast=fast)
    assert [wish.fast for wish in lane.taken()] == [False, True]


def test_while_the_owner_ticks_it_answers_itself(lane: StopLane, address: Address) -> None:
    lane.begin_ticking()
    with StopCall(address, "me") as call:
        asking = Thread(target=call.stop)
        asking.start()
        assert select.select([lane.bell], [], [], 10.0)[0], "nobody rings"
        (wish,) = lane.taken()
        assert asking.is_alive()
        lane.answer(wish)
        asking.join(10.0)
        assert not asking.is_alive()
    lane.end_ticking()


def test_a_caller_waiting_at_the_end_of_the_run_is_answered(lane: StopLane, address: Address) -> None:
    lane.begin_ticking()
    with StopCall(address, "me") as call:
        asking = Thread(target=call.stop)
        asking.start()
        assert select.select([lane.bell], [], [], 10.0)[0], "nobody rings"
        lane.end_ticking()
        asking.join(10.0)
        assert not asking.is_alive() and [wish.number for wish in lane.taken()] == [0]


def test_a_door_that_dies_is_opened_again_and_a_kept_connection_is_renewed(tmp_path: Path) -> None:
    address, lane = UnixAddress(tmp_path / "s"), StopLane()
    lane.open(address)
    try:
        with StopCall(address, "me") as call:
            call.connect()
            process = lane._process  # pyright: ignore[reportPrivateUsage]
            assert process is not None
            process.kill()
            process.wait()
            while call.open:
                select.select([lane.bell], [], [], 0.01)
            while not lane.wanted:
                lane.look()
                select.select([lane.bell], [], [], 0.05)  # leaves the interpreter to the lane's thread
                with suppress(NotTakenError):
                    call.stop()
            assert lane._process is not process  # pyright: ignore[reportPrivateUsage]
    finally:
        lane.close()


def test_tcp_has_a_port_of_its_own_that_needs_the_token() -> None:
    address, lane = new_tcp_address(), StopLane()
    lane.open(address)
    try:
        with StopCall(TcpAddress(address.host, 0, address.token, lane.port), "me") as call:
            call.stop()
        with (
            StopCall(TcpAddress(address.host, 0, "guessed", lane.port), "me") as call,
            pytest.raises(NotTakenError),
        ):
            call.stop()
        assert len(lane.taken()) == 1
    finally:
        lane.close()


def test_a_missing_service_is_reported(tmp_path: Path) -> None:
    with StopCall(UnixAddress(tmp_path / "none"), "me") as call, pytest.raises(NotTakenError):
        call.stop()


def test_a_queue_before_the_door_that_is_full_is_waited_for(tmp_path: Path) -> None:
    address = UnixAddress(tmp_path / "service.sock")
    with socket.socket(socket.AF_UNIX) as door, socket.socket(socket.AF_UNIX) as other:
        door.bind(str(stop_path(address.path)))
        door.listen(0)
        other.connect(str(stop_path(address.path)))
        let_in: list[socket.socket] = []
        with StopCall(address, "me") as call:
            accepting = Thread(target=lambda: let_in.append(door.accept()[0]))
            accepting.start()
            call.connect()
            accepting.join()
            assert call.open and len(let_in) == 1
        let_in[0].close()
