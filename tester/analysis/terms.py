"""Terms of the budget from the machine: the possible errors of its measuring chain, as data.

A kind of rig supplies its terms (``tester.machine.run_parts``), a run's record keeps them, and this module turns them
into contributions to the uncertainty of one coefficient. An error reaches mu in one of a few ways (``Acts``), each a
formula of the coefficient and the channels measured with it.

In a coefficient from both directions of sliding (``tester.analysis.directions``) errors that do not reverse with the
sliding drop out. A rotation theta leaves its square, mu (1 + mu^2) theta^2, and so does crosstalk. A speed that adds to
the sliding one way reduces it the other way: its channel counts with half the difference of the directions. The
variance of independent errors is halved. The rest acts the same both ways, and stays.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from math import hypot, inf, isfinite, pi, radians, sqrt
from types import MappingProxyType
from typing import Final

from tester.analysis.results import NAN
from tester.analysis.uncertainty import Contribution, contribution

SLOWEST_M_S: Final = 0.1
"""Below it the coefficient hardly depends on speed; keeps the relative error of sliding finite [A]."""

SPREADS: Final[Mapping[str, float]] = MappingProxyType(
    {"rectangular": 1.0 / sqrt(3.0), "U-shaped": 1.0 / sqrt(2.0), "normal": 1.0}
)
"""Standard uncertainty of a bound of 1, by distribution: anywhere within +-1 (GUM 4.3.7); more often near +-1 than near
0 (GUM H.1.3.4 for its case); for a normal one the bound is the standard uncertainty itself."""

_NO_SETTINGS: Mapping[str, str] = MappingProxyType({})
PREFIX: Final = "uncertainty."
"""Prefix of a recipe's free fields that replace a bound or a factor."""


class Acts(StrEnum):
    """How an error reaches the coefficient mu = Ft / Fz; each entry lists the sensitivity, per unit of the error."""

    FRICTION = "friction force"
    """N, of Ft: 1 / Fz."""
    NORMAL = "normal force"
    """N, of Fz: mu / Fz."""
    ROTATION = "rotation"
    """degrees between the axes of the cell and those of the contact: load becomes friction and back, 1 + mu^2."""
    CROSSTALK = "crosstalk"
    """Share of one force that appears in the channel of the other, two independent ones: sqrt(1 + mu^4)."""
    TEMPERATURE = "temperature"
    """K, of the surface: mu times its relative sensitivity."""
    LAG = "lag"
    """s, of the thermometer behind a temperature that changes; the term's factor is the lag itself, s."""
    SLIDING = "sliding speed"
    """m/s: mu / v, times the exponent with which mu follows v."""
    SIZE = "size"
    """mm, of the diameter from which a speed is computed: that speed's sensitivity."""
    LOSS = "loss"
    """As SIZE; the bound is a share of the estimated wear."""
    COEFFICIENT = "coefficient"
    """Share of mu itself: mu."""
    PIECE = "piece"
    """Share of mu by which mounted pieces of the same compound differ: mu. It is an error of the compound's
    coefficient, not of this piece's."""


@dataclass(frozen=True, slots=True)
class Term:
    """A possible error: ``bound`` in ``unit``, its distribution, and how it reaches mu.

    ``channel``: the bound is a share of its mean; for SIZE and LOSS the speed computed from the diameter. ``factor``
    multiplies the sensitivity. ``common``: rig (the same in all conditions measured on it), piece (in all on the
    mounted piece), "" (independent). ``setting`` and ``factor_setting``: names under which a recipe's metadata replaces
    bound and factor, as ``uncertainty.<name>``. ``whole_at``: of FRICTION and NORMAL, the force in N from which the
    bound counts whole; below it the bound shrinks with the force (a cell after its tare is right at 0 N). 0: whole at
    any force.
    """

    name: str
    acts: Acts
    bound: float
    unit: str
    distribution: str
    source: str
    channel: str = ""
    factor: float = 1.0
    df: float = inf
    common: str = "rig"
    setting: str = ""
    factor_setting: str = ""
    whole_at: float = 0.0

    def __post_init__(self) -> None:
        """Raise ValueError for an unknown distribution, or a number out of range."""
        if self.distribution not in SPREADS:
            raise ValueError(f"{self.name}: {self.distribution!r} is none of {', '.join(SPREADS)}")
        if not (isfinite(self.bound) and self.bound >= 0.0 and isfinite(self.factor) and self.df > 0.0):
            raise ValueError(f"{self.name}: bound {self.bound}, factor {self.factor}, degrees of freedom {self.df}")
        if self.whole_at and not (self.whole_at > 0.0 and self.acts in (Acts.FRICTION, Acts.NORMAL)):
            raise ValueError(f"{self.name}: whole_at {self.whole_at} N (expected 0 or more, of a force)")

    @property
    def standard(self) -> float:
        """Return the standard uncertainty of the error, in its unit."""
        return self.bound * SPREADS[self.distribution]


