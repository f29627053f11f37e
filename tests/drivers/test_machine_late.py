"""A simulated machine's report that its own computer was late."""

from __future__ import annotations

from drivers.canopen import objects as o
from drivers.canopen.messages import encode_emergency
from drivers.servo import ServoDrive
from tester.kinds import load_rig


def test_the_report_is_kept_when_other_emergencies_follow_it() -> None:
    drive = ServoDrive(load_rig("sim").drives()["press"])
    assert drive.machine_late == ""
    drive.on_emergency(1.0, encode_emergency(o.MACHINE_LATE, 1))
    drive.on_emergency(1.1, encode_emergency(0x8130, 1))
    assert "computer that simulates this machine was late" in drive.machine_late
