"""Whether a condition's coefficient is steady: one fit over all its repeats.

For block i of repeat r, of accepted time t (s), surface temperature T (degC) and coefficient mu,

  y_ri = mu_ri / mean_r - 1 = m_r + d (t_ri - t_r) / w + c (T_ri - T_r) + e

with one drift d for each window w of accepted time and one sensitivity c for the condition. Within a repeat time and
temperature often rise together, and the fit cannot separate them; c has the prior 0 +- 2.6 %/K (the range over the
three compounds of doi 10.3390/polym16050596 at 25 to 85 degC), and its uncertainty is part of that of d.

Noise. Rubber's coefficient wanders as a first-order autoregressive process (AR(1)) of time constant tau. Means of it
over revolutions of length h are ARMA(1,1): with x = h / tau and phi = exp(-x) their correlation at lag k is

  rho_k = rho_1 phi^(k - 1),   rho_1 = (1 - phi)^2 / (2 (x - 1 + phi)),

so rho_1, pooled over neighbours within bursts, gives phi, and with it how many blocks carry the information of one
independent block: ``inflation``, the mean over bursts of m blocks of 1 + 2 sum_k (1 - k/m) rho_k. (An AR(1) law for the
blocks themselves, phi = rho_1, gives 2.95 instead of 2.43 for h = 0.35 s and tau = 0.3 s.) Bursts are seconds apart and
independent; with sideslip each is a contact of its own. The residual degrees of freedom are N / inflation - repeats -
2.

The condition is stable when abs(d) + t(0.9875) se(d) <= 2 %, an equivalence test that is repeated with every further
repeat: each of four looks has a quarter of the level of 5 %. A repeat is refused only where it drifts significantly by
itself (abs(d_r) > 2 %, abs(d_r) - t(0.95) se_r > 0), or differs from three or more siblings (F test, 0.1 %); after a
refusal the fit is repeated without it.

Plain Python: it runs once a repeat, in at most 2 ms.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import exp, floor, isfinite, sqrt
from operator import mul

from tester.analysis.blocks import Block
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN
from tester.analysis.stability import ANY_LENGTH, MIN_BLOCKS, Window, centred
from tester.base.quantities import temperatures

DRIFT_LIMIT_PERCENT = 2.0
"""Largest drift over a window that counts as steady, per cent of the coefficient [A]."""

PER_KELVIN_PERCENT = 2.6
"""Standard deviation of the prior of the sensitivity to temperature, %/K."""

CONFIDENCE = 0.95
LOOK_CONFIDENCE = 1.0 - (1.0 - CONFIDENCE) / 4.0
"""Confidence of each look at the repeats of a condition. Most recipes have three to six repeats, which makes four
looks; they share the level of the test."""
SIBLINGS = 3
"""A repeat is compared with its siblings where there are at least this many."""
DIFFERENT_LEVEL = 0.001
"""Level of the F test against the siblings."""

_MOST_CORRELATION = 0.95
_DF_GRID = 0.5


@dataclass(frozen=True, slots=True)
class Drift:
    """Result of one fit. Drift, its standard error and bound: per cent of the coefficient, per window."""

    drift_percent: float
    error_percent: float
    bound_percent: float
    per_kelvin_percent: float
    correlation: float
    """Between neighbouring blocks, 0..0.95."""
    inflation: float
    """Number of correlated blocks that carry the information of one independent block."""
    shown: bool = False
    """Whether the drift differs from zero, at ``CONFIDENCE``."""
    repeats: tuple[OneDrift, ...] = ()

    @property
    def stable(self) -> bool:
        """Return whether the drift is shown to be within the limit."""
        return self.bound_percent <= DRIFT_LIMIT_PERCENT


@dataclass(frozen=True, slots=True)
class OneDrift:
    """The drift of one repeat with the condition's sensitivity to temperature; per cent, per window.

    ``excess``: standard errors of the drift, or of its difference from the others, where that is reason to
    refuse the repeat; else 0. ``reason``: the same in words.
    """

    drift_percent: float
    error_percent: float
    bound_percent: float
    excess: float = 0.0
    reason: str = ""


NOTHING = Drift(NAN, NAN, NAN, NAN, 0.0, 1.0)


@dataclass(slots=True)
class _Series:
    """One repeat, centred: y as a share of its mean, time t in windows, temperature c in kelvin; sums of products."""

    y: list[float]
    t: list[float]
    c: list[float]
    bursts: list[int]
    tt: float
    tc: float
    cc: float
    ty: float
    cy: float


@lru_cache(maxsize=512)
def decay(correlation: float) -> float:
    """Return phi for the correlation of neighbouring block means, 0..0.95: the decay from each lag to the next."""
    if correlation <= 0.0:
        return 0.0
    low, high = 1e-3, 60.0
    for _ in range(60):
        x = 0.5 * (low + high)
        phi = exp(-x)
        if (1.0 - phi) ** 2 / (2.0 * (x - 1.0 + phi)) > correlation:
            low = x
        else:
            high = x
    return exp(-0.5 * (low + high))


def inflation(bursts: Sequence[int], correlation: float) -> float:
    """Return the factor by which correlated blocks in bursts of these lengths widen the variance of a mean."""
    if correlation <= 0.0:
        return 1.0
    phi = decay(round(correlation, 4))
    total = 0.0
    for m in bursts:
        rho = correlation
        total += m
        for k in range(1, min(m, 200)):
            total += 2.0 * (m - k) * rho
            rho *= phi
            if rho < 1e-6:
                break
    return max(1.0, total / sum(bursts))


def _dot(a: list[float], b: list[float]) -> float:
    return sum(map(mul, a, b))


def burst_lengths(blocks: Sequence[Block]) -> list[int]:
    """Return the number of blocks in each burst, in order."""
    lengths: list[int] = []
    burst = -1
    for block in blocks:
        if block.burst == burst:
            lengths[-1] += 1
        else:
            burst = block.burst
            lengths.append(1)
    return lengths


def _series(blocks: Sequence[Block], window: Window) -> _Series:
    mu = [block.mu for block in blocks]
    mean = sum(mu) / len(mu)
    times: list[float] = []
    elapsed = 0.0
    for block in blocks:
        duration = block.ended_s - block.started_s
        times.append(elapsed + 0.5 * duration)
        elapsed += duration
    per_block = elapsed / len(blocks)
    window_s = window.revolutions * per_block if window.revolutions is not None else window.seconds or elapsed
    y = [value / mean - 1.0 for value in mu]
    t = [time / window_s for time in centred(times)]
    c = centred(temperatures(block.means for block in blocks))
    return _Series(y, t, c, burst_lengths(blocks), _dot(t, t), _dot(t, c), _dot(c, c), _dot(t, y), _dot(c, y))


@dataclass(slots=True)
class _Noise:
    """Residual variance of one independent block, correlation, inflation and degrees of freedom."""

    variance: float
    correlation: float
    inflation: float
    df: float

    @property
    def t(self) -> float:
        """Return the quantile for the bound."""
        return t_quantile(CONFIDENCE, self.df)


def _noise(series: Sequence[_Series], slopes: Sequence[float], per_kelvin: float, parameters: int) -> _Noise:
    """Return the noise in the residuals of a fit."""
    squares = products = 0.0
    count = pairs = 0
    lengths: list[int] = []
    for repeat, slope in zip(series, slopes, strict=True):
        rest = [y - slope * t - per_kelvin * c for y, t, c in zip(repeat.y, repeat.t, repeat.c, strict=True)]
        squares += _dot(rest, rest)
        products += _dot(rest[:-1], rest[1:])
        at = 0
        for m in repeat.bursts[:-1]:
            at += m
            products -= rest[at - 1] * rest[at]
        count += len(rest)
        pairs += len(rest) - len(repeat.bursts)
        lengths += repeat.bursts
    correlation = 0.0
    if squares > 0.0 and pairs >= 3:
        raw = products / pairs * count / squares
        # Fitting p parameters biases the lag-1 correlation by about -(p + 2 p rho) / n (Kendall 1954 for p = 1).
        corrected = (raw + parameters / count) / max(1.0 - 2.0 * parameters / count, 0.1)
        correlation = min(max(corrected, 0.0), _MOST_CORRELATION)
    widened = inflation(lengths, correlation)
    # Keep at least one degree of freedom (t of 6.3): smooth, small residuals are no reason to refuse.
    df = max(floor((count / widened - parameters) / _DF_GRID) * _DF_GRID, 1.0)
    return _Noise(squares / df, correlation, widened, df)


@dataclass(slots=True)
class _Fit:
    """Pooled slope, its variance, and sensitivity, as shares of the coefficient."""

    slope: float
    per_kelvin: float
    slope_variance: float
    noise: _Noise


def _fit(series: Sequence[_Series]) -> _Fit:
    """Fit one slope and one sensitivity; the noise sets the weight of the sensitivity's prior."""
    tt, tc, cc = sum(s.tt for s in series), sum(s.tc for s in series), sum(s.cc for s in series)
    ty, cy = sum(s.ty for s in series), sum(s.cy for s in series)
    count = sum(len(s.y) for s in series)
    variance = sum(_dot(s.y, s.y) for s in series) / count
    slope = per_kelvin = slope_of = 0.0
    noise = _Noise(variance, 0.0, 1.0, 1.0)
    # The noise sets the weight of the prior, and the fit yields the noise: three rounds are enough.
    for _ in range(3):
        information = cc + variance / (0.01 * PER_KELVIN_PERCENT) ** 2
        determinant = tt * information - tc * tc
        # Where time and temperature are collinear the fit leaves the sensitivity out.
        if determinant > 1e-9 * tt * information:
            slope, per_kelvin = (ty * information - cy * tc) / determinant, (cy * tt - ty * tc) / determinant
            slope_of = information / determinant
        else:
            slope, per_kelvin, slope_of = ty / tt, 0.0, 1.0 / tt
        noise = _noise(series, [slope] * len(series), per_kelvin, len(series) + 2)
        variance = noise.variance
    return _Fit(slope, per_kelvin, variance * slope_of, noise)


