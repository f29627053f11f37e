"""A reference condition through a run: the change of the counterface, separated from that of the pieces.

The same condition is measured again and again. The logarithm of its coefficient, at the nominal temperature, is

  ln mu = level of the compound + a(piece) + b x + w z + repeatability,

x metres of counterface that travelled under load since the run began, z metres that the piece has slid, a(piece) normal
with the standard deviation from piece to piece. b is the counterface's change per metre, w a piece's. On one piece x
and z grow together, and b and w cannot be separated. They can be separated where the piece was changed CHANGES times or
more, since z restarts with each piece, or where a piece is reserved for references, which hardly slides meanwhile.

Solved by generalised least squares (Aitken's estimator). w has a small prior (``PIECE_PER_M``); the deviation from
piece to piece combines the stated one and that of the residuals between pieces, weighed by their degrees of freedom, as
it is between replicates (``tester.analysis.measurand``). The interval is Student's t with the degrees of freedom of
Welch and Satterthwaite.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import expm1, hypot, inf, isfinite, log, sqrt
from typing import Final

from tester.analysis.quantiles import t_quantile
from tester.analysis.uncertainty import CONFIDENCE, Contribution, contribution, effective_df

NAME: Final = "reference"
"""Grid of reference conditions, in a run whose metadata has references."""
EVERY: Final = "reference_every"
"""Key of a run's metadata: number of conditions between references."""
RESERVED: Final = "reference_reserved"
"""Key of a run's metadata: name of the piece reserved for them."""

CHANGES: Final = 6
"""Changes of the piece that separate counterface and pieces: an interval from fewer is wider than the loss of a worn
counterface [A]."""
LEAST: Final = 3
"""Least number of references on a reserved piece for a result."""
PIECE_PER_M: Final = 2e-4
"""Prior standard deviation of a piece's change of the coefficient per metre of sliding, 1/m [A]. A wheel of 90 mm that
wears at 0.24 mm3/(N m), where the rig file assumes 0.08, slides at 200 N and 300 mm/s 0.5 % slower in each 30 m than
computed. With an exponent of 0.8 the effect is twice this prior."""
STATED_DF: Final = 8
"""Weight of the stated deviation from piece to piece beside that of the residuals, degrees of freedom [A]."""
COUNTERFACE: Final = "counterface"
"""Name of the counterface's term in a compound's budget."""


@dataclass(frozen=True, slots=True)
class Reference:
    """One measurement of the reference condition.

    ``mu`` at the nominal temperature, NaN without a value; ``u_share`` its relative standard uncertainty from repeats;
    travel of the counterface and sliding of the piece in m, at the mean of its repeats.
    """

    number: int
    """From 1, in the order of measurement."""
    condition: int
    t_s: float
    """Rig time of its beginning."""
    compound: str
    piece: int
    mu: float
    u_share: float
    counterface_m: float
    piece_m: float
    surface: str = ""
    """Name of the counterface, "" of a run's only one."""

    @property
    def usable(self) -> bool:
        """Return whether the value and all its figures are known."""
        values = (self.u_share, self.counterface_m, self.piece_m)
        return self.mu > 0.0 and isfinite(self.mu) and all(isfinite(value) for value in values)


@dataclass(frozen=True, slots=True)
class KnownScatter:
    """Known scatter, relative standard deviations: between repeats, pooled over the run, with its degrees of freedom
    (inf: taken as known); from piece to piece, as stated; whether a piece is reserved."""

    repeats_df: float = inf
    between: float = 0.03
    reserved: bool = False


