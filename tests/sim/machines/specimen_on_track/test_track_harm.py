"""Harm at a specimen on a track, as the plant sees it."""

from __future__ import annotations

import pytest

from sim.machines.specimen_on_track.rig import TrackRig
from tests.campaigns.faults.track_harm import TrackHarmObserver, TrackTruth
from tests.sim.machines.specimen_on_track.test_track_rig import drive, lower, made, run


def watched(rig: TrackRig, *, must_stand: bool = False, tared: bool = True) -> list[str]:
    """Return what harm is found in some steps."""
    observer = TrackHarmObserver(rig, tared)
    for _ in range(30):
        observer.look(must_stand)
        run(rig, 0.02)
    return list(observer.found)


def test_a_rig_at_rest_does_no_harm() -> None:
    assert watched(made(), must_stand=True) == []


def test_sliding_after_the_tare_is_none() -> None:
    assert watched(drive(lower(made()), 1.0)) == []


def test_sliding_before_the_tare_is_harm() -> None:
    assert watched(drive(lower(made()), 1.0), tared=False) == ["track moves under load before the tare"]


def test_a_track_that_moves_with_the_arm_raised_needs_no_tare() -> None:
    assert watched(drive(made(), 1.0), tared=False) == []


def test_a_force_beyond_the_cell_is_harm() -> None:
    rig = lower(made())
    rig.put_on(200.0)
    assert watched(drive(rig, 10.0)) == ["force beyond the cell"]


@pytest.mark.parametrize("air_c", [-61.0, 111.0])
def test_a_chamber_beyond_its_range_is_harm(air_c: float) -> None:
    rig = made()
    rig.plant.air_c = air_c
    assert watched(rig) == ["chamber beyond its range"]


def test_running_into_a_stop_is_harm() -> None:
    rig = made()
    rig.switches_work = False
    rig.axes["track"].axis.position = 299.0
    assert watched(drive(rig, 10.0)) == ["end of travel hit"]


def test_a_track_that_must_stand_and_moves_is_harm() -> None:
    assert watched(drive(made(), 1.0), must_stand=True) == ["motion where everything must stand"]


def test_a_falling_arm_where_everything_must_be_at_rest_is_harm_and_a_rising_arm_is_not() -> None:
    rig = made("pin-on-disc")
    observer = TrackHarmObserver(rig, tared=True)
    rig.hand_mm = 5.0
    observer.look(True)
    rig.raise_arm()
    observer.look(True)
    assert not observer.found
    rig.lower_arm()
    observer.look(True)
    assert list(observer.found) == ["motion where everything must stand"]


def test_everything_missing_for_the_safe_state_is_named() -> None:
    rig = run(drive(made(), 1.0), 1.0)
    assert TrackTruth.of(rig).unsafe(1e-5) == ["track 0.001 m/s"]
    assert TrackTruth.of(made()).unsafe(1e-5) == []
