"""A run without a fault has no trip. Campaign: ``pytest -m campaign tests/tester/machine/test_no_trips.py``."""

from __future__ import annotations

from itertools import product

import pytest

from tester.machine.run import Outcome
from tests.tester.kinds.wheel_on_belt.bench import SHORT, Simulation

PREPARED = (
    SHORT.replace("repeats: 1", "repeats: 2")
    + "pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 1 min}\n"
    + "rest: {at_least: 30 s, until: 40 degC}\n"
)
CASES = {
    "1#": ("200 N", "[40 degC, 70 degC]", "[300 mm/s, -200 mm/s, 0 mm/s]"),
    "2#": ("[50 N, 400 N]", "85 degC", "200 mm/s"),
    "3#": ("400 N", "[25 degC, 55 degC, 85 degC]", "100 mm/s"),
}
"""Load, temperature and slip of a shortened recipe for each compound."""
OFF = (
    (),
    ("sim.friction_heat_fraction=0.078", "sim.belt_conductance=0.042", "sim.thermal.hub_capacity=546"),
    ("sim.friction_heat_fraction=0.042", "sim.belt_conductance=0.078", "sim.thermal.hub_capacity=294"),
)
"""The plant as the observer assumes, and off by 30 % either way."""


def recipe(compound: str) -> str:
    load, temperature, slip = CASES[compound]
    text = PREPARED.replace("1#", compound).replace("load: 200 N\n    temp", f"load: {load}\n    temp")
    return text.replace("25 degC", temperature, 1).replace("slip_velocity: 300 mm/s", f"slip_velocity: {slip}")


@pytest.mark.campaign
@pytest.mark.parametrize(("compound", "off", "seed"), [*product(CASES, range(len(OFF)), (1, 2, 3))])
def test_a_shortened_recipe_has_no_trip(compound: str, off: int, seed: int) -> None:
    run = Simulation(recipe(compound), OFF[off], seed=seed).to_the_end(40_000.0)
    assert run.run.engine.control.state.trip is None and run.run.outcome is Outcome.DONE, run.run.reason


def test_a_heated_run_with_beliefs_off_by_30_percent_has_no_trip() -> None:
    text = SHORT.replace("25 degC", "35 degC")
    run = Simulation(text, OFF[1], seed=4).to_the_end(4000.0)
    assert run.notes.written("INSERT INTO trip") == [] and run.run.outcome is Outcome.DONE


def test_the_least_load_that_a_recipe_may_ask_for_has_no_trip() -> None:
    run = Simulation(SHORT.replace("200 N", "15 N"), seed=2).to_the_end(4000.0)
    assert run.notes.written("INSERT INTO trip") == [] and run.run.outcome is Outcome.DONE
