"""A record of the digital rig, replayed to the drivers, also with an answer missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import WheelArming
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.connect import Connector, Stage
from tester.machine.rig_ports import Ports
from tests.drivers.recorded import RecordedCan, RecordedLine

RECORD = Path(__file__).parent / "records" / "digital_rig"
"""The first 2.2 s of a run on the digital rig, by its --bus-log: every device configured and received."""
STEP_S = 0.005


class Replay:
    """The packaged rig's drivers on a record."""

    def __init__(self, can_log: Path = RECORD / "can.log") -> None:
        config = RigConfig.of(load_rig("sim"))
        self.can = RecordedCan(can_log)
        self.lines = {name: RecordedLine(RECORD / f"modbus-{name}.log") for name in config.lines}
        self.devices = Devices(config, Ports(self.can, dict(self.lines)))
        self.connector = Connector(
            self.devices, config, WheelArming(self.devices, config), config.arming.listen_s
        )

    def until(self, stage: Stage, at_most_s: float) -> None:
        """Connect until a stage is reached or connecting has failed."""
        t = 0.0
        while self.connector.stage not in (stage, Stage.FAILED) and t < at_most_s:
            t += STEP_S
            self.connector.tick(t)


def test_the_drivers_repeat_the_recorded_requests_and_accept_the_answers() -> None:
    replay = Replay()
    replay.until(Stage.HEAR, 3.0)
    assert (replay.connector.stage, replay.connector.failure) == (Stage.HEAR, "")
    assert replay.can.unknown == []
    assert {name: line.unknown for name, line in replay.lines.items()} == {"load_cell": [], "heat": []}


def test_a_record_of_another_drive_is_refused(tmp_path: Path) -> None:
    text = (RECORD / "can.log").read_text(encoding="utf-8")
    vendor = "581#43181001" + load_rig("sim").drives()["wheel"].vendor_id.to_bytes(4, "little").hex().upper()
    assert vendor in text
    other = tmp_path / "can.log"
    other.write_text(text.replace(vendor, "581#43181001EFBE0000"), encoding="utf-8")
    replay = Replay(other)
    replay.until(Stage.HEAR, 5.0)
    assert replay.connector.stage is Stage.FAILED
    assert "0x1018:01" in replay.connector.failure


def test_an_unrecorded_request_is_noted() -> None:
    line = RecordedLine(RECORD / "modbus-heat.log")
    line.write(b"\x07\x03", 1.0)
    assert (line.unknown, line.read(9.0)) == ([b"\x07\x03"], [])
    bus = RecordedCan(RECORD / "can.log")
    bus.send(0x601, bytes(8), 0.1)
    assert bus.unknown == [(0x601, bytes(8))]


def test_unrequested_frames_come_at_their_recorded_times() -> None:
    bus = RecordedCan(RECORD / "can.log")
    assert bus.receive(0.1) == []
    assert [can_id for _, can_id, _ in bus.receive(0.3)] == [0x701, 0x702, 0x703, 0x704, 0x705]
    assert all(t == pytest.approx(0.2, abs=0.01) for t, _, _ in RecordedCan(RECORD / "can.log").receive(0.3))
