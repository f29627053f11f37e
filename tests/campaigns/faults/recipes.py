"""The recipes of the campaign: short ones that cover every step."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from sim import machines
from sim.faults.language import FaultLanguage
from tester.kinds import load_rig
from tester.run.kind_lookup import run_parts
from tester.run.simulated import spec_of
from tests.campaigns.faults.corners import corners
from tests.tester.kinds.wheel_on_belt.bench import SHORT

QUICK = """\
recipe: campaign, quickstart-like
specimens:
  - compound: "1#"
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 s}
rest: {at_least: 5 s, until: 40 degC, within: 5 degC}
measure:
  wheel_speed: 0.8 m/s
  repeats: 2
  min_valid: 2
  window: 14 rev
  soak: {within: 2 degC, for: 2 s}
grids:
  - name: two loads
    slip_velocity: 300 mm/s
    load: [200 N, 100 N]
    temperature: 25 degC
"""
"""Pre-grinding, rest, two loads near ambient."""

SIDESLIP = """\
recipe: campaign, sideslip
specimens:
  - compound: "2#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 14 rev
  soak: {within: 2 degC, for: 2 s}
grids:
  - name: yawed
    slip_velocity: 300 mm/s
    load: 200 N
    temperature: 25 degC
    sideslip: 10 deg
"""
"""A wheel at an angle: every burst lifts, yaws and touches again."""

HEATED = """\
recipe: campaign, heated
specimens:
  - compound: "3#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 14 rev
  soak: {within: 2 degC, for: 2 s}
grids:
  - name: warm
    slip_velocity: 200 mm/s
    load: 150 N
    temperature: 40 degC
"""
"""Heating to 40 degC, soak, slip pulses in the band, cool-down at the end."""

REVERSED = """\
recipe: campaign, reversed
specimens:
  - compound: "1#"
measure:
  wheel_speed: 0.8 m/s
  repeats: 1
  min_valid: 1
  window: 14 rev
  soak: {within: 2 degC, for: 2 s}
grids:
  - name: both
    slip_velocity: 300 mm/s
    load: 200 N
    temperature: 25 degC
    both_directions: true
"""
"""Both directions of slip: the belt slower than the wheel, then faster, near its greatest accepted speed."""

GRID = ("quick", "sideslip", "heated", "reversed")
"""The recipes of the campaign."""

RECIPES = {"quick": QUICK, "sideslip": SIDESLIP, "heated": HEATED, "reversed": REVERSED, "short": SHORT}
"""``short`` is the recipe that is stopped and killed at every scan."""


class TrackRecipe(NamedTuple):
    """A recipe for a specimen on a track, and the packaged rig it runs on."""

    rig: str
    text: str
    overrides: tuple[str, ...] = ()


TRACKS = {
    "slow track": TrackRecipe("grosch", """\
recipe: campaign, slow track
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 0.2 mm, at_least: 2 s, soak: {within: 1 K, for: 4 s}}
grids:
  - {name: warm, load: [10 N, 20 N], temperature: 26 degC, track_speed: [0.2 mm/s, 4 mm/s]}
"""),
    "disc": TrackRecipe("pin-on-disc", """\
recipe: campaign, disc
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 100 mm, at_least: 2 s, temperature_band: 5 K,
          soak: {within: 3 K, for: 2 s}}
grids:
  - {name: wet, interface: [dry, wet], load: 10 N, temperature: 23 degC, track_speed: 0.3 m/s}
"""),
    "wet road": TrackRecipe("pin-on-disc", """\
recipe: campaign, wet road
kind: specimen_on_track
specimens: [{compound: SBR}]
measure: {repeats: 1, min_valid: 1, distance: 100 mm, at_least: 2 s, temperature_band: 5 K, least_friction: 0.02,
          soak: {within: 3 K, for: 2 s}}
grids:
  - {name: wet, interface: wet, load: 10 N, temperature: 23 degC, track_speed: 0.3 m/s}
""", ("sim.contact.wet=0.0094",)),
}  # fmt: skip
"""Short recipes of the second kind of machine, by their names."""


class Setting(NamedTuple):
    """A recipe's text, and the rig's differences from the packaged one."""

    text: str
    overrides: tuple[str, ...] = ()


def language_of(recipe: str) -> FaultLanguage:
    """Return the fault language of a recipe's machine, including faults with shares from its rig file."""
    return _language(TRACKS[recipe].rig if recipe in TRACKS else "sim")


def has(recipe: str, fault: str) -> bool:
    """Return whether the kind of machine of a recipe knows a fault, with or without a magnitude."""
    return any(fault == phrase or fault.startswith(f"{phrase} ") for phrase in language_of(recipe).catalogue)


@cache
def _language(rig_name: str) -> FaultLanguage:
    rig = load_rig(rig_name)
    return machines.find(run_parts(rig).plant).language(spec_of(rig))


def setting_of(recipe: str) -> Setting:
    """Return a recipe of the campaign, or a corner (tests.campaigns.faults.corners), by its name. Raises KeyError."""
    if recipe in TRACKS:
        return Setting(TRACKS[recipe].text, TRACKS[recipe].overrides)
    if recipe in RECIPES:
        return Setting(RECIPES[recipe])
    corner = corners()[recipe]
    return Setting(corner.text, corner.overrides)
