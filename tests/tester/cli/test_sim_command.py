"""`tester sim`: ready line, rig file, state log, and an end in order."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim import machines
from tester.cli.main import invoke
from tester.kinds import load_rig
from tester.run.sim_process import LOG_COLUMNS as LOGGED

COMMAND = "from tester.cli.main import main; main()"


@pytest.fixture
def sim(tmp_path: Path) -> Iterator[subprocess.Popen[str]]:
    """Start `tester sim` and wait for its ready line, which is read."""
    arguments = ["sim", "--write-rig", str(tmp_path / "rig.yaml"), "--log", str(tmp_path / "state.csv")]
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline().startswith("ready: CAN vcan0@127.0.0.1:")
    yield process
    process.kill()
    process.communicate()


def test_it_can_be_reached_by_its_rig_file_and_logs_its_state_until_it_is_ended(
    sim: subprocess.Popen[str], tmp_path: Path
) -> None:
    rig = load_rig(tmp_path / "rig.yaml")
    for address in (rig.can.channel.partition("@")[2], *(line.port for line in rig.lines.values())):
        host, _, port = address.rpartition(":")
        socket.create_connection((host, int(port)), 2.0).close()
    assert not list(tmp_path.glob(".*")), "what was written on the way is left"
    sim.terminate()
    _, said = sim.communicate(timeout=20.0)
    header, *rows = (tmp_path / "state.csv").read_text(encoding="utf-8").splitlines()
    columns = (*LOGGED, *machines.find("wheel_on_belt").log_columns)
    assert header == ",".join(columns)
    assert all(len(row.split(",")) == len(columns) for row in rows)
    if sys.platform != "win32":  # Windows ends a process without a signal to it
        assert sim.returncode == 0
        assert said.startswith("ended; at most ")


def test_a_fault_of_the_rig_file_that_is_none_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sim", "--set", 'sim.faults=["t=1 s: nonsense"]']) == 2
    assert "unknown fault 'nonsense'" in capsys.readouterr().err


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no signal for one process")
def test_an_interrupt_ends_it_in_order(sim: subprocess.Popen[str]) -> None:
    sim.send_signal(signal.SIGINT)
    sim.communicate(timeout=20.0)
    assert sim.returncode == 0


@pytest.mark.parametrize("address", ["0.0.0.0", "192.168.1.4:29536", "127.0.0.1:70000", "127.0.0.1:x", "::1", "rig"])
def test_an_address_that_is_not_on_this_machine_is_refused(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sim", "--listen", address]) == 2
    assert "--listen" in capsys.readouterr().err


def test_a_taken_port_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        assert invoke(["sim", "--listen", f"127.0.0.1:{taken.getsockname()[1]}"]) == 1
    assert "cannot listen" in capsys.readouterr().err


def test_an_unknown_compound_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["sim", "--rig", "grosch", "--compound", "9#"]) == 2
    assert "9#" in capsys.readouterr().err
