"""A reference condition through a run: what the counterface does meanwhile, apart from what the pieces on it do.

The same condition is measured again and again. The logarithm of its coefficient, at the temperature asked for, is

    ln mu = level of the compound + a(piece) + b x + w z + repeatability,

x metres of counterface that travelled under load since the run began, z metres that the piece has slid, a(piece) normal
with the standard deviation from piece to piece. b is what the counterface loses a metre, w what a piece does. On one
piece x and z grow together, and b and w cannot be told apart. They are where the piece was changed CHANGES times or
more, for z begins anew with each, or where a piece was reserved for it, which hardly slides meanwhile.

Solved by generalised least squares (Aitken's estimator). Of w it is known beforehand that it is small
(``PIECE_PER_M``); the deviation from piece to piece is the stated one and that of the residuals between pieces, weighed
by their degrees of freedom, as it is between replicates (``tester.analysis.measurand``). The interval is Student's t
with the degrees of freedom of Welch and Satterthwaite.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, expm1, hypot, inf, isfinite, log, sqrt
from statistics import median
from typing import Final

from tester.analysis.quantiles import t_quantile
from tester.analysis.uncertainty import CONFIDENCE, Contribution, contribution, effective_df

NAME: Final = "reference"
"""Grid of reference conditions, in a run whose record says that it has some."""
EVERY: Final = "reference_every"
"""Key of a run's metadata: it has references, one after so many conditions."""
RESERVED: Final = "reference_reserved"
"""Key of a run's metadata: name of the piece that was reserved for them."""

CHANGES: Final = 6
"""Changes of the piece after which counterface and pieces are told apart: an interval from fewer is wider than what a
worn counterface loses [A]."""
LEAST: Final = 3
"""References on a reserved piece before anything is said."""
PIECE_PER_M: Final = 2e-4
"""Standard deviation, before anything is measured, of what a metre of sliding changes a piece's coefficient by, 1/m
[A].
A wheel of 90 mm that wears at 0.24 mm3/(N m) and is believed to at 0.08 slides at 200 N and 300 mm/s 0.5 % slower in
each 30 m than it is reckoned to: twice this is what an exponent of 0.8 makes of that."""
STATED_DF: Final = 8
"""Weight of the stated deviation from piece to piece beside that of the residuals, degrees of freedom [A]."""
SIGMAS: Final = 3.0
"""Half the width of the chart of a mean of n with known s: A = 3 / sqrt(n) times s (ISO 7870-2, given standard
values). The centre is a mean of as many itself: sqrt(2) times that."""
COUNTERFACE: Final = "counterface"
"""Name of its term in a compound's budget."""


@dataclass(frozen=True, slots=True)
class Reference:
    """One reference condition as it was found.

    ``mu`` at the temperature asked for, NaN without a value; ``u_share`` what repeats leave open of it, relative,
    standard; travel of the counterface and sliding of the piece in m, at the mean of its repeats.
    """

    number: int
    """From 1, in the order in which they were measured."""
    condition: int
    t_s: float
    """Rig time at which it began."""
    compound: str
    piece: int
    mu: float
    u_share: float
    counterface_m: float
    piece_m: float

    @property
    def usable(self) -> bool:
        """Return whether it says anything."""
        values = (self.u_share, self.counterface_m, self.piece_m)
        return self.mu > 0.0 and isfinite(self.mu) and all(isfinite(one) for one in values)


@dataclass(frozen=True, slots=True)
class KnownScatter:
    """What is known of scatter, relative standard deviations: between repeats, pooled over the run, with its degrees of
    freedom (inf: taken as known); from piece to piece, as stated; whether a piece was reserved."""

    repeats_df: float = inf
    between: float = 0.03
    reserved: bool = False


