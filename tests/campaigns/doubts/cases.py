"""The cases: recipes, their friction, and the rig file's wrong beliefs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi
from random import Random
from typing import Final

STEP_PERCENT: Final = 15.0
SWING: Final = 0.10
"""Stick-slip swings by this share to either side."""
SWING_HZ: Final = (1.0, 8.0)
CLEAR_HZ: Final = 0.3
"""Minimum distance of a stick-slip frequency from any order of the wheel."""
TURN_HZ: Final = 0.8 / (pi * 0.09)
"""Turns a second of a 90 mm wheel at 0.8 m/s."""
LOADS: Final = ("100 N", "200 N", "300 N")
WHEEL, DISC = "sim", "pin-on-disc"

BELIEFS: Final = {
    "as believed": (),
    "wear": ("wear.rate=0.24",),
    "diameter": ("sim.wheel.outer_diameter=89.5",),
    "heat": ("observer.friction_heat_fraction=0.078", "sim.thermal.film_rotating=16.8 W/(m2 K)"),
}
"""The rig file's wrong beliefs about the twin: wear three times as fast, a wheel half a millimetre too large, 30 % more
friction heat and a fifth less loss to the air."""

_WHEEL: Final = """\
recipe: doubts
specimens: [{{compound: "{compound}"}}]
{reference}measure:
  wheel_speed: 0.8 m/s
  repeats: 3
  window: 30 rev
  temperature_band: 2 degC
  soak: {{within: 1 degC, for: 60 s}}
grids:
  - name: conditions
    slip_velocity: {slip}
    load: {load}
    sideslip: {angle}
    temperature: {temperature}
"""
_DISC: Final = """\
recipe: doubts
kind: specimen_on_track
specimens: [{{compound: {compound}}}]
abrasive: {{name: road}}
measure:
  repeats: 2
  min_valid: 2
  distance: 300 mm
  at_least: 5 s
  temperature_band: 5 K
  soak: {{within: 3 K, for: 5 s}}
grids:
  - name: conditions
    interface: {interface}
    load: {load}
    temperature: 23 degC
    track_speed: {speed}
"""


@dataclass(frozen=True, slots=True)
class Case:
    """One run. Friction changes in ``condition`` and ``repeat`` (0: its soak); (0, 0): nowhere."""

    topic: str
    rig: str
    recipe: str
    seed: int
    overrides: tuple[str, ...] = ()
    condition: int = 0
    repeat: int = 0
    hz: float = 0.0


def wheel_recipe(compound: str = "1#", *, slip: str = "300 mm/s", load: str = "100 N", angle: str = "0 deg",
                 temperature: str = "30 degC", references: bool = False) -> str:  # fmt: skip
    """Return a recipe for a wheel on a belt."""
    reference = "reference: {every: 2}\n" if references else ""
    return _WHEEL.format(compound=compound, slip=slip, load=load, angle=angle, temperature=temperature,
                         reference=reference)  # fmt: skip


def disc_recipe(compound: str = "SBR", *, load: str = "20 N", speed: str = "0.1 m/s",
                interface: str = "dry") -> str:  # fmt: skip
    """Return a recipe for a pin on a disc."""
    return _DISC.format(compound=compound, load=load, speed=speed, interface=interface)


def beliefs(rig: str, seed: int) -> tuple[str, ...]:
    """Return the rig's beliefs in the run of a seed: a ground-in tread, and one of ``BELIEFS``."""
    return ("sim.running_in=0", *list(BELIEFS.values())[seed % len(BELIEFS)]) if rig == WHEEL else ()


def steps(seeds: int) -> Iterator[Case]:
    """Yield runs in which friction changes within a first repeat, in a later one, and between two conditions."""
    for seed in range(1, seeds + 1):
        random = Random(f"step {seed}")
        for rig in (WHEEL, DISC):
            recipe = wheel_recipe(load=random.choice(LOADS)) if rig == WHEEL else disc_recipe()
            off = beliefs(rig, seed)
            yield Case("first repeat", rig, recipe, seed, off, 1, 1)
            yield Case("later repeat", rig, recipe, seed, off, 1, random.randint(2, 3 if rig == WHEEL else 2))
        off = beliefs(WHEEL, seed)
        # With references there are four conditions: 1 and 4 are references.
        two = wheel_recipe(load="[100 N, 250 N]", references=True)
        yield Case("between, references", WHEEL, two, seed, off, random.randint(2, 4))
        yield Case("between, no references", WHEEL, wheel_recipe(load="[100 N, 250 N]"), seed, off, 2)


def frequencies(count: int) -> list[float]:
    """Return stick-slip frequencies in Hz, evenly spread over the gaps between the wheel's orders."""
    low, high = SWING_HZ
    fine = [low + (high - low) * i / 999 for i in range(1000)]
    clear = [hz for hz in fine if min(abs(hz - k * TURN_HZ) for k in range(1, 5)) >= CLEAR_HZ]
    return [clear[i * (len(clear) - 1) // max(count - 1, 1)] for i in range(count)]


def swings(seeds: int) -> Iterator[Case]:
    """Yield runs with stick-slip: straight, with sideslip, and on a disc."""
    for seed, hz in enumerate(frequencies(seeds), start=1):
        stick = (f"sim.stick_slip={SWING}", f"sim.stick_slip_frequency={hz:.3f} Hz")
        off = (*beliefs(WHEEL, seed), *stick)
        load = LOADS[seed % len(LOADS)]
        yield Case("stick-slip", WHEEL, wheel_recipe(load=load), seed, off, hz=hz)
        yield Case("stick-slip, sideslip", WHEEL, wheel_recipe(load=load, angle="10 deg"), seed, off, hz=hz)
        yield Case("stick-slip", DISC, disc_recipe(), seed, stick, hz=hz)


def steady_recipes() -> tuple[str, ...]:
    """Return the recipes of a wheel with steady friction: 30 conditions of three compounds."""
    return (
        wheel_recipe("1#", load="[100 N, 200 N, 300 N]", slip="[100 mm/s, 300 mm/s]", temperature="[25 degC, 40 degC]"),
        wheel_recipe("2#", load="[100 N, 300 N]", slip="[100 mm/s, 200 mm/s, 300 mm/s]", temperature="55 degC"),
        wheel_recipe("3#", load="[100 N, 200 N]", slip="[100 mm/s, 200 mm/s]", temperature="[40 degC, 70 degC]"),
        wheel_recipe("1#", load="[100 N, 200 N]", slip="300 mm/s", angle="[5 deg, 10 deg]", temperature="40 degC"),
    )


def steady(seeds: int) -> Iterator[Case]:
    """Yield runs in which friction is steady."""
    speeds = "[0.05 m/s, 0.1 m/s, 0.2 m/s, 0.5 m/s, 1 m/s]"
    for seed in range(1, seeds + 1):
        for number, recipe in enumerate(steady_recipes()):
            yield Case("steady", WHEEL, recipe, seed, beliefs(WHEEL, seed + number))
        for rubber in ("SBR", "NBR"):
            recipe = disc_recipe(rubber, load="[10 N, 20 N]", speed=speeds, interface="[dry, wet]")
            yield Case("steady", DISC, recipe, seed)