def _singles(series: Sequence[_Series], fit: _Fit) -> tuple[OneDrift, ...]:
    """Return the drift of each repeat, with a sensitivity pooled over them.

    The sensitivity is fitted together with a slope for each repeat, so a single repeat's drift is mistaken neither for
    an effect of temperature nor for noise.
    """
    information = sum(s.cc - s.tc * s.tc / s.tt for s in series) + fit.noise.variance / (0.01 * PER_KELVIN_PERCENT) ** 2
    per_kelvin = sum(s.cy - s.tc * s.ty / s.tt for s in series) / information if information > 0.0 else 0.0
    slopes = [(s.ty - per_kelvin * s.tc) / s.tt for s in series]
    noise = _noise(series, slopes, per_kelvin, 2 * len(series) + 1)
    kelvin_variance = noise.variance / information if information > 0.0 else 0.0
    tt, tc = sum(s.tt for s in series), sum(s.tc for s in series)
    total = sum(slope * s.tt for slope, s in zip(slopes, series, strict=True))
    drifts: list[OneDrift] = []
    for s, slope in zip(series, slopes, strict=True):
        error = sqrt(noise.variance / s.tt + (s.tc / s.tt) ** 2 * kelvin_variance)
        drift = 100.0 * slope
        bound = abs(drift) + noise.t * 100.0 * error
        excess, reason = 0.0, ""
        if abs(drift) > DRIFT_LIMIT_PERCENT and abs(slope) > noise.t * error:
            excess = abs(slope) / error if error > 0.0 else abs(drift)
            reason = f"drifts by {drift:+.1f} % a window"
        elif len(series) > SIBLINGS:
            others, at = tt - s.tt, (total - slope * s.tt) / (tt - s.tt)
            apart = (s.tc / s.tt - (tc - s.tc) / others) ** 2 * kelvin_variance
            error_of = sqrt(noise.variance * (1.0 / s.tt + 1.0 / others) + apart)
            # F with 1 and df degrees of freedom is t squared.
            if abs(slope - at) > t_quantile(1.0 - 0.5 * DIFFERENT_LEVEL, noise.df) * error_of:
                excess = abs(slope - at) / error_of if error_of > 0.0 else abs(drift)
                reason = f"drifts by {drift:+.1f} % a window, the other repeats by {100.0 * at:+.1f} %"
        drifts.append(OneDrift(drift, 100.0 * error, bound, excess, reason))
    return tuple(drifts)


