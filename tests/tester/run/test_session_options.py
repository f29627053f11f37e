"""Options that do not fit the rig."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.run.kind_lookup import load_rig
from tester.run.session_options import SessionOptions, refusal
from tests.tester.run.reached import reached_over_tcp
from tests.tester.run.test_session import Screen


def refused(rig: RigConfig, lapse: float | None) -> str:
    """Return why a run at this speed is refused."""
    return refusal(SessionOptions(lapse=lapse), rig, Screen())


@pytest.fixture
def elsewhere() -> RigConfig:
    """Return a simulated rig in another process."""
    rig = load_rig("sim")
    return reached_over_tcp(rig, ("127.0.0.1", 1), dict.fromkeys(rig.lines, ("127.0.0.1", 1)))


def test_a_simulated_rig_in_another_process_has_the_speed_at_which_it_lives(elsewhere: RigConfig) -> None:
    assert refused(elsewhere, 20.0) == ""


def test_one_drive_without_the_simulators_identity_makes_a_rig_real(elsewhere: RigConfig) -> None:
    real = replace(elsewhere, axes=replace(elsewhere.axes, belt=replace(elsewhere.axes.belt, vendor_id=0)))
    assert "--speed 20: this rig is real" in refused(real, 20.0)
    assert ["--speed" in refused(real, lapse) for lapse in (None, 1.0)] == [False, False]
