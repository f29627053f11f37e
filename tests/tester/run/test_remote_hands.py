"""A run whose attendant is the console of a simulated machine."""

from __future__ import annotations

import inspect
import socket
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace

import pytest

from drivers.ports import BusLost
from sim import machines
from sim.hands import DONE, REFUSED
from sim.machines.specimen_on_track import VERBS
from sim.machines.specimen_on_track.rig import TrackRig
from tester.inputs.rig import Rig
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.context import TrackAttendant
from tester.kinds.wheel_on_belt.context import Attendant
from tester.machine.run import Outcome
from tester.run.remote_hands import (
    PATIENCE_S,
    RemoteHands,
    SocketStream,
    refused_hands,
    remote_hands,
    split_place,
    unattended,
)
from tests.tester.kinds.specimen_on_track.bench import DISC, GROSCH
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.run.reached import reached_over_tcp
from tests.tester.run.rehearsed import Kept, Rehearsal

BLOCK = GROSCH.replace("[0.1 mm/s, 3 mm/s]", "3 mm/s")
WHEEL = SHORT.replace("1#", "3#")
RECIPES = {"pin-on-disc": DISC, "grosch": BLOCK, "sim": WHEEL}
MOUNTED = {"pin-on-disc": "specimen 1 SBR", "grosch": "specimen 1 SBR", "sim": "wheel 1 1 '3#' yes"}


class Scripted:
    """A channel with answers from a test."""

    def __init__(self) -> None:
        self.sent: list[str] = []
        self.answers: list[bytes | OSError] = []
        self.broken = False

    def send(self, data: bytes) -> None:
        if self.broken:
            raise BrokenPipeError
        self.sent.append(data.decode())

    def receive(self) -> bytes:
        if not self.answers:
            return b""
        answer = self.answers.pop(0)
        if isinstance(answer, OSError):
            raise answer
        return answer

    def close(self) -> None:
        self.sent.append("closed")


@pytest.fixture
def channel() -> Scripted:
    return Scripted()


@pytest.fixture
def kept() -> Kept:
    return Kept()


@pytest.fixture
def hands(channel: Scripted, kept: Kept) -> RemoteHands:
    return RemoteHands(channel, VERBS, "here", kept)


# -- whole runs ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", RECIPES)
def test_a_run_through_the_console_measures_the_same_as_a_run_in_one_process(name: str) -> None:
    rig = load_rig(name)
    here, there = (Rehearsal(rig, RECIPES[name], remote=remote, seed=3).to_the_end() for remote in (False, True))
    assert there.run.outcome is Outcome.DONE and not there.kept.trips
    assert len(there.kept.repeats) == len(here.kept.repeats) > 0
    for ours, theirs in zip(here.kept.repeats, there.kept.repeats, strict=True):
        assert theirs.valid and theirs.mu_resultant == pytest.approx(ours.mu_resultant, rel=2e-3)
    assert there.kept.hands == there.channel.lines
    assert MOUNTED[name] in there.channel.lines


def test_a_person_s_work_comes_in_the_order_of_the_prompts() -> None:
    there = Rehearsal(load_rig("pin-on-disc"), DISC, remote=True).to_the_end()
    work = [line for line in there.kept.hands if not line.startswith("repeat")]
    assert work == [
        "specimen 1 SBR", "raise", "hang 10.0 N", "track dry", "lower", "raise", "hang 10.0 N", "track wet", "lower",
        "raise",
    ]  # fmt: skip


def test_nothing_moves_before_the_work_is_done_and_without_an_answer_the_run_ends() -> None:
    there = Rehearsal(load_rig("pin-on-disc"), DISC, remote=True)
    there.channel.deaf_to = "lower"
    assert isinstance(there.world, TrackRig)
    while "lower" not in there.channel.lines:
        assert not there.run.finished
        there.tick()
    asked_s = there.now
    while not there.run.engine.executor.finished:
        assert there.world.track_m_s == 0.0 and not there.run.finished
        there.tick()
    assert there.now - asked_s == pytest.approx(PATIENCE_S, abs=0.3)
    there.to_the_end()
    assert there.run.outcome is Outcome.FAILED and "no answer within 5 s" in there.run.reason
    assert "the hands at the console: lower: " in there.run.reason and not there.kept.trips


def test_a_refusal_by_the_machine_ends_the_run_with_the_reason() -> None:
    rig = load_rig("pin-on-disc")
    there = Rehearsal(rig, DISC, remote=True)
    refuse = there.channel.console.command

    def command(line: str, now: float) -> list[str]:
        return list(refuse(line.replace("SBR", "XYZ"), now))

    there.channel.console.command = command  # type: ignore[method-assign]
    there.to_the_end()
    assert there.run.outcome is Outcome.FAILED
    assert "specimen 1 SBR: not done: " in there.run.reason and "XYZ" in there.run.reason


# -- one line -----------------------------------------------------------------------------------------------------


def test_it_is_busy_until_the_answer_is_complete(hands: RemoteHands, channel: Scripted, kept: Kept) -> None:
    assert not hands.busy(0.0)
    hands.put_on(20.0)
    assert channel.sent == ["hang 20.0 N\n"] and hands.busy(0.1)
    channel.answers += [DONE.encode(), b"hang 20.0 N\n", b"\n"]
    assert [hands.busy(0.2), hands.busy(0.3), hands.busy(0.4)] == [True, True, False]
    assert kept.hands == ["hang 20.0 N"] and not hands.failed


