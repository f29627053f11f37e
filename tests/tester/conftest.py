"""Runs shared by several tests, made once."""

from __future__ import annotations

import pytest

from tests.tester.kinds.wheel_on_belt.bench import HOT, QUIET, SHORT, Simulation, in_burst

PRE_GRIND = "pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}\n"
REST = "rest: {at_least: 30 s, until: 40 degC}\n"


@pytest.fixture(scope="session")
def quiet_run() -> Simulation:
    """The short recipe on a rig without noise, scatter or running-in, to its end."""
    return Simulation(overrides=QUIET).to_the_end()


@pytest.fixture(scope="session")
def noisy_run() -> Simulation:
    """The short recipe, two repeats, with pre-grinding and a rest, on the default rig, to its end."""
    text = SHORT.replace("repeats: 1", "repeats: 2").replace("14 rev", "30 rev") + PRE_GRIND + REST
    return Simulation(text, seed=1).to_the_end()


@pytest.fixture(scope="session")
def pulsed_run() -> Simulation:
    """3# at 400 N without noise: slip warms the surface by kelvins a second, so that a window takes several bursts."""
    text = SHORT.replace("1#", "3#").replace("200 N", "400 N").replace("14 rev", "20 rev")
    return Simulation(text, (*QUIET, "sim.ambient=24")).to_the_end()


@pytest.fixture(scope="session")
def yawed_run() -> Simulation:
    """The short recipe with a sideslip angle, to its end."""
    text = SHORT.replace("14 rev", "6 rev") + "    sideslip: 20 deg\n"
    return Simulation(text, QUIET).to_the_end()


@pytest.fixture(scope="session")
def rolling_run() -> Simulation:
    """The short recipe at 0 mm/s, to its end."""
    return Simulation(SHORT.replace("300 mm/s", "0 mm/s"), QUIET).to_the_end()


@pytest.fixture(scope="session")
def hot_run() -> Simulation:
    """3# at 400 N on the hot rig: a condition that cannot be held."""
    text = SHORT.replace("1#", "3#").replace("200 N", "400 N").replace("14 rev", "14 rev\n  max_bursts: 3")
    return Simulation(text, HOT).to_the_end()


@pytest.fixture(scope="session")
def warm_run() -> Simulation:
    """1# at 200 N on the hot rig, without noise: a condition that can just be held."""
    text = SHORT.replace("14 rev", "14 rev\n  max_bursts: 5")
    return Simulation(text, (*HOT, *QUIET)).to_the_end()


@pytest.fixture(scope="session")
def mid_burst() -> Simulation:
    """A run that has just begun to count; copy it before you continue it."""
    return Simulation(seed=1).until(in_burst)
