"""Refused axis configurations, and the text of a diagnosis."""

from __future__ import annotations

import pytest

from drivers.axis import Diagnosis
from tests.drivers.can_bench import wheel, yaw


@pytest.mark.parametrize(("changes", "text"), [
    ({"node_id": 0}, "node id 0"),
    ({"node_id": 127}, "node id 127"),
    ({"velocity_increments": 0.0}, "velocity_increments is 0.0"),
    ({"acceleration": float("nan")}, "acceleration is nan"),
    ({"feedback": "position"}, "position_increments"),
    ({"max_speed": 3.0e6}, "0x60FF"),
    ({"heartbeat_s": 0.0}, "heartbeat_s"),
    ({"consumer_heartbeat_s": 100.0}, "consumer_heartbeat_s"),
    ({"velocity_increments": 1.0}, "steps of 1 %"),
    ({"acceleration": 1e-6}, "acceleration is .* counts"),
    ({"quick_stop_deceleration": 1e9}, "quick_stop_deceleration is .* counts"),
    ({"max_speed_increments": 1e9}, "max_speed is .* counts"),
    ({"homing_method": 300}, "-128..127"),
    ({"homing_speed": 1e6}, "possible are 0..max_speed"),
    ({"home_timeout_s": 0.0}, "home_timeout"),
    ({"rpdo_deadline_s": 70.0}, "0x1400:05"),
    ({"vendor_id": 2**32}, "vendor_id"),
])
def test_a_wheel_that_cannot_be_is_refused(changes: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        wheel(**changes)


@pytest.mark.parametrize(("changes", "text"), [
    ({"software_limits": (5.0, 5.0)}, "ascending"),
    ({"feedback": "velocity"}, "position feedback"),
    ({"home_offset": 1e8}, "home_offset x position_increments"),
    ({"software_limits": (-1e8, 1.0)}, "software_limits x position_increments"),
])
def test_a_yaw_axis_that_cannot_be_is_refused(changes: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        yaw(**changes)


def test_a_diagnosis_reads_as_one_line() -> None:
    diagnosis = Diagnosis(0x8130, 0x11, (0x00008130, 0x00002310))
    assert diagnosis.text == ("error code 0x8130 heartbeat of the master lost, error register generic, "
                              "communication, history 0x8130 heartbeat of the master lost; 0x2310 over-current")


def test_an_unfinished_diagnosis_names_the_failure() -> None:
    assert Diagnosis(0, 0, (), "no reply").text.endswith("history empty; no reply")
