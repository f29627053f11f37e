"""The first coefficient: an ordinary short run, held against the model of its compound."""

from __future__ import annotations

import json
from typing import Final

from sim.physics.track import TrackParameters
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.commission.air import set_point_c
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Notes, RunRecipe, StepRefused
from tester.machine.commission.compound import FirstCoefficient, first_text

RECIPE: Final = """\
recipe: a first condition three times
kind: specimen_on_track
specimens:
  - compound: {compound}
    note: first specimen of a commissioning
measure:
  repeats: 3
  min_valid: 3
  distance: {way} mm
  at_least: 5 s
  temperature_band: {band} K
  soak: {{within: {within} K, for: 30 s, at_most: 15 min}}
grids:
  - name: one
    load: {load} N
    temperature: {temperature} degC
    track_speed: {speed} m/s
"""
SPEED_M_S, WAY_MM = 1e-4, 0.5
"""Speed and way on a linear track [A]: here the glass transitions of rubbers make the greatest difference."""
DISC_M_S, DISC_MM = 0.1, 500.0
"""The same on a disc [A]: a revolution and more."""


def recipe_of(rig: TrackConfig, compound: str) -> tuple[str, float, float, float]:
    """Return the recipe, and its speed in m/s, load in N and temperature in degC."""
    speed, way = (SPEED_M_S, WAY_MM) if rig.linear else (DISC_M_S, DISC_MM)
    speed = min(max(speed, rig.limits.slowest_m_s), rig.limits.track_speed_m_s)
    load = rig.weights[len(rig.weights) // 2]
    temperature_c = round(set_point_c(rig), 1)
    within, band = (1, 2) if rig.chamber else (3, 5)
    text = RECIPE.format(
        compound=json.dumps(compound, ensure_ascii=False), way=f"{way:g}", band=band, within=within, load=f"{load:g}",
        temperature=f"{temperature_c:.1f}", speed=f"{speed:g}",
    )  # fmt: skip
    return text, speed, load, temperature_c


def coefficient(rig: Rig, run_recipe: RunRecipe, notes: Notes) -> None:
    """Measure one condition three times; raises StepRefused."""
    own = TrackConfig.of(rig)
    compound = str(notes.done.get("load", {}).get("compound", ""))
    if not compound:
        raise StepRefused("the specimen's compound is not recorded (the step load asks for it)")
    text, speed, load, temperature_c = recipe_of(own, compound)
    results = run_recipe("commissioning-first", text)
    mu = float(results["conditions"][0]["mu"])
    found = FirstCoefficient(
        compound, mu, _expected(own.sim, compound, temperature_c, load, speed),
        "is the specimen of another compound? Else a track that is wet, greasy or powdered, or another load on the arm",
        "take care; the cause may be another track, or another compound",
    )  # fmt: skip
    notes.values = {**results, "compound": compound, "temperature_c": temperature_c, **found.plausible(notes)}
    notes.text = first_text(compound, results)


def _expected(sim: TrackParameters, compound: str, temperature_c: float, load_n: float, speed_m_s: float
              ) -> float | None:  # fmt: skip
    """Return what the law gives; None for a compound that the law does not know, or a law made of materials."""
    if sim.of_materials:
        return None
    try:
        law = sim.law_of(compound)
    except ValueError:
        return None
    return law.mu(temperature_c, load_n, speed_m_s)
