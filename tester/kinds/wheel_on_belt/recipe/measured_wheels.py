"""Diameters that a person measured of wheels, held against the diameter with which the rig computes speeds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from tester.base.source import Location, Problem, Tree
from tester.base.units import show
from tester.inputs.recipe.recipe_schema import Recipe
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.rig import RigConfig

INSTALLED_MM: Final = next(term.bound for term in TERMS if term.name == "diameter as installed")
"""Greatest error of a wheel's believed diameter, mm, as in the budget."""


def off_place_mm(rig: RigConfig, diameter_mm: float) -> float:
    """Return the allowed distance of a wheel's first touch from its expected place, mm."""
    p = rig.interlocks
    return 0.5 * p.first_contact_sweep * diameter_mm + p.first_contact_place_mm


def diameter_problems(rig: RigConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield the measured diameters with which the first contact would not find the wheel where it expects it."""
    most_mm = 2.0 * off_place_mm(rig, rig.geometry.wheel_diameter_mm)
    for at, value_mm in _measured(recipe):
        if abs(value_mm - rig.geometry.wheel_diameter_mm) > most_mm:
            fault = f"diameter: {show(value_mm, 'mm')} is another wheel than the rig expects: its first contact fails"
            yield tree.problem(at, f"{fault} ({_believed(rig)}, within {most_mm:.2g} mm by interlocks.first_contact)")


def diameter_doubts(rig: RigConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a doubt for each measured diameter beyond the uncertainty of the believed one."""
    believed_mm = rig.geometry.wheel_diameter_mm
    for at, value_mm in _measured(recipe):
        off_mm = value_mm - believed_mm
        if abs(off_mm) > INSTALLED_MM:
            speed = f"every speed of the wheel is off by {100.0 * abs(off_mm) / believed_mm:.1f} %"
            fault = f"diameter: {show(value_mm, 'mm')} is not the diameter that the run calculates with: {speed}"
            yield tree.problem(at, f"{fault} ({_believed(rig)}, within {INSTALLED_MM:g} mm as in the budget)")


def _believed(rig: RigConfig) -> str:
    return f'expected geometry.wheel_diameter of rig "{rig.name}": {show(rig.geometry.wheel_diameter_mm, "mm")}'


def _measured(recipe: Recipe) -> Iterator[tuple[Location, float]]:
    """Yield the measured diameters, mm, with their positions in the recipe."""
    for number, specimen in enumerate(recipe.specimens):
        values = specimen.measured.diameter if specimen.measured is not None else None
        for place, value_mm in enumerate(values or ()):
            at: Location = ("specimens", number, "measured", "diameter")
            yield ((*at, place) if len(values or ()) > 1 else at), value_mm
