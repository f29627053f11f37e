"""The frames that a screen shows of a real rig: serial lines are pseudo-terminals with devices at the far end."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

if sys.platform == "win32":
    pytest.skip("this system has no pseudo-terminals", allow_module_level=True)

import os
import tty
from select import select

from drivers.crc16 import crc16
from drivers.profiles import load_profile
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.sensor_slave import CellSlave, IrSlave
from tester.kinds import hardware_text, load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.build import build_run
from tester.kinds.wheel_on_belt.served.served import SERVED
from tester.machine.prompts import Prompts
from tester.machine.run_parts import NoAttendant, RunSetup
from tester.run.bus_log import BusLog
from tester.run.folder import part_time
from tester.run.rig_wires import hardware_ports
from tester.service.protocol import Frame
from tester.service.values import PlanTrack
from tester.service.watch import RunWatch
from tester.store.recorder import NullRecorder
from tests.drivers.modbus_rig import Quantities
from tests.tester.kinds.wheel_on_belt.bench import plan_of

PATIENCE_S = 2.0
"""Time limit of a byte through a pseudo-terminal."""


class FarEnd:
    """A pseudo-terminal with devices at its far end, which answer on request."""

    def __init__(self, *slaves: ModbusSlave) -> None:
        self._slaves = slaves
        self._master, self._near = os.openpty()
        tty.setraw(self._near)
        self.name = os.ttyname(self._near)

    def answer(self, t: float) -> None:
        """Wait for a request, answer it, and wait until the answer has come through."""
        request = b""
        while len(request) < 8 or crc16(request):
            assert select([self._master], (), (), PATIENCE_S)[0]
            request += os.read(self._master, 300)
        for slave in self._slaves:
            reply = slave.answer(request, t)
            if reply is not None:
                os.write(self._master, reply)
                assert select([self._near], (), (), PATIENCE_S)[0]

    def close(self) -> None:
        os.close(self._master)
        os.close(self._near)


@pytest.fixture
def lines() -> Iterator[dict[str, FarEnd]]:
    source = Quantities()
    cell = FarEnd(CellSlave(load_profile("four_axis_transmitter"), 1, source))
    heat = FarEnd(
        ControllerSlave(load_profile("simulated_jacket"), 1, source),
        IrSlave(load_profile("calex_pyrominibus"), 2, source),
    )
    yield {"load_cell": cell, "heat": heat}
    cell.close()
    heat.close()


def real_rig(folder: Path, lines: dict[str, FarEnd]) -> RigConfig:
    """Return the rig file for a real machine with these serial ports, and python-can's bus within a process."""
    path = folder / "rig.yaml"
    path.write_text(hardware_text(), encoding="utf-8")
    ports = [f"lines.{name}.port={line.name}" for name, line in lines.items()]
    return load_rig(path, ["can.interface=virtual", f"can.channel={folder}", *ports])


def watched(rig: RigConfig, lines: dict[str, FarEnd], log: BusLog | None = None) -> list[Frame]:
    """Return the frames that the service shows of a run's first transactions on both lines."""
    ports = hardware_ports(rig, log)
    plan = plan_of(config=rig)
    run = build_run(RunSetup(rig, plan, ports, NoAttendant(), NullRecorder(), Prompts(automatic=True)))
    watch = RunWatch(run, PlanTrack(plan.name, [part_time(rig, plan)]), SERVED)
    watch.frames.watch(True)
    try:
        for t in (0.0, 0.02, 0.04):
            run.tick(t)
            run.tick(t + 0.01)  # the silence after a reply is over
            if t < 0.04:
                for line in lines.values():
                    line.answer(t + 0.01)
        taken = watch.frames.take()
    finally:
        watch.frames.watch(False)
        ports.close()
    assert taken is not None
    return list(taken.frames)


def test_the_screen_of_a_real_rig_shows_requests_and_replies_of_every_line(
    tmp_path: Path, lines: dict[str, FarEnd]
) -> None:
    frames = watched(real_rig(tmp_path, lines), lines)
    for name in lines:
        assert [frame.sent for frame in frames if frame.bus == name] == [True, False, True, False, True]
    asked, told = [frame for frame in frames if frame.bus == "load_cell"][:2]
    assert asked.data.startswith("01 03 00 64 00 01") and told.data.startswith("01 03 02 46 58")
    assert (asked.ident, told.ident) == (1, 1)


def test_a_bus_log_of_a_real_rig_has_the_frames_that_the_screen_shows(
    tmp_path: Path, lines: dict[str, FarEnd]
) -> None:
    rig = real_rig(tmp_path, lines)
    log = BusLog(tmp_path / "bus", rig)
    frames = watched(rig, lines, log)
    log.close()
    for name in lines:
        logged = (tmp_path / "bus" / f"modbus-{name}.log").read_text(encoding="utf-8").splitlines()
        shown = [f"{'TX' if frame.sent else 'RX'} {frame.data}" for frame in frames if frame.bus == name]
        assert [text.partition(") ")[2] for text in logged] == shown
