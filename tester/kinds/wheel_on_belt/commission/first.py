"""The first conditions, runs as any other: slip in both directions for what is crooked, then one condition thrice."""

from __future__ import annotations

from typing import Any, Final

from tester.commission.person import StepRefused
from tester.commission.step import Alone, Notes

RECIPE: Final = """\
recipe: {title}
specimens:
  - compound: "1#"
    note: first wheel of a commissioning
measure:
  wheel_speed: 0.8 m/s
  repeats: {repeats}
  min_valid: {repeats}
  window: {window} rev
  temperature_band: 4 degC
  soak: {{within: 3 degC, for: 2 s}}{more}
grids:
  - name: one
    slip_velocity: {slip} mm/s
    load: {load} N
    temperature: {temperature} degC
"""
WARMER_K: Final = 2.0
"""The surface is asked to be this much warmer than the air [A]: little has to be waited for, to warm or to cool."""
ANGLE_DEG: Final = 1.5
"""An apparent angle is refused beyond this and its uncertainty [A]: 0.5 degrees of mounting, 0.5 % of crosstalk."""


def _recipe(alone: Alone, title: str, load: float, *, both: bool) -> str:
    more = "\n  both_directions: true" if both else ""
    warm = round(alone.rig.ambient_c + WARMER_K)
    slip = 100 if both else 200
    return RECIPE.format(
        title=title, repeats=3, window=8 if both else 14, more=more, slip=slip, load=f"{load:g}", temperature=warm
    )


def directions(alone: Alone, notes: Notes) -> None:
    """Slip both ways: half the sum of the signed coefficients is crosstalk and misalignment (tester.analysis)."""
    found = alone.run_recipe("commissioning-directions", _recipe(alone, "both directions of slip", 50.0, both=True))
    angle, expanded = found["angle_deg"], found["angle_expanded_deg"]
    if angle is None or expanded is None:
        raise StepRefused("both directions of slip gave no angle: too few pairs were valid")
    if not abs(angle) <= ANGLE_DEG + expanded:
        raise StepRefused(
            f"misalignment and crosstalk: the cell's axes seem {angle:+.2f} +- {expanded:.2f} degrees off the contact's"
            f" (more than {ANGLE_DEG:g}): shim the cell or the wheel's carrier, or measure in both directions"
        )
    notes.values = dict(found)
    notes.text = f"apparent angle of the cell {angle:+.2f} +- {expanded:.2f} degrees (95 %), run {found['run']}"


def coefficient(alone: Alone, notes: Notes) -> None:
    """Measure one condition three times."""
    found = alone.run_recipe("commissioning-first", _recipe(alone, "a first condition three times", 100.0, both=False))
    one: dict[str, Any] = found["conditions"][0]
    notes.values = dict(found)
    spread = f"{100 * one['s'] / one['mu']:.1f} % between its {one['n']} repeats" if one["s"] is not None else ""
    uncertain = f", U {one['expanded']:.3f} (95 %)" if one["expanded"] is not None else ""
    notes.text = f"coefficient {one['mu']:.3f}{uncertain}; {spread}; run {found['run']}"
