"""The first conditions, as ordinary runs: slip in both directions to reveal misalignment; one condition three times."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, Final

from sim.physics.friction import KNOWN
from sim.physics.slip import predict
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.commission.thermometer import HUB_C
from tester.kinds.wheel_on_belt.control.loops import loss_ratios
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.commission.commission_step import Notes, RunRecipe, StepRefused
from tester.machine.commission.compound import FirstCoefficient, first_text

RECIPE: Final = """\
recipe: {title}
specimens:
  - compound: {compound}
    note: first wheel of a commissioning
measure:
  wheel_speed: {wheel} m/s
  repeats: {{at_least: {repeats}, at_most: {at_most}}}
  min_valid: {valid}
  window: {window} rev
  temperature_band: 4 degC
  soak: {{within: 3 degC, for: 2 s}}{more}
grids:
  - name: one
    slip_velocity: {slip} mm/s
    load: {load} N
    temperature: {temperature} degC
"""
WARMER_K: Final = 0.1
"""Offset of a condition's temperature, so that an unheated wheel is in the start band of its slip pulses [A]. That band
reaches from 0.3 K below to 0.1 K above the condition's temperature less the loop's ``rolling_offset``
(tester.kinds.wheel_on_belt.procedures.bursts)."""
BELOW_K: Final = 3.0
"""Difference by which the first condition's hub is below the soak's [A]: slip warms the tread by 1 K, and the ratio of
the losses is known to 10 %."""
LOAD_N: Final = 100.0
SLIP_M_S: Final = 0.1
"""Slip velocity of the first conditions [A]: its 6 W of friction hardly warm a tread."""
WHEEL_M_S: Final = 0.8
PAIRS: Final = 5
"""Pairs of repeats in both directions [A]: with 2 % scatter the angle is known to 0.5 degrees (95 %); with three pairs
only to 1.4."""
ANGLE_DEG: Final = 1.5
"""An apparent angle beyond this plus its uncertainty is refused [A]: 0.5 degrees from mounting, 0.5 % crosstalk."""


def _recipe(title: str, compound: str, temperature_c: float, *, both: bool) -> str:
    more = "\n  both_directions: true" if both else ""
    return RECIPE.format(
        title=title, compound=json.dumps(compound, ensure_ascii=False), wheel=WHEEL_M_S,
        repeats=PAIRS if both else 3, at_most=PAIRS + 1 if both else 6, valid=3, window=8 if both else 10, more=more,
        slip=f"{1e3 * SLIP_M_S:g}", load=f"{LOAD_N:g}",
        temperature=f"{temperature_c:.1f}",
    )  # fmt: skip


def mounted(notes: Notes) -> str:
    """Return the recorded compound of the wheel."""
    compound = notes.done.get("touch", {}).get("compound")
    if not compound:
        raise StepRefused("the wheel's compound is not recorded (the step touch asks for it)")
    return str(compound)


def as_it_is_c(rig: RigConfig, done: Mapping[str, Mapping[str, Any]]) -> float:
    """Return the temperature, degC, at which a cold wheel can be measured without heating.

    It is the thermometer's reading of the tread after rolling, plus the offset by which slip pulses start colder.
    """
    shown = float(done.get("rolling", {}).get("surface_c", rig.ambient_c))
    return shown + rig.loops.heat.rolling_offset_k + WARMER_K


def as_soaked_c(rig: RigConfig, done: Mapping[str, Mapping[str, Any]]) -> float:
    """Return the temperature of a condition that keeps the hub near its soak temperature, degC.

    In rolling contact the tread's excess over its cold reading is the hub's excess divided by 1 + ratio
    (``loops.loss_ratios``). So the wheel is heated only once, without a wait for cooling; ``BELOW_K`` keeps the hub
    below its earlier temperature.
    """
    soaked = done.get("thermometer", {})
    _, rolling = loss_ratios(rig)
    hub_k = float(soaked.get("hub_c", HUB_C)) - float(soaked.get("cold_hub_c", rig.ambient_c)) - BELOW_K
    return float(soaked.get("cold_c", rig.ambient_c)) + hub_k / (1.0 + rolling)


def directions(rig: Rig, run_recipe: RunRecipe, notes: Notes) -> None:
    """Slide both ways: half the sum of the signed coefficients is crosstalk and misalignment (tester.analysis)."""
    warm_c = as_it_is_c(RigConfig.of(rig), notes.done)
    recipe = _recipe("both directions of slip", mounted(notes), warm_c, both=True)
    results = run_recipe("commissioning-directions", recipe)
    angle, expanded = results["angle_deg"], results["angle_expanded_deg"]
    if angle is None or expanded is None:
        raise StepRefused("both directions of slip gave no angle: too few pairs were valid")
    if not abs(angle) <= ANGLE_DEG + expanded:
        raise StepRefused(
            f"misalignment and crosstalk: the cell's axes seem {angle:+.2f} +- {expanded:.2f} degrees off the contact's"
            f" (more than {ANGLE_DEG:g}): shim the cell or the wheel's carrier, or measure in both directions"
        )
    notes.values = dict(results)
    notes.text = f"apparent angle of the cell {angle:+.2f} +- {expanded:.2f} degrees (95 %), run {results['run']}"


def coefficient(rig: Rig, run_recipe: RunRecipe, notes: Notes) -> None:
    """Measure one condition three times."""
    warm_c, compound = as_soaked_c(RigConfig.of(rig), notes.done), mounted(notes)
    recipe = _recipe("a first condition three times", compound, warm_c, both=False)
    results = run_recipe("commissioning-first", recipe)
    mu = float(results["conditions"][0]["mu"])
    at_c = round(warm_c, 1)
    expected = predict(compound, SLIP_M_S, LOAD_N, at_c, 0.0, WHEEL_M_S) if compound in KNOWN else None
    found = FirstCoefficient(
        compound, mu, expected,
        "is the wheel of another compound? Else the load cell's zero, or a belt that is worn or greasy",
        "take care; the cause may be a belt of another grade, or another compound",
    )  # fmt: skip
    notes.values = {**results, "compound": compound, "temperature_c": at_c, **found.plausible(notes)}
    notes.text = first_text(compound, results)
