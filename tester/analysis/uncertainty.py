"""Uncertainty budget of a coefficient, after the GUM (JCGM 100:2008): contributions, standard, expanded.

Contributions are independent standard uncertainties in mu; they add in squares (GUM 5.1.2). The effective
degrees of freedom follow Welch-Satterthwaite (GUM G.4.1) and give the coverage factor for 95 %.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import hypot, inf, isfinite, radians, sqrt
from types import MappingProxyType

from tester.analysis.quantiles import t_quantile
from tester.analysis.results import CARRY_OVER, NAN, Judgement, flags_in

CONFIDENCE = 0.95

_RECTANGULAR = 1.0 / sqrt(3.0)
"""Standard uncertainty of a value known to lie within +-1, evenly distributed (GUM 4.3.7)."""

_SLOWEST_SLIP_M_S = 0.1
"""Below it the coefficient hardly depends on speed any more; keeps the relative error of slip finite [A]."""


@dataclass(frozen=True, slots=True)
class Contribution:
    """One cause: its standard uncertainty in mu and the degrees of freedom behind it (inf: taken as known)."""

    name: str
    standard: float
    df: float = inf


@dataclass(frozen=True, slots=True)
class Budget:
    """Contributions and their sum: standard uncertainty, effective df, coverage factor, expanded (95 %)."""

    contributions: tuple[Contribution, ...]
    standard: float
    df: float
    coverage: float
    expanded: float


@dataclass(frozen=True, slots=True)
class Instruments:
    """Limits of the measuring chain's errors, each as half the width of an even distribution.

    Defaults are [A]; sensitivities of mu are those of the paper's model near
    200 N, 300 mm/s, rounded up over the three compounds.
    """

    cell_linearity_percent: float = 0.1
    cell_crosstalk_percent: float = 0.5
    cell_zero_n: float = 0.5
    """0.1 N/K and 5 K of the cell between tare and contact."""
    misalignment_deg: float = 0.5
    temperature_k: float = 1.0
    """Session bias of the infrared thermometer."""
    speed_percent: float = 0.1
    speed_mm_s: float = 0.5
    mu_per_kelvin_percent: float = 1.5
    mu_load_exponent: float = 0.35
    mu_slip_exponent: float = 0.8


INSTRUMENTS = Instruments()


@dataclass(frozen=True, slots=True)
class Unsteadiness:
    """What a coefficient that does not quite stand still adds to the budget: standard uncertainties, per cent of it."""

    drift_percent: float = 0.0
    carry_over_percent: float = 0.0


STEADY = Unsteadiness()

_SPREAD = 1.0 / sqrt(12.0)
"""Standard deviation of what lies anywhere, evenly, in a range of 1."""


def unsteadiness(judged: Judgement) -> Unsteadiness:
    """Return what a condition's judgement adds: its drift always, with its own error; its trend where it carries over.

    The coefficient moves by (|d| + se(d)) times the windows of a repeat while that is measured, and by the trend over
    the repeats; a mean taken somewhere in that range is off by 1 / sqrt(12) of it (GUM 4.3.7).
    """
    drift = (abs(judged.drift_percent) + judged.drift_error_percent) * judged.repeat_windows * _SPREAD
    carried = abs(judged.trend_percent) * _SPREAD if CARRY_OVER in flags_in(judged.flags) else 0.0
    return Unsteadiness(drift if isfinite(drift) else 0.0, carried if isfinite(carried) else 0.0)


_NO_SETTINGS: Mapping[str, str] = MappingProxyType({})


def instruments_of(settings: Mapping[str, str] = _NO_SETTINGS) -> Instruments:
    """Return the defaults with those replaced that ``settings`` names as ``uncertainty.<field>``.

    Raises ValueError for a value that is no finite number >= 0; names that are no field are ignored.
    """
    values: dict[str, float] = {}
    for field in fields(Instruments):
        text = settings.get(f"uncertainty.{field.name}")
        if text is None:
            continue
        value = float(text)
        if not (isfinite(value) and value >= 0.0):
            raise ValueError(f"uncertainty.{field.name}: {text} is not a number >= 0")
        values[field.name] = value
    return Instruments(**values)


def budget(contributions: Sequence[Contribution]) -> Budget:
    """Combine contributions; NaN in any of them makes the sums NaN."""
    standard = sqrt(sum(c.standard**2 for c in contributions))
    if not isfinite(standard):
        return Budget(tuple(contributions), NAN, NAN, NAN, NAN)
    limited = sum(c.standard**4 / c.df for c in contributions)
    df = standard**4 / limited if limited > 0.0 else inf
    coverage = t_quantile(0.5 + 0.5 * CONFIDENCE, df)
    return Budget(tuple(contributions), standard, df, coverage, coverage * standard)


def friction_budget(
    mu: float,
    load_n: float,
    slip_m_s: float,
    type_a: Contribution,
    instruments: Instruments = INSTRUMENTS,
    unsteady: Unsteadiness = STEADY,
) -> Budget:
    """Return the budget of a coefficient ``mu`` measured at a load in N (> 0) and a slip speed in m/s.

    ``type_a`` is what repeating showed, ``unsteady`` what moved meanwhile.
    Misalignment of the cell by d turns load into friction and back:
    (1 + mu^2) d; crosstalk does the same with two independent shares.
    """
    if not (isfinite(mu) and load_n > 0.0):
        return budget([type_a, Contribution("cell calibration", NAN)])
    i = instruments
    linearity = 0.01 * i.cell_linearity_percent * _RECTANGULAR
    crosstalk = 0.01 * i.cell_crosstalk_percent * _RECTANGULAR
    speed = 0.01 * i.speed_percent + 1e-3 * i.speed_mm_s / max(abs(slip_m_s), _SLOWEST_SLIP_M_S)
    return budget(
        [
            Contribution("cell calibration", mu * linearity * sqrt(2.0)),
            Contribution("cell crosstalk", crosstalk * hypot(1.0, mu * mu)),
            Contribution("cell zero", i.cell_zero_n * _RECTANGULAR / load_n * hypot(1.0, mu)),
            Contribution("axis misalignment", (1.0 + mu * mu) * radians(i.misalignment_deg) * _RECTANGULAR),
            Contribution("temperature", mu * 0.01 * i.mu_per_kelvin_percent * i.temperature_k * _RECTANGULAR),
            Contribution("speed", mu * i.mu_slip_exponent * speed * _RECTANGULAR),
            Contribution("load", mu * i.mu_load_exponent * linearity),
            Contribution("drift", mu * 0.01 * unsteady.drift_percent),
            Contribution("carry-over", mu * 0.01 * unsteady.carry_over_percent),
            type_a,
        ]
    )