def test_answers_of_several_lines_are_distinguished(hands: RemoteHands, channel: Scripted, kept: Kept) -> None:
    hands.install(1, "SBR")
    hands.raise_arm()
    channel.answers.append(f"{DONE}specimen 1 SBR\n\n{REFUSED}stuck\n\n".encode())
    assert not hands.busy(0.1)
    assert kept.hands == ["specimen 1 SBR"] and hands.failed == "the hands at here: raise: not done: stuck"


@pytest.mark.parametrize("answer", [b"unknown command 'raise'; help lists them\n\n", ConnectionResetError("gone")])
def test_anything_but_done_is_a_failure(hands: RemoteHands, channel: Scripted, answer: bytes | OSError) -> None:
    hands.raise_arm()
    channel.answers.append(answer)
    assert not hands.busy(0.1) and hands.failed.startswith("the hands at here: raise: ")


def test_a_console_that_has_gone_is_a_failure_at_once(hands: RemoteHands, channel: Scripted) -> None:
    channel.broken = True
    hands.raise_arm()
    assert not hands.busy(0.0) and hands.failed.startswith("the hands at here: raise: ")


def test_an_answer_is_waited_for_from_the_first_scan_after_the_line(hands: RemoteHands) -> None:
    hands.raise_arm()
    assert hands.busy(100.0) and hands.busy(100.0 + PATIENCE_S)
    assert not hands.busy(100.1 + PATIENCE_S) and "no answer within" in hands.failed


def test_work_without_a_verb_is_a_failure_and_hidden_names_are_none(hands: RemoteHands, channel: Scripted) -> None:
    with pytest.raises(AttributeError):
        hands._fetch  # noqa: B018
    hands.juggle(3)
    assert hands.failed == "the hands at here: this kind of machine has no verb for juggle" and not channel.sent


@pytest.mark.parametrize(
    ("kind", "attendant", "elsewhere"),
    [("specimen_on_track", TrackAttendant, set[str]()), ("wheel_on_belt", Attendant, {"remount"})],
)
def test_whatever_a_run_asks_of_its_attendant_has_a_verb(kind: str, attendant: type, elsewhere: set[str]) -> None:
    asked = {name for name, _ in inspect.getmembers(attendant, inspect.isfunction) if not name.startswith("_")}
    verbs = {verb.method for verb in machines.find(kind).verbs}
    assert asked - verbs == elsewhere  # only manual mode, in one process, mounts what an earlier run left


# -- the console's address ----------------------------------------------------------------------------------------


@pytest.fixture
def listener() -> Iterator[socket.socket]:
    with closing(socket.create_server(("127.0.0.1", 0))) as server:
        yield server


def test_a_socket_carries_lines_and_reports_its_end(listener: socket.socket) -> None:
    with closing(SocketStream(f"127.0.0.1:{listener.getsockname()[1]}")) as channel:
        far, _ = listener.accept()
        assert channel.receive() == b""
        channel.send(b"raise\n")
        assert far.recv(100) == b"raise\n"
        far.sendall(b"done")
        far.shutdown(socket.SHUT_WR)
        received = b""
        with pytest.raises(ConnectionResetError):
            while True:
                received += channel.receive()
        assert received == b"done"
        far.close()


def test_without_a_console_the_rig_is_unreachable(listener: socket.socket, kept: Kept) -> None:
    place = f"127.0.0.1:{listener.getsockname()[1]}"
    listener.close()
    with pytest.raises(BusLost, match=f"no console at {place}"):
        remote_hands(place, load_rig("pin-on-disc"), kept)


@pytest.mark.parametrize("place", ["4711", ":4711", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:70000", "here:there"])
def test_an_address_is_a_host_and_a_port(place: str) -> None:
    with pytest.raises(ValueError, match="HOST:PORT"):
        split_place(place)
    assert "HOST:PORT" in refused_hands(place, reached("pin-on-disc"))


def test_hands_are_for_a_simulated_machine_in_another_process() -> None:
    simulated, behind = load_rig("pin-on-disc"), reached("pin-on-disc")
    real = replace(behind, axes=replace(behind.axes, track=replace(behind.axes.track, vendor_id=1)))  # type: ignore
    place = "127.0.0.1:4711"
    assert "in this process" in refused_hands(place, simulated) and "is real" in refused_hands(place, real)
    assert refused_hands(place, behind) == refused_hands("", real) == ""


def test_answers_without_hands_are_warned_of() -> None:
    simulated, behind = load_rig("pin-on-disc"), reached("pin-on-disc")
    assert "--hands" in unattended("", behind, answered=True)
    assert not unattended("127.0.0.1:4711", behind, answered=True) and not unattended("", behind, answered=False)
    assert not unattended("", simulated, answered=True)


def reached(name: str) -> Rig:
    """Return a rig as a machine behind TCP doors."""
    rig = load_rig(name)
    lines = {line: ("127.0.0.1", 1000 + number) for number, line in enumerate(rig.lines)}
    return reached_over_tcp(rig, ("127.0.0.1", 29536), lines)  # type: ignore[arg-type]
