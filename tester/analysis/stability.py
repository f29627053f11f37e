"""Whether a repeat's coefficient stands still: truncation of its transient, then a bound on what is left of
drift.

Truncation is MSER (marginal standard error rule, White 1997): leave out the first d blocks for which the
squared standard error of the rest, sum((y - mean)^2) / (n - d)^2, is least, d up to half of the blocks. A
least value at the end of that range means that the transient has not ended: not stabilised, unless the drift
over all blocks, this transient included, is shown to be within the limit (without noise MSER takes any slope
for a transient). A truncation that moves the mean by less than 0.1 % is not made.

Drift is the slope of block mu over accepted time, times the length of the window. A repeat of several
bursts warms up in each of them and cools between them; there the block's surface temperature is a second
regressor, so that the sawtooth is not taken for drift nor hides it; MSER sees the values without it. In a
single burst temperature runs with time and cannot be told from it: its effect then counts as drift.

Blocks of neighbouring revolutions are correlated (0.3 s in the rubber, 0.35 s a revolution). The residuals'
lag-1 correlation phi, within bursts, widens the standard error as for AR(1) noise in stretches of the
bursts' lengths, and the degrees of freedom are those of the effective number of blocks. Stabilised is an
equivalence test: the 90 % bound |drift| + t(0.95) * se must lie within the limit, so that a true drift of
the limit passes once in twenty.

Plain Python: the executor asks after each further revolution. Asking up to 61 times (30 to 90 revolutions)
lets a drift of exactly the limit pass one time in four; one of twice the limit never passed in the trials
(tests/tester/analysis/test_stability.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import floor, inf, isfinite, sqrt
from operator import mul

from tester.analysis.blocks import Block
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN

DRIFT_LIMIT_PERCENT = 2.0
"""Largest drift over a window that counts as standing still, per cent of the coefficient (physics.md 6)."""

MIN_BLOCKS = 6
"""Fewer blocks leave no degrees of freedom to speak of for trend, temperature and correlation."""

MATERIAL = 0.001
"""A truncation is made when it moves the mean by more than this share of it (a twentieth of the limit) [A]."""

TRANSIENT = "transient has not ended"

_MAX_CORRELATION = 0.9
_CONFIDENCE = 0.95
_DF_GRID = 0.5


@dataclass(frozen=True, slots=True)
class Stability:
    """What ``assess`` found. ``truncated`` blocks are transient; drift and bound: per cent, per window."""

    stabilised: bool
    reason: str
    blocks: int
    truncated: int
    drift_percent: float
    bound_percent: float
    correlation: float
    """Lag-1 correlation of the residuals of neighbouring blocks, 0..0.9."""
    effective: float
    """Number of independent blocks that would say as much about the mean."""

    @property
    def used(self) -> int:
        """Return the number of blocks that are left."""
        return self.blocks - self.truncated


def truncation(values: Sequence[float]) -> int | None:
    """Return how many leading values MSER leaves out; None when the least error is at the last one tried."""
    n = len(values)
    last = n // 2
    total = squares = 0.0
    # Deviations from the mean of the later half keep the sums of squares free of cancellation.
    origin = sum(values[last:]) / (n - last)
    best, best_at = inf, last
    for kept, value in enumerate(reversed(values), start=1):
        deviation = value - origin
        total += deviation
        squares += deviation * deviation
        if kept >= n - last:
            error = (squares - total * total / kept) / (kept * kept)
            # <=: of equal errors (noise-free values) the one that keeps more blocks.
            if error <= best:
                best, best_at = error, n - kept
    return None if best_at == last and last > 0 else best_at


def _inflation(bursts: Sequence[int], correlation: float) -> float:
    """Return by how much AR(1) noise in stretches of these lengths widens the variance of a mean."""
    if correlation <= 0.0:
        return 1.0
    rest = 1.0 - correlation
    total = 0.0
    for m in bursts:
        total += m * (1.0 + correlation) / rest - 2.0 * correlation * (1.0 - correlation**m) / (rest * rest)
    return max(1.0, total / sum(bursts))


def _burst_lengths(blocks: Sequence[Block]) -> list[int]:
    lengths: list[int] = []
    burst = -1
    for block in blocks:
        if block.burst == burst:
            lengths[-1] += 1
        else:
            burst = block.burst
            lengths.append(1)
    return lengths


def _centred(values: list[float]) -> list[float]:
    mean = sum(values) / len(values)
    return [value - mean for value in values]


def _dot(a: list[float], b: list[float]) -> float:
    return sum(map(mul, a, b))


@dataclass(slots=True)
class _Fit:
    """Slope over the window, its variance per unit of residual variance, residuals and parameters."""

    slope: float
    leverage: float
    residuals: list[float]
    parameters: int


def _regress(y: list[float], t: list[float], c: list[float] | None) -> _Fit:
    """Regress centred y on centred t, and on centred c where it is given and not a multiple of t."""
    tt, ty = _dot(t, t), _dot(t, y)
    if c is not None:
        cc, tc, cy = _dot(c, c), _dot(t, c), _dot(c, y)
        determinant = tt * cc - tc * tc
        if determinant > 1e-6 * tt * cc:
            slope = (ty * cc - cy * tc) / determinant
            per_kelvin = (cy * tt - ty * tc) / determinant
            residuals = [yi - slope * ti - per_kelvin * ci for yi, ti, ci in zip(y, t, c, strict=True)]
            return _Fit(slope, cc / determinant, residuals, 3)
    slope = ty / tt
    return _Fit(slope, 1.0 / tt, [yi - slope * ti for yi, ti in zip(y, t, strict=True)], 2)


def _correlation(residuals: list[float], bursts: list[int], parameters: int) -> float:
    """Return the lag-1 correlation of residuals within bursts, corrected for the fit's pull towards zero."""
    squares = _dot(residuals, residuals)
    if squares <= 0.0:
        return 0.0
    n = len(residuals)
    pairs = n - len(bursts)
    if pairs < 3:
        return 0.0
    if n <= 2 * parameters:
        return _MAX_CORRELATION  # too few to tell: the correlation that allows least
    products = _dot(residuals[:-1], residuals[1:])
    at = 0
    for m in bursts[:-1]:
        at += m
        products -= residuals[at - 1] * residuals[at]
    raw = products / pairs * n / squares
    # Fitting p parameters biases the lag-1 correlation by about -(p + 2 p phi) / n (Kendall 1954 for p = 1).
    corrected = (raw + parameters / n) / (1.0 - 2.0 * parameters / n)
    return min(max(corrected, 0.0), _MAX_CORRELATION)


