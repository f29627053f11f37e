from __future__ import annotations

from dataclasses import replace

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served.served import left_alone


@pytest.fixture
def rig() -> RigConfig:
    """Return the packaged rig as if its buses were there."""
    sim = load_rig("sim")
    return replace(sim, can=replace(sim.can, interface="socketcan", channel="can0"))


def test_a_simulated_rig_is_gone_with_its_service() -> None:
    assert left_alone(load_rig("sim")) == "The simulated rig was part of the service and is gone with it."


def test_the_first_watchdog_of_each_drive_and_the_jackets_lease_are_shown(rig: RigConfig) -> None:
    axes = replace(rig.axes, belt=replace(rig.axes.belt, consumer_heartbeat_s=0.3, rpdo_deadline_s=0.0))
    text = left_alone(replace(rig, axes=axes))
    assert "(wheel, press, sideslip, camber: 200 ms; belt: 300 ms)" in text
    assert "stops heating by itself (2 s without a command)" in text


def test_a_jacket_without_a_watchdog_is_reported(rig: RigConfig, monkeypatch: pytest.MonkeyPatch) -> None:
    class Leaseless:
        writes = frozenset[str]()

    monkeypatch.setattr("tester.kinds.wheel_on_belt.served.served.profile_of", lambda _: Leaseless())
    assert "no watchdog of its own: switch its supply off" in left_alone(rig)