def fit_drift(
    repeats: Sequence[Sequence[Block]], window: Window = ANY_LENGTH, confidence: float = CONFIDENCE
) -> Drift:
    """Return the drift per window of repeats, each given by its valid blocks; ANY_LENGTH: per length of each repeat.

    ``confidence``: that of the one-sided bound. Repeats of fewer than six blocks or without a coefficient are ignored;
    ``repeats`` of the result then has NaN for them.
    """
    usable = [
        len(blocks) >= MIN_BLOCKS and all(isfinite(b.mu) for b in blocks) and sum(b.mu for b in blocks) > 0.0
        for blocks in repeats
    ]
    series = [_series(blocks, window) for blocks, use in zip(repeats, usable, strict=True) if use]
    if not series:
        return NOTHING
    fit = _fit(series)
    error = sqrt(fit.slope_variance)
    singles = iter(_singles(series, fit))
    return Drift(
        drift_percent=100.0 * fit.slope,
        error_percent=100.0 * error,
        bound_percent=100.0 * (abs(fit.slope) + t_quantile(confidence, fit.noise.df) * error),
        per_kelvin_percent=100.0 * fit.per_kelvin,
        correlation=fit.noise.correlation,
        inflation=fit.noise.inflation,
        shown=abs(fit.slope) > fit.noise.t * error,
        repeats=tuple(next(singles) if use else OneDrift(NAN, NAN, NAN) for use in usable),
    )


def refusals(repeats: Sequence[Sequence[Block]], window: Window) -> tuple[Drift, dict[int, OneDrift]]:
    """Return the drift of the remaining repeats, and the refused ones by position: the worst first, one at a time.

    ``repeats`` of the drift lists the remaining ones in order.
    """
    left = list(range(len(repeats)))
    refused: dict[int, OneDrift] = {}
    while left:
        drift = fit_drift([repeats[i] for i in left], window, LOOK_CONFIDENCE)
        worst = max(range(len(left)), key=lambda i: drift.repeats[i].excess if drift.repeats else 0.0)
        if not drift.repeats or not drift.repeats[worst].reason:
            return drift, refused
        refused[left.pop(worst)] = drift.repeats[worst]
    return NOTHING, refused
