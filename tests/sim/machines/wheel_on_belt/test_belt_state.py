"""The belt's state: any wheel blunts it, and it stays blunt."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sim.machines.wheel_on_belt.plant import Plant
from sim.physics.parameters import CounterfaceParameters
from tests.sim.machines.wheel_on_belt.test_plant import ROUND, mounted, run

SHORT_LIVED = CounterfaceParameters(loss=0.1, loss_travel=5.0)
"""A tenth in ten seconds at 0.5 m/s."""
BLUNTING = replace(ROUND, counterface=SHORT_LIVED)


def friction(plant: Plant) -> float:
    run(plant, 0.01, 200.0)
    return plant.mu


def test_travel_under_load_takes_its_share_of_the_grip() -> None:
    sharp, blunt = mounted(), mounted(BLUNTING)
    for plant in (sharp, blunt):
        run(plant, 10.0, 200.0)
    assert blunt.belt_grip == pytest.approx(0.9, rel=1e-6)
    # Nearly: less friction warms the surface less.
    assert friction(blunt) / friction(sharp) == pytest.approx(0.9, abs=0.003)


def test_a_lifted_wheel_leaves_it_alone() -> None:
    plant = mounted(BLUNTING)
    run(plant, 10.0)
    assert plant.belt_grip == 1.0


def test_it_stays_blunt_below_the_next_wheel() -> None:
    plant = mounted(BLUNTING)
    run(plant, 10.0, 200.0)
    plant.install(1, 2, "1#", False)
    assert plant.belt_grip == pytest.approx(0.9, rel=1e-6)
    plant.install(2, 3, "3#", True)
    assert plant.belt_grip == pytest.approx(0.9, rel=1e-6)


def test_without_a_loss_it_is_as_it_was() -> None:
    plant = mounted()
    run(plant, 10.0, 200.0)
    assert plant.belt_grip == 1.0
