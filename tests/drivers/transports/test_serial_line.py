"""The serial edge on a pseudo-terminal: bytes through, nothing blocks, every failure is BusLost."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from select import select

import pytest

from drivers.crc16 import with_crc
from drivers.ports import BusLost
from drivers.transports.serial_line import SerialLine, latency_timer_s, open_serial_line, remedy_of

if sys.platform == "win32":
    pytest.skip("this system has no pseudo-terminals", allow_module_level=True)

import os
import tty

PATIENCE_S = 5.0
"""Bound of every wait for the kernel."""


@pytest.fixture
def ends() -> Iterator[tuple[SerialLine, int, int]]:
    """Give an open line, and both descriptors of its pseudo-terminal."""
    master, slave = os.openpty()
    tty.setraw(slave)
    line = open_serial_line(os.ttyname(slave), 115200)
    yield line, master, slave
    line.close()
    for descriptor in (master, slave):
        try:
            os.close(descriptor)
        except OSError:
            continue  # the test closed it


def test_written_bytes_arrive(ends: tuple[SerialLine, int, int]) -> None:
    line, master, _ = ends
    line.write(b"\x01\x03\x00", 0.0)
    assert select([master], [], [], PATIENCE_S)[0]
    assert os.read(master, 10) == b"\x01\x03\x00"


def test_received_bytes_are_stamped_with_the_time_of_the_read(ends: tuple[SerialLine, int, int]) -> None:
    line, master, slave = ends
    os.write(master, b"\x0d\x0a\x11\x13\x00\xff")
    assert select([slave], [], [], PATIENCE_S)[0]
    assert line.read(12.5) == [(12.5, b"\x0d\x0a\x11\x13\x00\xff")]


def test_in_ascii_the_wire_has_text_and_the_caller_frames() -> None:
    master, slave = os.openpty()
    tty.setraw(slave)
    line = open_serial_line(os.ttyname(slave), 9600, in_ascii=True)
    request = with_crc(bytes.fromhex("010300640002"))
    line.write(request, 0.0)
    assert select([master], [], [], PATIENCE_S)[0]
    assert os.read(master, 100) == b":01030064000296\r\n"
    os.write(master, b":01030064")
    assert select([slave], [], [], PATIENCE_S)[0] and line.read(1.0) == []
    os.write(master, b"000296\r\n")
    assert select([slave], [], [], PATIENCE_S)[0] and line.read(2.0) == [(2.0, request)]
    line.close()
    os.close(master)
    os.close(slave)


def test_a_port_that_cannot_switch_a_direction_is_refused_by_name() -> None:
    master, slave = os.openpty()
    with pytest.raises(BusLost, match=f"serial port {os.ttyname(slave)}: .*RS485"):
        open_serial_line(os.ttyname(slave), 9600, rts="high")
    os.close(master)
    os.close(slave)


def test_reading_nothing_does_not_block(ends: tuple[SerialLine, int, int]) -> None:
    line, _, _ = ends
    assert line.read(0.0) == []


def test_a_port_that_goes_away_is_bus_lost(ends: tuple[SerialLine, int, int]) -> None:
    line, master, slave = ends
    os.close(slave)
    os.close(master)
    with pytest.raises(BusLost, match="serial port"):
        line.read(0.0)
        line.write(b"\x01", 0.0)


def test_a_port_that_is_not_there_is_bus_lost(tmp_path: Path) -> None:
    with pytest.raises(BusLost, match="no_such_port"):
        open_serial_line(str(tmp_path / "no_such_port"), 9600)


def test_a_port_in_use_is_bus_lost(ends: tuple[SerialLine, int, int]) -> None:
    _, _, slave = ends
    with pytest.raises(BusLost):
        open_serial_line(os.ttyname(slave), 9600)


def test_the_latency_timer_of_an_adapter_is_read_where_its_driver_has_one(tmp_path: Path) -> None:
    (tmp_path / "ttyUSB0" / "device").mkdir(parents=True)
    (tmp_path / "ttyUSB0" / "device" / "latency_timer").write_text("16\n", encoding="ascii")
    assert latency_timer_s("/dev/ttyUSB0", tmp_path) == 0.016
    assert latency_timer_s("/dev/ttyUSB1", tmp_path) is None


def test_a_pty_reports_that_it_has_no_low_latency_flag(ends: tuple[SerialLine, int, int]) -> None:
    line, _, _ = ends
    assert line.low_latency in (False, None)
    assert line.latency_timer_s is None


def test_the_remedy_names_the_setting() -> None:
    assert "/sys/class/tty/ttyUSB0/device/latency_timer" in remedy_of("/dev/ttyUSB0")


def test_on_windows_the_remedy_names_the_registry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "win32")
    assert "LatencyTimer" in remedy_of("COM4")
