"""The door for STOP, stepped by the test: no process, no waiting."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from tester.service.address import AddressError
from tester.service.stop_door import MOST_CALLERS, DoorSettings, StopDoor, open_listener

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Unix sockets")


class Bench:
    """A door between callers and an owner played by the test."""

    def __init__(self, folder: Path, *, uid: int | None = None, token: str = "") -> None:
        self.path = folder / "stop"
        self.listener = open_listener(DoorSettings(str(self.path)))
        self.owner, theirs = socket.socketpair()
        self.owner.setblocking(False)
        self.door = StopDoor(self.listener, theirs, uid=os.getuid() if uid is None else uid, token=token)
        self.callers: list[socket.socket] = []

    def call(self, text: str = "") -> socket.socket:
        caller = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.callers.append(caller)
        caller.connect(str(self.path))
        if text:
            caller.sendall(text.encode())
        caller.setblocking(False)
        self.turn()
        return caller

    def turn(self) -> None:
        for _ in range(4):
            self.door.turn(0.0)

    def told(self) -> list[str]:
        """Return the owner's messages, without numbers."""
        me = f" (user id {os.getuid()})"
        return [" ".join(line.split(" ")[2:]).replace(me, "") for line in self.lines()]

    def lines(self) -> list[str]:
        try:
            return self.owner.recv(10_000).decode().splitlines()
        except BlockingIOError:
            return []

    def answer(self, line: str) -> None:
        self.owner.sendall(line.split(" ")[1].encode() + b"\n")
        self.turn()

    def close(self) -> None:
        for one in (*self.callers, self.owner, self.listener, *(caller.connection for caller in self.door.callers)):
            one.close()


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    made = Bench(tmp_path)
    yield made
    made.close()


def heard(caller: socket.socket) -> bytes | None:
    """Return the received bytes, b"" for a hang-up, None for nothing."""
    try:
        return caller.recv(100)
    except BlockingIOError:
        return None
    except ConnectionResetError:
        return b""


def test_a_caller_is_answered_once_the_owner_has_taken_its_stop(bench: Bench) -> None:
    caller = bench.call("stop me\n")
    (line,) = bench.lines()
    assert line.endswith(f" stop me (user id {os.getuid()})") and heard(caller) is None
    bench.answer(line)
    assert heard(caller) == b"taken\n"


def test_a_caller_may_stop_again_over_the_same_connection(bench: Bench) -> None:
    caller = bench.call("stop me\n")
    bench.answer(bench.lines()[0])
    caller.sendall(b"fast me\n")
    bench.turn()
    assert bench.told() == ["fast me"]


def test_however_many_call_the_owner_has_one_line_before_it(bench: Bench) -> None:
    callers = [bench.call(f"stop {number}\n") for number in range(50)]
    lines = bench.lines()
    assert [line.split(" ")[3] for line in lines] == ["0"]
    bench.answer(lines[0])
    (second,) = bench.lines()
    bench.answer(second)
    assert bench.lines() == [] and [heard(caller) for caller in callers] == [b"taken\n"] * 50


def test_a_fast_stop_among_those_that_wait_makes_theirs_fast(bench: Bench) -> None:
    bench.call("stop a\n")
    first = bench.lines()[0]
    bench.call("stop b\n")
    bench.call("fast c\n")
    bench.call("stop d\n")
    bench.answer(first)
    assert bench.told() == ["fast b, c, d"]


def test_a_process_with_too_many_connections_loses_its_oldest(bench: Bench) -> None:
    first = bench.call()
    for _ in range(MOST_CALLERS):
        bench.call()
    assert len(bench.door.callers) == MOST_CALLERS and heard(first) == b""
    newest = bench.call("stop me\n")
    bench.answer(bench.lines()[0])
    assert heard(newest) == b"taken\n"


@pytest.mark.parametrize("text", ["go away\n", "GET / HTTP/1.1\r\n", "x" * 600], ids=["word", "http", "endless"])
def test_a_caller_that_sends_anything_else_is_hung_up(bench: Bench, text: str) -> None:
    assert heard(bench.call(text)) == b"" and bench.lines() == []


def test_a_caller_that_hangs_up_at_once_is_still_obeyed(bench: Bench) -> None:
    caller = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    caller.connect(str(bench.path))
    caller.sendall(b"stop me\n")
    caller.close()
    bench.turn()
    assert bench.told() == ["stop me"]


def test_a_name_cannot_write_control_characters(bench: Bench) -> None:
    bench.call("stop \x1b[31mred\x07\n")
    assert bench.told() == ["stop [31mred"]


def test_another_user_is_let_go_unheard(tmp_path: Path) -> None:
    bench = Bench(tmp_path, uid=4_000_000_000)
    try:
        assert heard(bench.call("stop me\n")) == b"" and bench.lines() == []
    finally:
        bench.close()


@pytest.mark.parametrize(("text", "told"), [("secret\nstop me\n", ["stop me"]), ("guess\nstop me\n", [])])
def test_where_there_is_a_token_it_is_shown_first(tmp_path: Path, text: str, told: list[str]) -> None:
    bench = Bench(tmp_path, token="secret")
    try:
        bench.call(text)
        assert bench.told() == told
    finally:
        bench.close()


def test_a_connection_that_has_ended_is_never_kept(bench: Bench) -> None:
    for _ in range(10):
        caller = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        caller.connect(str(bench.path))
        caller.close()
    bench.turn()
    assert not bench.door.callers


def test_a_flood_of_connections_leaves_four_fifths_of_the_time(
    bench: Bench, monkeypatch: pytest.MonkeyPatch
) -> None:
    times = iter([10.0, 10.0, 10.0, 10.001, 10.0015, 10.0019, 10.00201, 10.00205])
    slept: list[float] = []

    def sleep_until(until_s: float) -> None:
        slept.append(until_s)
        bench.door.ended = True

    monkeypatch.setattr("tester.service.stop_door.clock.cpu_time", lambda: next(times))
    monkeypatch.setattr("tester.service.stop_door.clock.monotonic", lambda: 500.0)
    monkeypatch.setattr("tester.service.stop_door.clock.sleep_until", sleep_until)
    callers = [socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) for _ in range(6)]
    for caller in callers:
        caller.connect(str(bench.path))
    bench.callers += callers
    bench.door.serve()
    assert len(bench.door.callers) == 4
    assert slept == [pytest.approx(500.0 + 4 * 0.00205)]


def test_the_door_ends_with_its_owner(bench: Bench) -> None:
    bench.owner.close()
    bench.turn()
    assert bench.door.ended


def test_the_socket_is_its_users_alone(bench: Bench) -> None:
    assert bench.path.stat().st_mode & 0o777 == 0o600


def test_a_file_in_the_socket_s_place_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "results.csv").write_text("mine")
    with pytest.raises(AddressError, match="is not a socket"):
        open_listener(DoorSettings(str(tmp_path / "results.csv")))
    assert (tmp_path / "results.csv").read_text() == "mine"