@dataclass(frozen=True, slots=True)
class CounterfaceDrift:
    """One counterface's change of the coefficient per metre of its travel under load: d ln mu / dm and its standard
    uncertainty, 1/m. ``apart`` False: it includes an unknown part of the piece's change."""

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
        """Return the travel between the first reference and the last, m."""
        return self.last_m - self.first_m

    @property
    def coverage(self) -> float:
        """Return the coverage factor of 95 %."""
        return t_quantile(0.5 + 0.5 * CONFIDENCE, max(self.df, 1.0))

    def changed_percent(self, over_m: float) -> tuple[float, float, float]:
        """Return the change over a travel in m, per cent of the coefficient, and its interval (95 %): low, high."""
        half = self.coverage * self.standard
        low, high = (100.0 * expm1((self.per_m + way * half) * over_m) for way in (-1.0, 1.0))
        return 100.0 * expm1(self.per_m * over_m), low, high

    def contribution(self, mu: float, at_m: float) -> Contribution:
        """Return the contribution to the compound's coefficient at a travel. No correction is made, so it covers the
        whole change since the first reference, and the uncertainty of that."""
        basis = f"{self.references} references over {self.over_m:.0f} m, not corrected"
        source = basis if self.apart else f"{basis}, the piece's part in it"
        rate = hypot(self.per_m, self.standard)
        return contribution(COUNTERFACE, rate, mu * (at_m - self.first_m), unit="1/m", df=self.df, source=source)

    def sentence(self, worn: str) -> str:
        """Return the result as a sentence; ``worn``: the kind's word for a piece."""
        change, low, high = self.changed_percent(self.over_m)
        over = f"over {self.over_m:.0f} m of travel under load"
        if not self.apart:
            need = f"{LEAST} references" if self.reserved else f"{CHANGES} changes of the {worn} or a reserved {worn}"
            seen = f"coefficient {change:+.1f} % {over}"
            return f"{seen}, but counterface and {worn} cannot be told apart: that takes {need}"
        by = f"a reserved {worn}" if self.reserved else f"{self.pieces} {worn}s"
        moves = "" if low > 0.0 or high < 0.0 else ", not resolved from 0"
        return f"counterface {change:+.1f} % ({low:+.1f} to {high:+.1f} %, 95 %) {over}, by {by}{moves}"


def counterface_drift(references: Sequence[Reference], known: KnownScatter) -> CounterfaceDrift | None:
    """Return the change of one counterface from its references; None with fewer than two of them, or no travel."""
    used = [reference for reference in references if reference.usable]
    travelled = [reference.counterface_m for reference in used]
    if len(used) < 2 or max(travelled) - min(travelled) <= 0.0:
        return None
    pieces = sorted({reference.piece for reference in used})
    apart = len(used) >= LEAST if known.reserved else len(pieces) > CHANGES
    compounds = sorted({reference.compound for reference in used})
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
    """Return the deviation from piece to piece and its degrees of freedom: the stated one combined with that of the
    residuals of the pieces' means about a line in the travel."""
    import numpy as np

    stated, df = known.between**2, len(pieces) - len(compounds) - 1
    # Too few pieces for an estimate: only the stated deviation counts.
    if df < 1:
        return known.between, float(STATED_DF)
    groups = [[reference for reference in used if reference.piece == piece] for piece in pieces]
    values = np.array([sum(log(reference.mu) for reference in group) / len(group) for group in groups])
    design = np.array([
        [*(float(group[0].compound == name) for name in compounds),
         sum(reference.counterface_m for reference in group) / len(group)] for group in groups
    ])  # fmt: skip
    design[:, -1] -= design[:, -1].mean()
    off = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    repeats_alone = [sum(reference.u_share**2 for reference in group) / len(group) ** 2 for group in groups]
    between_pieces = max(float(off @ off) / df - sum(repeats_alone) / len(repeats_alone), 0.0)
    return sqrt((STATED_DF * stated + df * between_pieces) / (STATED_DF + df)), float(STATED_DF + df)


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
    """Return the change per metre, and the parts of its standard uncertainty with their degrees of freedom.

    ``slides``: the pieces change with their own sliding as well; otherwise all change is taken for the counterface's.
    """
    import numpy as np

    count = len(used)
    belongs = np.array([[float(reference.piece == piece) for piece in pieces] for reference in used])
    repeats = np.array([reference.u_share for reference in used])
    travel = np.array([reference.counterface_m for reference in used])
    scale = float(np.ptp(travel))
    columns = [
        *([float(reference.compound == name) for reference in used] for name in compounds),
        (travel - travel[0]) / scale,
    ]
    design, values = np.array(columns).T, np.array([log(reference.mu) for reference in used])
    covariance = np.diag(repeats**2) + between**2 * belongs @ belongs.T
    if slides:
        slid = np.array([reference.piece_m for reference in used]) / scale
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
        (float(np.linalg.norm(seen * repeats)) / scale, repeats_df),
    ]
    if slides:
        parts.append((abs(float(taken[-1])) * PIECE_PER_M, inf))
    return float(taken @ values) / scale, parts


def is_reference(grid: str, metadata: Mapping[str, str]) -> bool:
    """Return whether a condition of a grid is a reference in a run with this metadata."""
    return grid == NAME and EVERY in metadata
