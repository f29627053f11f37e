"""Frame logs of a run, read back by their tools."""

from __future__ import annotations

import json
import re
from itertools import pairwise
from pathlib import Path
from select import select
from socket import create_server

import can
import pytest

from drivers.ports import FrameByFrame
from drivers.transports.tcp_line import open_tcp_line
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import run_simulated
from tester.run.bus_log import BusLog, CanLog, LineLog
from tester.run.simulated import simulated_ports
from tester.store.recorder import NullRecorder
from tests.tester.inputs.recipe.texts import rig
from tests.tester.kinds.wheel_on_belt.bench import QUIET, plan_of

SYNC, NMT, EMERGENCIES = 0x080, 0x000, range(0x081, 0x100)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The logs of a short run."""
    folder = tmp_path_factory.mktemp("bus")
    config = rig(*QUIET)
    log = BusLog(folder, config)
    ports, world, attendant = simulated_ports(config, 0, log)
    run = build_run(RunSetup(config, plan_of(), ports, attendant, NullRecorder(), Prompts(automatic=True)))
    run_simulated(run, world, lapse=None, poll=lambda _: None)
    log.close()
    return folder


@pytest.fixture(scope="module")
def frames(folder: Path) -> list[can.Message]:
    return list(can.CanutilsLogReader(folder / "can.log"))


def of(frames: list[can.Message], can_id: int) -> list[can.Message]:
    return [frame for frame in frames if frame.arbitration_id == can_id]


def test_python_can_reads_every_line_back(folder: Path, frames: list[can.Message]) -> None:
    lines = (folder / "can.log").read_text(encoding="ascii").splitlines()
    assert len(frames) == len(lines) > 5000
    assert not any(frame.is_extended_id or frame.is_remote_frame or frame.is_error_frame for frame in frames)


def test_each_direction_is_in_order_of_time(frames: list[can.Message]) -> None:
    for received in (True, False):
        times = [frame.timestamp for frame in frames if frame.is_rx is received]
        assert times and all(a <= b for a, b in pairwise(times))


def test_frames_of_the_computer_are_marked(frames: list[can.Message]) -> None:
    assert not any(frame.is_rx for frame in of(frames, SYNC) + of(frames, NMT) + of(frames, 0x201))
    assert all(frame.is_rx for frame in of(frames, 0x181) + of(frames, 0x701))


def test_every_drive_boots_and_is_started(frames: list[can.Message]) -> None:
    for node in range(1, 6):
        assert any(frame.data == b"\x00" for frame in of(frames, 0x700 + node))
        assert any(frame.data == bytes((1, node)) for frame in of(frames, NMT))


def test_every_drive_s_identity_is_read_and_its_watchdog_armed(frames: list[can.Message]) -> None:
    for node in range(1, 6):
        requests = {bytes(frame.data[:4]) for frame in of(frames, 0x600 + node)}
        assert b"\x40\x18\x10\x01" in requests
        # 0x1016:01, written and read back.
        assert {b"\x23\x16\x10\x01", b"\x40\x16\x10\x01"} <= requests


def test_there_are_100_syncs_a_second_while_sliding(frames: list[can.Message]) -> None:
    # RPDO1 of the belt: target velocity in 0.01 mm/s behind the controlword.
    slow = [f.timestamp for f in of(frames, 0x202) if int.from_bytes(f.data[2:6], "little", signed=True) == 50_000]
    syncs = [frame.timestamp for frame in of(frames, SYNC) if slow[0] <= frame.timestamp <= slow[0] + 1.0]
    assert len(syncs) in (100, 101)


def test_the_emergencies_of_a_healthy_run_are_those_of_the_watchdogs_proof(frames: list[can.Message]) -> None:
    codes = {can_id: [f.data[:2] for f in of(frames, can_id)] for can_id in EMERGENCIES}
    assert {node - SYNC for node in codes if codes[node]} == {1, 2, 3, 4, 5}
    assert all(each in ([], [b"\x30\x81", b"\x00\x00"]) for each in codes.values())


def test_drives_are_disabled_before_the_log_ends(frames: list[can.Message]) -> None:
    assert all(not of(frames, 0x200 + node)[-1].data[0] & 0x08 for node in (1, 2, 3))


@pytest.mark.parametrize("line", ["load_cell", "heat"])
def test_modbus_frames_have_a_time_a_direction_and_bytes(folder: Path, line: str) -> None:
    lines = (folder / f"modbus-{line}.log").read_text(encoding="utf-8").splitlines()
    assert len(lines) > 100
    assert all(re.fullmatch(r"\(\d+\.\d{6}\) (TX|RX)( [0-9a-f]{2})+", text) for text in lines)


def test_requests_and_replies_alternate(folder: Path) -> None:
    lines = (folder / "modbus-load_cell.log").read_text(encoding="utf-8").splitlines()
    directions = [text.split()[1] for text in lines]
    assert directions[:6] == ["TX", "RX"] * 3


def test_the_axes_file_turns_counts_into_units(folder: Path) -> None:
    axes = json.loads((folder / "axes.json").read_text(encoding="utf-8"))
    assert list(axes) == ["wheel", "belt", "press", "sideslip", "camber"]
    assert axes["belt"]["velocity_counts_per_unit"] == 100_000 and axes["belt"]["unit"] == "m/s"
    assert axes["sideslip"]["rpdo1"] == ["6040 controlword", "607A position"]


class Adapter(FrameByFrame):
    """A CAN adapter that always has a frame to receive."""

    def send(self, can_id: int, data: bytes, now: float) -> None:
        self.tell_sent(can_id, data, now)

    def receive(self, now: float) -> list[tuple[float, int, bytes]]:
        frames = [(now, 0x181, b"\x01")]
        self.tell_received(frames)
        return frames


def test_a_real_adapter_is_logged_on_its_way(tmp_path: Path) -> None:
    log, port = CanLog(tmp_path / "can.log"), Adapter()
    unwatch = port.watch(log.frame)
    port.send(0x201, b"\x0f\x00", 1.0)
    port.receive(1.5)
    unwatch()
    port.send(0x202, b"", 2.0)
    log.close()
    first, second = can.CanutilsLogReader(tmp_path / "can.log")
    assert (first.arbitration_id, first.timestamp, first.is_rx) == (0x201, 1.0, False)
    assert (second.arbitration_id, second.timestamp, second.is_rx) == (0x181, 1.5, True)


def test_a_real_line_is_logged_on_its_way(tmp_path: Path) -> None:
    log = LineLog(tmp_path / "line.log")
    with create_server(("127.0.0.1", 0)) as server:
        line = open_tcp_line(*server.getsockname())
        far, _ = server.accept()
        line.watch(log.frame)
        line.write(b"\x01\x04", 1.0)
        assert far.recv(8) == b"\x01\x04"
        far.send(b"\x02\x03")
        select([line], (), ())
        assert line.read(1.25) == [(1.25, b"\x02\x03")]
        far.close()
        line.close()
    log.close()
    assert (tmp_path / "line.log").read_text() == "(1.000000) TX 01 04\n(1.250000) RX 02 03\n"


def test_a_port_has_any_number_of_watchers() -> None:
    port, heard = Adapter(), list[str]()
    stop_first = port.watch(lambda t, can_id, data, sent: heard.append("first"))
    port.watch(lambda t, can_id, data, sent: heard.append("second"))
    port.send(0x201, b"", 0.0)
    stop_first()
    stop_first()
    port.send(0x201, b"", 0.1)
    assert heard == ["first", "second", "second"]
