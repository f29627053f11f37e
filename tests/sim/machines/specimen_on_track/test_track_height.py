"""The height of the simulated arm: lifted, on a specimen that is new or worn, without one; and its sensor."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.machines.specimen_on_track.plant import IN_HOLDER
from sim.physics.track import TrackParameters
from tests.sim.machines.specimen_on_track.test_track_plant import CLEAN, lowered, slid

CONTACT = CLEAN.contact
FLAT = replace(CLEAN, motion="disc", contact=replace(CONTACT, runout=0.0))


@pytest.mark.parametrize(("lift_mm", "height_mm"), [(10.0, 9.0), (1.0, 0.0)])
def test_a_lifted_arm_is_as_high_as_its_lift_above_the_touch(lift_mm: float, height_mm: float) -> None:
    plant = lowered()
    plant.advance(0.01, 0.0, lift_mm, 0.0)
    assert plant.height_mm == pytest.approx(height_mm)


def test_a_lowered_arm_is_lower_by_the_compression_under_load() -> None:
    assert lowered(weights_n=20.0).height_mm == pytest.approx(-20.0 / CONTACT.squeeze)


def test_a_specimen_wears_by_the_way_it_has_slid() -> None:
    plant = slid(lowered(FLAT), 0.3, 20.0)
    assert plant.worn_mm == pytest.approx(CONTACT.wear * plant.slid_m) and plant.worn_mm > 0.002
    grown_mm = CONTACT.expansion * (plant.specimen_c - CLEAN.ambient)
    assert plant.height_mm == pytest.approx(grown_mm - plant.worn_mm - 20.0 / CONTACT.squeeze)


def test_a_disc_runs_out_to_either_side() -> None:
    plant, seen = lowered(replace(CLEAN, motion="disc")), list[float]()
    for _ in range(200):
        plant.advance(0.01, 0.3, 0.0, 0.0)
        seen.append(plant.height_mm)
    assert max(seen) - min(seen) == pytest.approx(2.0 * CONTACT.runout, rel=0.1)


def test_without_its_specimen_the_holder_grinds_with_its_own_friction() -> None:
    plant = lowered(FLAT)
    plant.lose(0.02)
    slid(plant, 0.3, 2.0)
    assert plant.height_mm == -CONTACT.protrusion and plant.mu == 0.02
    assert plant.force_n == pytest.approx(0.02 * 20.0) and plant.slid_m == 0.0 and plant.ground_m > 0.5


def test_a_specimen_worn_to_its_holder_is_as_low_as_none() -> None:
    plant = lowered(FLAT)
    plant.worn_mm = 10.0
    slid(plant, 0.0, 0.02)
    assert plant.height_mm == -CONTACT.protrusion


def test_a_new_specimen_takes_the_place_of_a_lost_one() -> None:
    plant = lowered(FLAT)
    plant.lose(0.02)
    plant.worn_mm = 1.0
    plant.install(1, "SBR")
    assert plant.holder_mu == IN_HOLDER and plant.worn_mm == 0.0


def test_a_deaf_cell_shows_no_force() -> None:
    plant = slid(lowered(), 0.3, 2.0)
    plant.deaf = True
    assert plant.force_n > 1.0 and plant.forces_measured(0.0)[0] == 0.0


@pytest.mark.parametrize("seed_noise", [0.0, 1.0])
def test_the_sensor_is_off_by_no_more_than_its_zero_and_its_noise(seed_noise: float) -> None:
    parameters = TrackParameters(noise=seed_noise, scatter=0.0)
    plant = lowered(parameters)
    off = [abs(plant.height_measured() - plant.height_mm) for _ in range(200)]
    s = parameters.sensors
    assert max(off) <= seed_noise * (s.height_zero + 5.0 * s.height_rms) and (max(off) > 0.0) is (seed_noise > 0.0)
