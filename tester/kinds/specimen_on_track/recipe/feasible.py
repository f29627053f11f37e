"""Parts of a recipe that a rig cannot do, or is unlikely to do: temperatures without a chamber, friction that is too
low, a simulated law without its rubber or surface."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

from sim.physics.laws import NO_SETTING
from sim.physics.materials import OutsideError
from tester.base.axes import Setpoint, condition_words
from tester.base.source import InvalidSource, Location, Problem, Tree
from tester.inputs.materials.setting import law_setting
from tester.inputs.recipe.conditions import conditions_of
from tester.inputs.recipe.recipe_schema import Recipe, surfaces_of
from tester.kinds.specimen_on_track.axes import AXES, TrackHeld, held_by
from tester.kinds.specimen_on_track.interlocks.witness import HALF, LOW, is_low, least_low_n, least_stated
from tester.kinds.specimen_on_track.recipe.estimate import TrackEstimator
from tester.kinds.specimen_on_track.recipe.schema import track_settings, track_settings_of
from tester.kinds.specimen_on_track.rig import TrackConfig


def out_of_reach(
    rig: TrackConfig, temperatures_c: Sequence[float], within_k: float, at: Location, tree: Tree
) -> Iterator[Problem]:
    """Yield temperatures that a rig without a chamber cannot reach in the air of its room.

    ``within_k``: greatest distance of the air from a condition's temperature (soak.within).
    """
    if rig.chamber:
        return
    room_c = rig.ambient_c
    for index, air_c in enumerate(temperatures_c):
        if not abs(air_c - room_c) <= within_k:
            key = "sim.ambient" if rig.simulated else "ambient"
            yield tree.problem(
                (*at, "temperature", index),
                f'temperature: {air_c:g} degC cannot be reached: rig "{rig.name}" has no chamber, and its room is at'
                f" {room_c:g} degC ({key}; expected within {within_k:g} K of that, soak.within, or a chamber in"
                " devices)",
            )


def unwitnessed(rig: TrackConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a problem for each grid whose stated least friction is too low to show contact on this rig."""
    limits, high = rig.interlocks, "height_sensor" in rig.devices
    for number, grid in enumerate(recipe.grids):
        found: list[str] = []
        for entry in conditions_of(recipe.model_copy(update={"grids": [grid]}), track_settings):
            held = held_by(Setpoint("", entry.values, AXES))
            least_mu = least_stated(track_settings_of(entry.settings).least_mu, held.interface, limits.lost_share)
            if not is_low(least_mu, limits.lost_share):
                continue
            if not high:
                found.append(
                    f"least_friction: {least_mu:g} is too little to show contact (interlocks.lost_share"
                    f' {100.0 * limits.lost_share:g} %), and rig "{rig.name}" has no second reading of it (expected'
                    " height_sensor in devices, or least_friction of"
                    f" {limits.lost_share / LOW:.2g} or more)"
                )
            elif not LOW * least_mu * held.load_n >= least_low_n(limits.deaf_n, least_mu, held.load_n):
                found.append(
                    f"least_friction: {least_mu:g} of {held.load_n:g} N is {least_mu * held.load_n:.2g} N, and a deaf"
                    f" cell may show {limits.deaf_n:g} N (interlocks.deaf; expected a load of"
                    f" {limits.deaf_n / (LOW * least_mu):.2g} N or more)"
                )
        if found:
            yield tree.problem(("grids", number), found[0])


def low_friction(rig: TrackConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a problem for each compound with conditions whose expected friction counts as a lost contact."""
    if not rig.simulated:
        return  # the friction of a real specimen is unknown
    estimator = TrackEstimator.of(rig, recipe, Path(tree.name))
    for number, specimen in enumerate(recipe.specimens):
        result: list[tuple[float, str, float, str]] = []
        for entry in conditions_of(recipe, track_settings):
            setpoint = Setpoint(specimen.compound, entry.values, AXES)
            mu = estimator.mu(setpoint)
            least, key = _least(rig, track_settings_of(entry.settings).least_mu, held_by(setpoint))
            if not LOW * mu >= least:
                result.append((mu, condition_words(setpoint), least, key))
        if result:
            mu, words, least, key = min(result)
            yield tree.problem(
                ("specimens", number, "compound"),
                f"sim.law {rig.sim.law} expects friction of {100.0 * mu:.2g} % of the load at {words}, and too little"
                f" in {len(result)} conditions: below {100.0 * least:.3g} % the contact counts as lost and the run"
                f" trips ({key})",
            )


def _least(rig: TrackConfig, stated: float, held: TrackHeld) -> tuple[float, str]:
    """Return the least share of the load that counts as contact, and what it comes from or lacks."""
    limits, high = rig.interlocks, "height_sensor" in rig.devices
    least_mu = least_stated(stated, held.interface, limits.lost_share)
    if HALF * least_mu > limits.lost_share:
        return HALF * least_mu, "half of least_friction"
    if not high:
        lacks = f'rig "{rig.name}" has no second reading of the contact: height_sensor in devices'
        return limits.lost_share, f"interlocks.lost_share; {lacks}"
    if is_low(least_mu, limits.lost_share):
        share = least_low_n(limits.deaf_n, least_mu, held.load_n) / held.load_n
        return share, "interlocks.deaf, or half of least_friction"
    return limits.lost_share, "interlocks.lost_share; state least_friction for a wet or powdered track"


def law_problems(rig: TrackConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a problem for every compound that has no simulated law on a surface of the recipe."""
    sim = rig.sim
    surfaces = (surfaces_of(recipe) or [""]) if sim.by_surface else [""]
    if sim.surface and len(surfaces) > 1:
        fault = f'surface: the simulated track is covered with "{sim.surface}" throughout (sim.surface; expected "")'
        yield tree.problem(("grids",), fault)
    checked: set[tuple[str, str]] = set()
    for (number, specimen), surface in product(enumerate(recipe.specimens), surfaces):
        if (specimen.compound, surface) in checked:
            continue
        checked.add((specimen.compound, surface))
        setting = law_setting(surface, Path(tree.name)) if sim.by_surface else NO_SETTING
        try:
            sim.known_everywhere(specimen.compound, setting)
        except OutsideError as error:
            fault = f"{error}; a simulated track slides from standstill on (expected moduli with beyond: hold)"
        except InvalidSource as error:
            yield from error.problems
            continue
        except ValueError as error:
            fault = str(error)
        else:
            continue
        yield tree.problem(("specimens", number, "compound"), f"compound: sim.law {sim.law}: {fault}")


def area_problems(rig: TrackConfig, recipe: Recipe, tree: Tree) -> Iterator[Problem]:
    """Yield a problem for an area that is not the simulated one, where the simulated law depends on the pressure."""
    own_mm2, contact = rig.sim.contact.area, recipe.contact
    if contact is not None and rig.sim.of_materials and contact.area != own_mm2:
        yield tree.problem(
            ("contact", "area"),
            f"area: {contact.area:g} mm2, and sim.law {rig.sim.law} rubs on {own_mm2:g} mm2 (expected the area of"
            f" sim.contact.area, or --set 'sim.contact.area={contact.area:g} mm2')",
        )
