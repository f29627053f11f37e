"""Coefficients measured by a synthetic chain whose errors have the distributions that the budget declares.

The forward model is written here independently, from forces: the misalignment turns load and friction, each channel has
crosstalk, linearity and zero errors; speeds, diameter and temperature have errors, and the rubber responds to their
true values. This tests the budget's sensitivities as well as its sums.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, exp, pi, radians, sin, sqrt
from random import Random
from typing import Final

from tester.analysis.kelvin import Slope, SurfaceWarmth
from tester.analysis.measurand import Surroundings, pooled, with_budget, with_budget_of_replicates
from tester.analysis.repeats import ConditionResult, combine_repeats, combine_replicates
from tester.analysis.results import Judgement, RepeatResult, RepeatStatus
from tester.analysis.terms import Size
from tester.base.quantities import Means
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES

BETWEEN, REPEATS, OTHERS = 0.03, 0.02, 5
"""Relative standard deviations from wheel to wheel and from repeat to repeat; conditions of a run with a common repeat
scatter."""
WHEEL_M_S, DIAMETER_MM, LOSS_MM, OFFSET_K = 0.8, 90.0, 0.1, 0.4
DRIFT = Judgement(drift_percent=0.3, drift_error_percent=0.2, repeat_windows=1.5)


@dataclass(frozen=True, slots=True)
class Cell:
    """A condition: its coefficient, load N, sliding m/s, sensitivity and its uncertainty, 1/K; repeats."""

    name: str
    mu: float
    load_n: float
    sliding_m_s: float
    per_kelvin: float
    u_per_kelvin: float
    repeats: int


CELLS: Final = (
    Cell("1#, 200 N, 300 mm/s, 25 degC", 0.73, 200.0, 0.3, 0.0005, 0.002, 3),
    Cell("1#, 100 N, 100 mm/s, 55 degC", 0.60, 100.0, 0.1, 0.0079, 0.003, 3),
    Cell("3#, 200 N, 300 mm/s, 55 degC", 1.40, 200.0, 0.3, 0.0255, 0.008, 3),
    Cell("3#, 400 N, 400 mm/s, 85 degC", 1.20, 400.0, 0.4, -0.0239, 0.007, 5),
    Cell("2#, 400 N, 300 mm/s, 40 degC", 0.45, 400.0, 0.3, 0.0, 0.026, 3),
    Cell("2#, 100 N, 400 mm/s, 25 degC, one repeat", 0.65, 100.0, 0.4, 0.002, 0.002, 1),
)


@dataclass(frozen=True, slots=True)
class Chain:
    """Constant errors of a rig: forces N, shares, angle, kelvin."""

    friction_n: float
    normal_n: float
    held_n: float
    seen: tuple[float, float]
    turned: float
    thermometer_k: float
    lag: float
    speeds: tuple[float, float]


def rig(random: Random) -> Chain:
    """Draw a rig."""

    def even(most: float) -> float:
        return random.uniform(-most, most)

    return Chain(
        even(1.0),
        even(0.6),
        even(0.6),
        (even(0.005), even(0.005)),
        radians(0.5) * sin(2.0 * pi * random.random()),
        even(1.0),
        even(1.0),
        (even(0.001), even(0.001)),
    )


def measured(cell: Cell, mu: float, chain: Chain, random: Random, slope_off: float) -> ConditionResult:
    """Measure a wheel whose coefficient at the nominal condition is ``mu``; return its result with budgets.

    ``slope_off``: error of the believed temperature sensitivity, in standard uncertainties.
    """
    belt = WHEEL_M_S - cell.sliding_m_s
    diameter = random.uniform(-0.15, 0.15) + LOSS_MM * random.gauss(0.0, 1.0)
    excess = WHEEL_M_S * (chain.speeds[0] + diameter / DIAMETER_MM) + belt * chain.speeds[1]
    slides = mu * max(1.0 + excess / cell.sliding_m_s, 0.1) ** 0.8
    truly_k = OFFSET_K + chain.thermometer_k
    sensitivity = cell.per_kelvin + slope_off * cell.u_per_kelvin
    slides *= exp(sensitivity * truly_k) * (1.0 + 0.35 * chain.held_n / cell.load_n)
    slides *= 1.0 + random.uniform(-0.5, 0.5) * 0.01 * 0.5 * DRIFT.repeat_windows
    friction, load = slides * cell.load_n, cell.load_n
    c, s = cos(chain.turned), sin(chain.turned)
    along, normal = friction * c + load * s, load * c - friction * s
    along, normal = along + chain.seen[0] * normal, normal + chain.seen[1] * along
    along += chain.friction_n + random.uniform(-0.5, 0.5)
    normal += chain.normal_n + random.uniform(-0.5, 0.5)
    shown = along / normal
    means = _means(cell)
    values = [shown * (1.0 + random.gauss(0.0, REPEATS)) for _ in range(cell.repeats)]
    repeats = [RepeatResult(RepeatStatus.VALID, mu_resultant=value, fluctuation_percent=1.0, batches=10, means=means)
               for value in values]  # fmt: skip
    found = combine_repeats(repeats, cell.repeats, judged=DRIFT)
    others = [replace(found, mu_resultant=1.0, s=_s(random, 3), n_valid=3) for _ in range(OTHERS)]
    warmth = SurfaceWarmth(25.0, 25.0 + OFFSET_K, 0.0, Slope(cell.per_kelvin, cell.u_per_kelvin, "made up", known=True))
    by = Surroundings(TERMS, pooled([found, *others]), warmth, Size(DIAMETER_MM, LOSS_MM))
    return with_budget(found, by)


def replicates(cell: Cell, mu: float, chain: Chain, random: Random, slope_off: float, count: int) -> ConditionResult:
    """Measure a compound on so many wheels, one after the other on a rig; return the compound's result."""
    each = [measured(cell, mu * (1.0 + random.gauss(0.0, BETWEEN)), chain, random, slope_off) for _ in range(count)]
    if count == 1:
        return each[0]
    warmth = SurfaceWarmth(25.0, 25.0 + OFFSET_K, 0.0, Slope(cell.per_kelvin, cell.u_per_kelvin, "made up"))
    by = Surroundings(TERMS, pooled(each), warmth, Size(DIAMETER_MM, LOSS_MM))
    return with_budget_of_replicates(combine_replicates(each), each, by)


def _means(cell: Cell) -> Means:
    given = {
        "force_z_n": cell.load_n,
        "slip_m_s": cell.sliding_m_s,
        "surface_c": 25.0 + OFFSET_K,
        "wheel_speed_m_s": WHEEL_M_S,
        "belt_speed_m_s": WHEEL_M_S - cell.sliding_m_s,
    }
    return Means(QUANTITIES, [given.get(one.name, 0.0) for one in QUANTITIES.averaged])


def _s(random: Random, n: int) -> float:
    values = [random.gauss(0.0, REPEATS) for _ in range(n)]
    mean = sum(values) / n
    return sqrt(sum((value - mean) ** 2 for value in values) / (n - 1))
