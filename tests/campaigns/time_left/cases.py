"""The runs: five recipes, on rigs that differ from their files' beliefs."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Final, NamedTuple

import recipes
from tester.machine import tickers
from tests.campaigns.time_left.looks import Looked, in_a_folder

PIECE: Final = """\
recipe: a piece of Table 2
specimens: [{compound: "1#"}]
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
rest: {at_least: 20 min, until: 25 degC, within: 2 degC}
measure: {wheel_speed: 0.8 m/s, repeats: 5, window: 30 rev, temperature_band: 2 degC, max_bursts: 40,
          soak: {within: 1 degC, for: 60 s}}
grids:
  - {name: load and temperature, slip_velocity: 300 mm/s, load: [100 N, 400 N], temperature: [25 degC, 55 degC]}
order: {temperature: ascending, within: listed}
wheel: {replace_after: 2 mm}
"""
BOTH: Final = """\
recipe: two wheels, both directions, references
specimens: [{compound: "1#"}, {compound: "2#"}]
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
rest: {at_least: 20 min, until: 25 degC, within: 2 degC}
measure: {wheel_speed: 0.8 m/s, repeats: 2, min_valid: 2, window: 30 rev, temperature_band: 2 degC,
          both_directions: true, soak: {within: 1 degC, for: 60 s}}
grids:
  - {name: slip, slip_velocity: [100 mm/s, 300 mm/s], load: 200 N, temperature: 40 degC}
reference: {every: 2}
"""


class Recipe(NamedTuple):
    """A recipe on a packaged rig."""

    name: str
    rig: str
    text: str


class Case(NamedTuple):
    """One run to make; ``cut``: stopped on its way, and resumed."""

    recipe: Recipe
    seed: int
    cut: bool = False


def packaged(name: str, rig: str = "sim") -> Recipe:
    """Return a packaged recipe."""
    return Recipe(name, rig, Path(recipes.find(name)).read_text(encoding="utf-8"))


def all_recipes() -> list[Recipe]:
    """Return the five."""
    both = Recipe("both directions", "sim", BOTH)
    piece = Recipe("piece of table2", "sim", PIECE)
    return [packaged("pre-grind"), packaged("quickstart"), piece, both, packaged("pin-on-disc", "pin-on-disc")]


def truth(rig: str, seed: int) -> tuple[str, ...]:
    """Return a rig's differences from its file's beliefs, drawn for a seed."""
    if rig != "sim":
        return ()
    drawn = Random(f"truth {seed}").uniform
    return (
        f"sim.thermal.hub_capacity={420.0 * drawn(0.8, 1.2):.1f} J/K",
        f"sim.ambient={23.0 + drawn(-3.0, 3.0):.2f} degC",
        f"sim.wheel.outer_diameter={drawn(89.5, 90.5):.2f}",
        f"observer.friction_heat_fraction={0.06 * drawn(0.8, 1.2):.4f}",
        f"wear.rate={drawn(0.04, 0.24):.3f}",
        *(("sim.relaxation=1", "sim.softening=1", "sim.growth=1") if seed % 2 else ()),
    )


def carry_out(case: Case) -> tuple[Case, list[Looked]]:
    """Make a run with a look in every scan, as a run on a machine is shown ten times a second."""
    tickers.POLL_S = 0.0
    recipe = case.recipe
    return case, in_a_folder(recipe.text, recipe.rig, truth(recipe.rig, case.seed), case.seed, cut=case.cut)
