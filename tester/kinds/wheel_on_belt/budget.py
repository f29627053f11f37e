"""What this machine's measuring chain may be off by, and what is known of compounds' sensitivity to temperature."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, log
from typing import Final

from sim.physics.friction import COMPOUNDS, FrictionModel
from tester.analysis.kelvin import UNKNOWN, KnownSlope, SurfaceWarmth
from tester.analysis.terms import Acts, BudgetPoint, Size, Term, contributions_of
from tester.analysis.uncertainty import Budget, budget
from tester.kinds.wheel_on_belt.axes import Held
from tester.recipe.plan import Plan
from tester.store import older

TERMS: Final[tuple[Term, ...]] = older.TERMS
"""Those of the records that do not say theirs, as long as nothing about the machine is known better."""



def terms_of(cell_sensitivity: float, record: str) -> tuple[Term, ...]:
    """Return the terms of a rig; one whose cell was calibrated with weights has what was found in them.

    ``cell_sensitivity``: of Fx over Fz, with its standard uncertainty (``commission.weights``), 0: not stated.
    """
    if not cell_sensitivity > 0.0:
        return TERMS
    source = f"hung weights, record {record[:12]}" if record else "hung weights"
    sensitivity = Term(
        "cell sensitivity", Acts.COEFFICIENT, cell_sensitivity, "1", "normal", source, setting="cell_sensitivity"
    )
    return (*TERMS, sensitivity)


BETWEEN_PERCENT: Final = 100.0 * sum(one.standard for one in TERMS if one.acts is Acts.PIECE)
"""Standard deviation from wheel to wheel of one compound, as stated."""

PUBLISHED: Final = "Table 3 of doi 10.3390/polym16050596"
SHARE, LEAST_PERCENT = 0.3, 0.2
"""Standard uncertainty of a published sensitivity: this share of it, and %/K [A]: a law of one batch of rubber, fitted
with residuals of 3 to 6 % over 60 K."""
_STEP_K = 0.5


def published_percent(compound: str, temperature_c: float) -> float:
    """Return the published sensitivity of a compound at a temperature in degC, %/K; raises UnknownCompoundError."""
    law = FrictionModel(compound)
    above, below = (law.mu(temperature_c + step, 200.0, 0.3) for step in (_STEP_K, -_STEP_K))
    return 100.0 * log(above / below) / (2.0 * _STEP_K)


def known_slope(compound: str, temperature_c: float) -> KnownSlope | None:
    """Return what is published of a compound near a temperature in degC; None where nothing is."""
    if compound not in COMPOUNDS:
        return None
    percent = published_percent(compound, temperature_c)
    return KnownSlope(compound, temperature_c, percent, hypot(SHARE * percent, LEAST_PERCENT), PUBLISHED)


def known_slopes(plan: Plan) -> Iterator[KnownSlope]:
    """Yield what is published of the plan's compounds at its temperatures."""
    wanted = ((step.setpoint.compound, step.setpoint.number("temperature")) for step in plan.conditions())
    for compound, at_c in dict.fromkeys(wanted):
        found = known_slope(compound, at_c)
        if found is not None:
            yield found


def instruments_budget(
    held: Held, mu: float, sliding_m_s: float, diameter_mm: float, *, both_directions: bool = False
) -> Budget:
    """Return what the measuring chain adds to the uncertainty of a coefficient that is expected, on a new wheel."""
    found = known_slope(held.compound, held.temperature_c)
    slope = found.slope if found is not None else UNKNOWN
    means = {"wheel_speed_m_s": held.wheel_speed_m_s, "belt_speed_m_s": held.belt_speed_m_s}
    turning = {"wheel_speed_m_s": 0.0, "belt_speed_m_s": -held.slip_velocity_m_s} if both_directions else None
    size = Size(diameter_mm)
    at = BudgetPoint(mu, held.load_n, sliding_m_s, means, slope.per_kelvin, size=size, turning=turning)
    chain = [one for one in TERMS if one.acts is not Acts.PIECE]
    return budget([*contributions_of(chain, at), SurfaceWarmth(slope=slope).contribution(mu, chain)])
