"""A simulated machine's report that its own computer was late."""

from __future__ import annotations

from drivers.canopen import objects as o
from drivers.canopen.messages import encode_emergency
from drivers.servo import ServoDrive
from tester.kinds import load_rig


def drive() -> ServoDrive:
    return ServoDrive(load_rig("sim").drives()["press"])


def test_the_report_is_kept_when_other_emergencies_follow_it_and_is_none_itself() -> None:
    press = drive()
    press.on_emergency(1.0, encode_emergency(o.MACHINE_LATE, 0, (32).to_bytes(2, "little") + o.MACHINE_LATE_MARK))
    assert press.emergency is None
    press.on_emergency(1.1, encode_emergency(0x8130, 1))
    assert press.machine_late == [(1.0, 32)]


def test_a_real_drive_s_emergency_of_the_same_code_is_one() -> None:
    press = drive()
    press.on_emergency(1.0, encode_emergency(o.MACHINE_LATE, 1, bytes(5)))
    assert press.emergency is not None
    assert press.machine_late == []
