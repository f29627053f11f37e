"""The rig files of a specimen on a track: what has to fit together in them."""

from __future__ import annotations

import pytest

from tester.base.source import InvalidSource
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.run.simulated import spec_of
from tests.sim.machines.specimen_on_track.variants import parameters, wiring

RIGS = ("grosch", "pin-on-disc")


@pytest.mark.parametrize("name", RIGS)
def test_a_packaged_file_is_the_wiring_and_the_plant_that_are_simulated(name: str) -> None:
    rig, due = load_rig(name), wiring(name)
    found = spec_of(rig)
    assert rig.plant == parameters(name)
    assert found.lines == due.lines and set(found.devices) == set(due.devices)
    for axis, config in due.axes.items():
        mine = found.axes[axis]
        for field in ("unit", "velocity_increments", "position_increments", "feedback", "max_speed", "home_offset",
                      "acceleration", "quick_stop_deceleration", "software_limits", "digital_io"):  # fmt: skip
            assert getattr(mine, field) == getattr(config, field), field


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("weights=[20, 10]", "the lightest first"),
        ("limits.slowest=0.02 m/s", "is not below limits.track_speed"),
        ("limits.track_speed=0.02 m/s", "is less than limits.track_speed"),
        ("axes.track.feedback=velocity", "a linear track has ends"),
        ("axes.track.digital_io=false", "carries the safety inputs"),
        ("limits.air_high=-51 degC", "is not below limits.air_high"),
        ("sim.motion=disc", "and track is linear"),
        ("sim.enclosed=false", "whether there is a chamber"),
    ],
)
def test_what_does_not_fit_together_is_refused(override: str, said: str) -> None:
    with pytest.raises(InvalidSource, match=said):
        load_rig("grosch", [override], accept_risk="what it says is tried")


def test_an_arm_without_a_drive_and_a_rig_without_a_chamber() -> None:
    rig = TrackConfig.of(load_rig("pin-on-disc"))
    assert list(rig.drives()) == ["track"] and not rig.chamber and not rig.linear