@dataclass(frozen=True, slots=True)
class CounterfaceDrift:
    """What the counterface does to the coefficient a metre of its travel under load: d ln mu / dm and its standard
    uncertainty, 1/m. ``apart`` False: the piece has a part in it that is not known."""

    per_m: float
    standard: float
    df: float
    first_m: float
    last_m: float
    """Travel at the first reference and at the last."""
    references: int
    pieces: int
    apart: bool
    reserved: bool = False

    @property
    def over_m(self) -> float:
        """Return the travel that the references lie over, m."""
        return self.last_m - self.first_m

    @property
    def coverage(self) -> float:
        """Return how many standard uncertainties the interval has on each side, 95 %."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, max(self.df, 1.0))

    def changed_percent(self, over_m: float) -> tuple[float, float, float]:
        """Return the change over so many metres, per cent of the coefficient, and its interval (95 %): low, high."""
        half = self.coverage * self.standard
        low, high = (100.0 * expm1((self.per_m + way * half) * over_m) for way in (-1.0, 1.0))
        return 100.0 * expm1(self.per_m * over_m), low, high

    def contribution(self, mu: float, at_m: float) -> Contribution:
        """Return what it contributes to the compound's coefficient at a travel: nothing is corrected for, so all that
        it has changed since the first reference, and what is not known of that."""
        told = f"{self.references} references over {self.over_m:.0f} m, not corrected"
        source = told if self.apart else f"{told}, the piece's part in it"
        rate = hypot(self.per_m, self.standard)
        return contribution(COUNTERFACE, rate, mu * (at_m - self.first_m), unit="1/m", df=self.df, source=source)

    def sentence(self, worn: str) -> str:
        """Return what was found, for people; ``worn``: what they call a piece."""
        change, low, high = self.changed_percent(self.over_m)
        over = f"over {self.over_m:.0f} m of travel under load"
        if not self.apart:
            need = f"{LEAST} references" if self.reserved else f"{CHANGES} changes of the {worn} or a reserved {worn}"
            told = f"coefficient {change:+.1f} % {over}"
            return f"{told}, but counterface and {worn} cannot be told apart: that takes {need}"
        by = f"a reserved {worn}" if self.reserved else f"{self.pieces} {worn}s"
        moves = "" if low > 0.0 or high < 0.0 else ", not resolved from 0"
        return f"counterface {change:+.1f} % ({low:+.1f} to {high:+.1f} %, 95 %) {over}, by {by}{moves}"


def counterface_drift(references: Sequence[Reference], known: KnownScatter) -> CounterfaceDrift | None:
    """Return what references say of the counterface; None with fewer than two of them, or without travel between."""
    used = [one for one in references if one.usable]
    travelled = [one.counterface_m for one in used]
    if len(used) < 2 or max(travelled) - min(travelled) <= 0.0:
        return None
    pieces = sorted({one.piece for one in used})
    apart = len(used) >= LEAST if known.reserved else len(pieces) > CHANGES
    compounds = sorted({one.compound for one in used})
    if len(used) <= len(compounds):
        return None
    between, between_df = _between(used, pieces, compounds, known)
    per_m, parts = _solve(used, pieces, compounds, between, between_df, known.repeats_df, slides=apart)
    standard = sqrt(sum(u * u for u, _ in parts))
    df = effective_df(parts, standard)
    return CounterfaceDrift(
        per_m, standard, df, min(travelled), max(travelled), len(used), len(pieces), apart, known.reserved
    )


def _between(
    used: Sequence[Reference], pieces: Sequence[int], compounds: Sequence[str], known: KnownScatter
) -> tuple[float, float]:
    """Return the deviation from piece to piece and its degrees of freedom: the stated one, and that of what is left of
    the pieces' means about a line in the travel."""
    import numpy as np

    stated, df = known.between**2, len(pieces) - len(compounds) - 1
    if df < 1:
        return known.between, float(STATED_DF)
    groups = [[one for one in used if one.piece == piece] for piece in pieces]
    values = np.array([sum(log(one.mu) for one in group) / len(group) for group in groups])
    design = np.array([
        [*(float(group[0].compound == name) for name in compounds),
         sum(one.counterface_m for one in group) / len(group)] for group in groups
    ])  # fmt: skip
    design[:, -1] -= design[:, -1].mean()
    off = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    own = [sum(one.u_share**2 for one in group) / len(group) ** 2 for group in groups]
    found = max(float(off @ off) / df - sum(own) / len(own), 0.0)
    return sqrt((STATED_DF * stated + df * found) / (STATED_DF + df)), float(STATED_DF + df)


