"""`tester bus record`: live wires written down as a run's bus log."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

import can
import pytest

from tester.cli.main import invoke
from tests.drivers.recorded import RecordedCan, RecordedLine
from tests.drivers.test_modbus_tap import ANSWER, READ


@contextmanager
def again_and_again(talk: Callable[[], object]) -> Iterator[None]:
    """Keep other nodes sending on a wire until the recording ends."""
    over = Event()

    def talking() -> None:
        while not over.wait(0.02):
            talk()

    thread = Thread(target=talking)
    thread.start()
    yield
    over.set()
    thread.join()


def test_a_bus_is_recorded_with_the_sender_of_each_frame(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with can.Bus(interface="virtual", channel="record") as bus:

        def talk() -> None:
            asked, answered = "4000100000000000", "4300100092010200"
            for can_id, data in ((0x601, asked), (0x581, answered), (0x701, "05"), (0x77F, "05")):
                bus.send(can.Message(arbitration_id=can_id, data=bytes.fromhex(data), is_extended_id=False))

        with again_and_again(talk):
            assert invoke(["bus", "record", str(tmp_path / "r"), "--can", "virtual:record", "--seconds", "0.3"]) == 0
    assert "frames" in capsys.readouterr().err
    lines = (tmp_path / "r" / "can.log").read_text(encoding="utf-8").splitlines()
    assert {tuple(line.split()[2:]) for line in lines} == {
        ("601#4000100000000000", "T"), ("581#4300100092010200", "R"), ("701#05", "R"), ("77F#05", "T"),
    }  # fmt: skip
    replayed = RecordedCan(tmp_path / "r" / "can.log")
    replayed.send(0x601, bytes.fromhex("4000100000000000"), 1.0)
    assert (0x581, bytes.fromhex("4300100092010200")) in [(one, data) for _, one, data in replayed.receive(9.0)]


@pytest.mark.skipif(sys.platform == "win32", reason="this system has no pseudo-terminals")
def test_a_line_is_written_down(tmp_path: Path) -> None:
    import tty

    far, near = os.openpty()
    tty.setraw(near)

    place = f"cell={os.ttyname(near)}@115200"
    with again_and_again(lambda: os.write(far, READ + ANSWER)):
        assert invoke(["bus", "record", str(tmp_path / "r"), "--line", place, "--seconds", "0.3"]) == 0
    os.close(far)
    os.close(near)
    line = RecordedLine(tmp_path / "r" / "modbus-cell.log")
    line.write(READ, 1.0)
    assert [data for _, data in line.read(2.0)] == [ANSWER]


def test_silence_is_no_record(tmp_path: Path) -> None:
    assert invoke(["bus", "record", str(tmp_path / "r"), "--can", "virtual:nobody", "--seconds", "0.1"]) == 1


@pytest.mark.parametrize(
    "arguments", [[], ["--can", "can0"], ["--line", "heat"], ["--line", "heat=/dev/ttyUSB0"], ["--line", "a/b=c@9600"]]
)
def test_a_bus_that_cannot_be_recorded_is_a_usage_error(arguments: list[str], tmp_path: Path) -> None:
    assert invoke(["bus", "record", str(tmp_path / "r"), *arguments]) == 2


def test_an_interface_that_is_not_there_is_unreachable(tmp_path: Path) -> None:
    assert invoke(["bus", "record", str(tmp_path / "r"), "--can", "nosuch:can0"]) == 4
