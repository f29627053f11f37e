"""The rig files of a specimen on a track: consistency."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.physics.track_bells import RUBBERS, SURFACES
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
def test_inconsistent_values_are_refused(override: str, said: str) -> None:
    with pytest.raises(InvalidSource, match=said):
        load_rig("grosch", [override], accept_risk="what it says is tried")


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (["arm.protrusion=2.2 mm"], "hides a lost specimen: .* are 2.3 mm"),
        (["interlocks.wear=1 mm", "interlocks.thickness=1 mm", "arm.protrusion=2.9 mm"], "are 3 mm"),
        (["arm.protrusion=3.1 mm"], "is below arm.protrusion, 3.1 mm"),
        (["sim.contact.wear=0.001 mm"], "expected a loss of height over the way"),
    ],
)
def test_a_lost_specimen_has_to_be_lower_than_a_worn_one(overrides: list[str], said: str) -> None:
    with pytest.raises(InvalidSource, match=said):
        load_rig("pin-on-disc", overrides, accept_risk="what it says is tried")


def test_a_protrusion_that_shows_a_lost_specimen_is_accepted() -> None:
    own = load_rig("pin-on-disc", ["arm.protrusion=2.3 mm"], accept_risk="tried")
    assert TrackConfig.of(own).arm.protrusion_mm == 2.3
    rig = TrackConfig.of(load_rig("pin-on-disc", ["sim.contact.wear=2 um/m"]))
    assert rig.sim.contact.wear == 0.002


def test_less_than_three_millimetres_want_a_reason() -> None:
    with pytest.raises(InvalidSource, match=r"arm\.protrusion"):
        load_rig("pin-on-disc", ["arm.protrusion=2.9 mm"])


def test_without_a_height_sensor_the_protrusion_shows_nothing() -> None:
    own = load_rig("grosch", ["arm.protrusion=2.1 mm"], accept_risk="tried")
    assert TrackConfig.of(own).arm.protrusion_mm == 2.1


def test_an_arm_without_a_drive_and_a_rig_without_a_chamber() -> None:
    rig = TrackConfig.of(load_rig("pin-on-disc"))
    assert list(rig.drives()) == ["track"] and not rig.chamber and not rig.linear


def test_a_key_of_a_surface_leaves_its_other_keys_and_the_other_surfaces() -> None:
    rig = TrackConfig.of(load_rig("grosch", ("sim.surfaces.glass.adhesion=0.9",)))
    assert rig.sim.surfaces == {**SURFACES, "glass": replace(SURFACES["glass"], adhesion=0.9)}
    assert rig.sim.surfaces["glass"].hysteresis == 0.0 and rig.sim.rubbers == RUBBERS


def test_a_key_of_a_rubber_leaves_its_other_keys_and_the_other_rubbers() -> None:
    rig = TrackConfig.of(load_rig("grosch", ("sim.rubbers.butyl.t_ref=-20 degC",)))
    assert rig.sim.rubbers == {**RUBBERS, "butyl": replace(RUBBERS["butyl"], t_ref=-20.0)}


def test_a_new_surface_needs_every_key() -> None:
    with pytest.raises(InvalidSource) as caught:
        load_rig("grosch", ("sim.surfaces.slate.adhesion=0.9",))
    assert [problem.message.partition(" is missing")[0] for problem in caught.value.problems] == [
        "grit", "hysteresis", "jump",
    ]  # fmt: skip
