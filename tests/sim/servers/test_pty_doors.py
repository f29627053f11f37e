"""Doors on pseudo-terminals: pyserial and python-can at one end, the rig at the other, a clock set by hand."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from sim.servers.doors import Doors
from sim.servers.pty import MOST_UNSENT, NONE_HERE, Pty
from sim.servers.pty_doors import RtuDoor, SlcanDoor
from sim.servers.server import RigServer
from tester.kinds import load_rig
from tester.run.simulated import simulated_ports
from tests.sim.servers.test_rtu import READ

MOST_KEPT = 1 << 20
"""Bytes: more than any system keeps in a terminal."""

posix = pytest.mark.skipif(sys.platform == "win32", reason="this system has no pseudo-terminals")


class Bench:
    """A server on pseudo-terminals whose clock advances only on command."""

    def __init__(self, folder: Path) -> None:
        _, rig, hands = simulated_ports(load_rig("sim", ("sim.noise=0",)), 1, None)
        hands.install(0, 0, "1#", new_specimen=True)
        self.server = RigServer(rig, "", 0, doors=Doors("slcan", "rtu", links=str(folder)))
        self.t = 0.0

    def run(self, seconds: float) -> None:
        end = self.t + seconds
        while self.t < end:
            self.t += 0.001
            self.server.turn(lambda: self.t)


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    bench = Bench(tmp_path / "links")
    yield bench
    bench.server.close()


def heard(bus: can.BusABC) -> set[int]:
    """Return the identifiers of waiting frames, past the adapter's answers to commands."""
    messages = [bus.recv(0.0) for _ in range(200)]
    return {message.arbitration_id for message in messages if message is not None}


@posix
def test_pyserial_reads_a_slave_in_the_times_of_the_line(bench: Bench, tmp_path: Path) -> None:
    from serial import Serial

    with Serial(str(tmp_path / "links" / "load_cell"), 115200, timeout=0.0, exclusive=True) as port:
        port.write(READ)
        bench.run(0.002)
        assert port.in_waiting == 0, "the request and its silence take 2.4 ms"
        bench.run(0.01)
        assert port.read(100)[:3] == bytes.fromhex("01 03 02")


@posix
def test_a_port_at_another_baud_rate_gets_no_answer(bench: Bench, tmp_path: Path) -> None:
    from serial import Serial

    with Serial(str(tmp_path / "links" / "load_cell"), 9600, timeout=0.0) as port:
        port.write(READ)
        bench.run(0.1)
        assert port.in_waiting == 0
    door = bench.server.lines["load_cell"]
    assert isinstance(door, RtuDoor)
    assert door.ear.garbled == len(READ)


@posix
def test_python_can_receives_the_nodes_boot_up_and_an_answer(bench: Bench, tmp_path: Path) -> None:
    bus = can.Bus(interface="slcan", channel=str(tmp_path / "links" / "can"), bitrate=500_000, sleep_after_open=0.0)
    try:
        assert not bench.server.can.taken
        bench.run(0.4)
        assert bench.server.can.taken
        assert heard(bus) >= {0x700 + node for node in range(1, 6)}
        bus.send(can.Message(arbitration_id=0x601, data=bytes.fromhex("4000100000000000"), is_extended_id=False))
        bench.run(0.01)
        assert 0x581 in heard(bus)
    finally:
        bus.shutdown()
    bench.run(0.01)
    assert not bench.server.can.taken


@posix
def test_links_are_gone_with_the_doors_and_nothing_else_is_replaced(tmp_path: Path) -> None:
    links = tmp_path / "links"
    bench = Bench(links)
    assert sorted(path.name for path in links.iterdir()) == ["can", "heat", "load_cell"]
    bench.server.close()
    assert not list(links.iterdir())
    (links / "heat").write_text("mine", encoding="utf-8")
    with pytest.raises(OSError, match="heat"):
        Bench(links)
    assert sorted(path.name for path in links.iterdir()) == ["heat"], "no door was left open"


@posix
def test_unread_bytes_are_dropped_beyond_a_limit() -> None:
    pty = Pty(115200)
    try:
        written = 0
        while not pty.dropped and written < MOST_KEPT:
            pty.write(bytes(1000))
            written += 1000
        assert MOST_UNSENT < written < MOST_KEPT
    finally:
        pty.close()


@posix
def test_an_unplugged_bus_closes_the_adapter(bench: Bench, tmp_path: Path) -> None:
    near = os.open(tmp_path / "links" / "can", os.O_RDWR | os.O_NOCTTY)
    try:
        os.write(near, b"S6\rO\r")
        bench.run(0.3)
        assert isinstance(bench.server.can, SlcanDoor)
        assert bench.server.can.taken
        bench.server.rig.can.disconnect()
        bench.run(0.01)
        assert not bench.server.can.taken
    finally:
        os.close(near)


def test_a_system_without_pseudo_terminals_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    with pytest.raises(OSError, match="pseudo-terminals") as refused:
        Pty(9600)
    assert str(refused.value) == NONE_HERE


def test_a_door_that_there_is_not_is_refused() -> None:
    _, rig, _ = simulated_ports(load_rig("sim"), 1, None)
    with pytest.raises(ValueError, match="INTERFACE:CHANNEL"):
        RigServer(rig, "", 0, doors=Doors("vcan0"))
