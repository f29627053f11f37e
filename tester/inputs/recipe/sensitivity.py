"""What compounds' own files know of how friction follows temperature, at the temperatures of a plan."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot
from typing import Final

from tester.analysis.kelvin import KnownSlope
from tester.inputs.materials.schema import CompoundModel
from tester.inputs.recipe.plan import Plan

SHARE: Final = 0.3
"""Standard uncertainty of a sensitivity from a file, as a share of it [A]: a law of another batch of rubber, fitted
with residuals of 3 to 6 % over 60 K."""
LEAST_PERCENT: Final = 0.2
"""What is not known of it at least, %/K [A]."""


def known_slopes(plan: Plan, compounds: Mapping[str, CompoundModel]) -> Iterator[KnownSlope]:
    """Yield what the files say of the plan's compounds at its temperatures; nothing beyond what was measured for them.

    ``compounds``: what each file says, by the name that the recipe has for it.
    """
    axis = next((one.name for one in plan.axes or () if one.unit == "degC"), "")
    if not axis:
        return
    wanted = ((step.setpoint.compound, step.setpoint.number(axis)) for step in plan.conditions())
    for compound, at_c in dict.fromkeys(wanted):
        found = known_slope(compounds[compound], at_c) if compound in compounds else None
        if found is not None:
            yield found


def known_slope(compound: CompoundModel, at_c: float) -> KnownSlope | None:
    """Return what a compound's file says at a temperature in degC; None where it says nothing, or holds no more."""
    law = compound.over_temperature
    if law is None or not law.least <= at_c <= law.most:
        return None
    percent = 100.0 * law.per_kelvin(at_c)
    source = f"the compound's file: {law.source or compound.source or 'no source'}"
    return KnownSlope(compound.name, at_c, percent, hypot(SHARE * percent, LEAST_PERCENT), source)