def _solve(
    used: Sequence[Reference],
    pieces: Sequence[int],
    compounds: Sequence[str],
    between: float,
    between_df: float,
    repeats_df: float,
    *,
    slides: bool,
) -> tuple[float, list[tuple[float, float]]]:
    """Return the change a metre, and the parts of its standard uncertainty with their degrees of freedom.

    ``slides``: the pieces change with their own sliding, too; else all change is taken for the counterface's.
    """
    import numpy as np

    count = len(used)
    belongs = np.array([[float(one.piece == piece) for piece in pieces] for one in used])
    own = np.array([one.u_share for one in used])
    travel = np.array([one.counterface_m for one in used])
    scale = float(np.ptp(travel))
    columns = [*([float(one.compound == name) for one in used] for name in compounds), (travel - travel[0]) / scale]
    design, values = np.array(columns).T, np.array([log(one.mu) for one in used])
    covariance = np.diag(own**2) + between**2 * belongs @ belongs.T
    if slides:
        slid = np.array([one.piece_m for one in used]) / scale
        prior = np.zeros(design.shape[1] + 1)
        prior[-1] = 1.0
        design = np.vstack([np.column_stack([design, slid]), prior])
        values = np.append(values, 0.0)
        covariance = np.pad(covariance, (0, 1))
        covariance[-1, -1] = (PIECE_PER_M * scale) ** 2
    weights = np.linalg.pinv(covariance, hermitian=True)
    taken = (np.linalg.pinv(design.T @ weights @ design) @ design.T @ weights)[len(compounds)]
    seen = taken[:count]
    parts = [
        (between * float(np.linalg.norm(belongs.T @ seen)) / scale, between_df),
        (float(np.linalg.norm(seen * own)) / scale, repeats_df),
    ]
    if slides:
        parts.append((abs(float(taken[-1])) * PIECE_PER_M, inf))
    return float(taken @ values) / scale, parts


@dataclass(frozen=True, slots=True)
class ControlPoint:
    """One reference on a control chart; ``within``: it lies inside the limits.

    The coefficient is at the temperature asked for, with its expanded repeatability (95 %); NaN without a value.
    """

    number: int
    condition: int
    t_s: float
    mu: float
    expanded: float
    within: bool


@dataclass(frozen=True, slots=True)
class ControlChart:
    """References of one compound in their order. The centre is the first of them; limits of the coefficient."""

    compound: str
    centre: float
    low: float
    high: float
    points: tuple[ControlPoint, ...]

    @property
    def kept(self) -> bool:
        """Return whether all that have a value lie inside the limits."""
        return all(one.within for one in self.points if isfinite(one.mu))


def control_charts(references: Sequence[Reference], known: KnownScatter) -> tuple[ControlChart, ...]:
    """Return a chart for each compound that a reference has a value of.

    The deviation that is known is that of the repeats, and where pieces were changed, that from piece to piece.
    """
    coverage = t_quantile(0.5 + 0.5 * CONFIDENCE, known.repeats_df)
    charts: list[ControlChart] = []
    for compound in dict.fromkeys(one.compound for one in references):
        listed = [one for one in references if one.compound == compound]
        used = [one for one in listed if one.mu > 0.0 and isfinite(one.u_share)]
        if not used:
            continue
        pieces = len({one.piece for one in used})
        sigma = hypot(median(one.u_share for one in used), known.between if pieces > 1 else 0.0)
        half, centre = SIGMAS * sqrt(2.0) * sigma, used[0].mu
        low, high = centre * exp(-half), centre * exp(half)
        points = [
            ControlPoint(
                one.number, one.condition, one.t_s, one.mu, coverage * one.u_share * one.mu, low <= one.mu <= high
            )
            for one in listed
        ]
        charts.append(ControlChart(compound, centre, low, high, tuple(points)))
    return tuple(charts)


def doubted(charts: Sequence[ControlChart], conditions: Sequence[int]) -> frozenset[int]:
    """Return the conditions that lie between a reference out of its limits and the last good one before it."""
    points = sorted((point for chart in charts for point in chart.points), key=lambda one: one.condition)
    found: set[int] = set()
    good = 0
    for point in points:
        if point.within:
            good = point.condition
        elif isfinite(point.mu):
            found.update(one for one in conditions if good < one < point.condition)
    return frozenset(found)


def is_reference(grid: str, metadata: Mapping[str, str]) -> bool:
    """Return whether a condition of a grid is a reference in a run with this metadata."""
    return grid == NAME and EVERY in metadata