@dataclass(frozen=True, slots=True)
class Size:
    """The diameter of the mounted piece: mm, its estimated wear, and the result of checks.

    ``checked_u_mm``: standard uncertainty of the loss by checks, NaN without a check; ``source``: which checks.
    """

    size_mm: float = NAN
    loss_mm: float = 0.0
    checked_u_mm: float = NAN
    source: str = "check of the diameter"

    @property
    def checked(self) -> bool:
        """Return whether the loss was measured."""
        return isfinite(self.checked_u_mm)


NO_SIZE: Final = Size()


@dataclass(frozen=True, slots=True)
class BudgetPoint:
    """Conditions at a measured coefficient: load in N, sliding speed in m/s, means of the channels by name.

    ``per_kelvin``: relative sensitivity to temperature, 1/K; ``rate_k_s``: how fast the surface warmed.
    """

    mu: float
    normal_n: float
    sliding_m_s: float
    means: Mapping[str, float]
    per_kelvin: float = 0.0
    rate_k_s: float = 0.0
    size: Size = NO_SIZE
    turning: Mapping[str, float] | None = None
    """Of a coefficient from both directions: half the difference of the channels' means between them."""

    def speed(self, channel: str) -> float:
        """Return the part of a speed channel's mean that contributes to the sliding speed, m/s."""
        return abs((self.means if self.turning is None else self.turning).get(channel, NAN))


def with_settings(terms: Iterable[Term], settings: Mapping[str, str] = _NO_SETTINGS) -> tuple[Term, ...]:
    """Return terms with the bounds and factors that ``settings`` replaces as ``uncertainty.<name>``.

    Raises ValueError for a value that is no finite number >= 0; names that match no term are ignored.
    """
    return tuple(
        replace(
            term,
            bound=_set(term.setting, term.bound, settings),
            factor=_set(term.factor_setting, term.factor, settings),
        )
        for term in terms
    )


def _set(name: str, default: float, settings: Mapping[str, str]) -> float:
    text = settings.get(f"{PREFIX}{name}") if name else None
    return default if text is None else setting_of(f"{PREFIX}{name}", text)


def setting_of(name: str, text: str) -> float:
    """Return the number that replaces a bound or a factor; raises ValueError unless it is finite and >= 0."""
    try:
        value = float(text)
    except ValueError:
        value = NAN
    if not (isfinite(value) and value >= 0.0):
        raise ValueError(f"{name}: {text} is not a number >= 0")
    return value


def contributions_of(terms: Sequence[Term], at: BudgetPoint) -> list[Contribution]:
    """Return the contributions of terms to the uncertainty of a coefficient; NaN each without a load."""
    return [_contribution(term, at) for term in terms]


def _contribution(term: Term, at: BudgetPoint) -> Contribution:
    standard, source, distribution = term.standard, term.source, term.distribution
    if term.acts is Acts.LOSS:
        standard *= abs(at.size.loss_mm)
        if at.size.checked:
            standard, source, distribution = at.size.checked_u_mm, at.size.source, "normal"
    elif term.acts is Acts.SLIDING:
        standard *= at.speed(term.channel) if term.channel else 1.0
    elif term.channel and term.acts is not Acts.SIZE:
        standard *= abs(at.means.get(term.channel, NAN))
    if term.whole_at:
        force_n = abs(at.normal_n * at.mu) if term.acts is Acts.FRICTION else abs(at.normal_n)
        standard *= min(1.0, force_n / term.whole_at)
    per_unit = sensitivity(term, at)
    return contribution(
        term.name,
        standard,
        per_unit,
        unit=term.unit,
        df=term.df,
        source=source,
        distribution=distribution,
        common=term.common,
    )


def sensitivity(term: Term, at: BudgetPoint) -> float:
    """Return the change of mu per unit of a term's error; NaN without a load."""
    mu, load = at.mu, at.normal_n
    if not (isfinite(mu) and load > 0.0):
        return NAN
    sliding = max(abs(at.sliding_m_s), SLOWEST_M_S) if isfinite(at.sliding_m_s) else NAN
    match term.acts:
        case Acts.FRICTION:
            plain = 1.0 / load
        case Acts.NORMAL:
            plain = mu / load
        case Acts.ROTATION:
            plain = (1.0 + mu * mu) * pi / 180.0
        case Acts.CROSSTALK:
            plain = hypot(1.0, mu * mu)
        case Acts.TEMPERATURE:
            plain = mu * at.per_kelvin
        case Acts.LAG:
            return mu * at.per_kelvin * at.rate_k_s
        case Acts.SLIDING:
            plain = mu / sliding
        case Acts.SIZE | Acts.LOSS:
            plain = mu * at.speed(term.channel) / (at.size.size_mm * sliding)
        case Acts.COEFFICIENT | Acts.PIECE:
            plain = mu
    return term.factor * plain * (_left(term, mu) if at.turning is not None else 1.0)


def _left(term: Term, mu: float) -> float:
    """Return the share of a sensitivity that remains in the mean of both directions of sliding."""
    if term.acts is Acts.ROTATION:
        return mu * radians(term.bound)
    if term.acts is Acts.CROSSTALK:
        return mu * term.bound
    independent = term.acts in (Acts.FRICTION, Acts.NORMAL) and not term.common
    return sqrt(0.5) if independent else 1.0
