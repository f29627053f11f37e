"""Belts of the simulated wheel: the mounted belt sets friction, thickness and grip."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.machines.wheel_on_belt.plant import Plant
from sim.machines.wheel_on_belt.rubbing import BELT_MM, PAPERS_BELT
from sim.physics.parameters import SimParameters

BLUNTS = replace(SimParameters(), counterface=replace(SimParameters().counterface, loss=0.1))


def made(parameters: SimParameters = BLUNTS, seed: int = 4) -> Plant:
    plant = Plant(parameters, seed)
    plant.install(1, 1, "1#", True)
    return plant


def model(plant: Plant) -> float:
    return plant.truth(40.0, 200.0, 0.3, 0.0)["model"]


def test_friction_follows_the_belt_that_is_on() -> None:
    plant = made()
    first = model(plant)
    plant.cover("corundum 80")
    other = model(plant)
    plant.cover(PAPERS_BELT)
    assert model(plant) == first != other == pytest.approx(first, rel=0.5)


def test_a_belt_keeps_the_grip_that_it_had_when_it_was_taken_off() -> None:
    plant = made()
    plant.cover("A")
    plant.travel(300.0, 25.0)
    worn = plant.belt_grip
    plant.cover("B")
    assert plant.belt_grip == 1.0 > worn
    plant.cover("A")
    assert plant.belt_grip == worn


def test_belts_differ_in_thickness_within_the_stated_bound() -> None:
    plant = made()
    before_mm = plant.press_at_mm(0.0)
    off_mm: list[float] = []
    for number in range(40):
        plant.cover(f"belt {number}")
        off_mm.append(plant.press_at_mm(0.0) - before_mm)
    assert max(map(abs, off_mm)) <= BELT_MM and max(off_mm) > 0.5 * BELT_MM and min(off_mm) < -0.5 * BELT_MM


def test_friction_of_a_name_is_the_same_in_every_session_of_a_seed() -> None:
    one, two, other = made(), made(), made(seed=5)
    for plant in (one, two, other):
        plant.cover("corundum 80")
    assert model(one) == model(two) != model(other)


def test_a_rig_without_scatter_has_equal_belts() -> None:
    plant = made(replace(BLUNTS, scatter=0.0))
    before = model(plant), plant.press_at_mm(0.0)
    plant.cover("corundum 80")
    assert (model(plant), plant.press_at_mm(0.0)) == before