def _mid_times(blocks: Sequence[Block]) -> tuple[list[float], float]:
    """Return each block's middle on the accepted time, and the window's length, in s."""
    times: list[float] = []
    elapsed = 0.0
    for block in blocks:
        duration = block.ended_s - block.started_s
        times.append(elapsed + 0.5 * duration)
        elapsed += duration
    return times, elapsed


def enough(blocks: Sequence[Block], revolutions: float | None, seconds: float | None) -> bool:
    """Return whether blocks fill a window of ``revolutions`` or, if that is None, of accepted ``seconds``."""
    if revolutions is not None:
        return len(blocks) >= revolutions
    return seconds is None or _mid_times(blocks)[1] >= seconds


def assess(
    blocks: Sequence[Block],
    revolutions: float | None = None,
    seconds: float | None = None,
    limit_percent: float = DRIFT_LIMIT_PERCENT,
) -> Stability:
    """Judge whether a repeat's coefficient stands still within ``limit_percent`` over its window.

    What is left after truncation has to fill the window (``revolutions``, else ``seconds``; neither:
    anything does); otherwise truncating would shorten the time over which drift is measured, and pass it.
    Costs 0.2 ms for 90 blocks.
    """
    n = len(blocks)
    if n < MIN_BLOCKS:
        reason = f"{n} revolutions, at least {MIN_BLOCKS} needed"
        return Stability(False, reason, n, 0, NAN, NAN, 0.0, float(n))
    mu = [block.mu for block in blocks]
    if not all(map(isfinite, mu)) or sum(mu) <= 0.0:
        return Stability(False, "coefficient without a value", n, 0, NAN, NAN, 0.0, 0.0)
    left_out = _left_out(blocks, mu)
    used = blocks[left_out or 0 :]
    found = _drift(used, limit_percent)
    if left_out is None and not found.stabilised:
        return replace(found, reason=TRANSIENT)
    if found.stabilised and not enough(used, revolutions, seconds):
        reason = f"window not full: {left_out} of {n} revolutions are transient"
        return replace(found, stabilised=False, reason=reason, blocks=n, truncated=left_out or 0)
    return replace(found, blocks=n, truncated=left_out or 0)


def _left_out(blocks: Sequence[Block], mu: list[float]) -> int | None:
    """Return how many leading blocks are transient; None when that cannot be told."""
    n = len(blocks)
    mean = sum(mu) / n
    values = _centred(mu)
    if blocks[0].burst != blocks[-1].burst:
        surface = _centred([block.surface_c for block in blocks])
        squares = _dot(surface, surface)
        if squares > 0.0:
            per_kelvin = _dot(surface, values) / squares
            values = [value - per_kelvin * kelvin for value, kelvin in zip(values, surface, strict=True)]
    left_out = truncation(values)
    if left_out and abs(sum(values[left_out:])) <= MATERIAL * mean * (n - left_out):
        return 0
    return left_out


def _drift(blocks: Sequence[Block], limit_percent: float) -> Stability:
    n = len(blocks)
    mu = [block.mu for block in blocks]
    mean = sum(mu) / n
    times, length = _mid_times(blocks)
    lengths = _burst_lengths(blocks)
    surface = _centred([block.surface_c for block in blocks]) if len(lengths) > 1 else None
    fit = _regress(_centred(mu), _centred(times), surface)
    phi = _correlation(fit.residuals, lengths, fit.parameters)
    inflation = _inflation(lengths, phi)
    effective = n / inflation
    drift = 100.0 * fit.slope * length / mean
    # The residuals' sum of squares has effective - p independent terms, each standing for ``inflation`` blocks. At
    # least one is granted, with its t of 6.3: residuals that are smooth and small (no noise) are no reason to refuse.
    df = max(floor((effective - fit.parameters) / _DF_GRID) * _DF_GRID, 1.0)
    variance = _dot(fit.residuals, fit.residuals) / (inflation * df)
    error = 100.0 * sqrt(variance * inflation * fit.leverage) * length / mean
    bound = abs(drift) + t_quantile(_CONFIDENCE, df) * error
    if bound <= limit_percent:
        return Stability(True, "", n, 0, drift, bound, phi, effective)
    reason = f"drift {drift:+.1f} %, bound {bound:.1f} % over {limit_percent:g} % in {n} revolutions"
    return Stability(False, reason, n, 0, drift, bound, phi, effective)
