"""Quantiles of Student's t and Fisher's F without scipy, which costs 142 MB installed (docs/decisions/0030).

Both come from the regularised incomplete beta function: continued fraction of DLMF 8.17.22
(dlmf.nist.gov/8.17), evaluated by Lentz's method. Relative accuracy of the quantiles is better than 1e-9
for 0.6 <= p <= 1 - 1e-6 and df >= 0.5 (tests compare with scipy's values, printed tables and closed forms).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, partial
from math import exp, lgamma, log, pi, sqrt
from statistics import NormalDist

_EPSILON = 1e-14
_TINY = 1e-300
_NORMAL = NormalDist()
_LARGE_DF = 1e4
"""Above this the expansion in 1/df is exact to 1e-13; the tail's logarithms of gamma lose more than that."""


def _continued_fraction(a: float, b: float, x: float) -> float:
    """Evaluate the continued fraction of I_x(a, b) by Lentz's method, for x < (a + 1) / (a + b + 2)."""
    c = 1.0
    d = 1.0 / _nonzero(1.0 - (a + b) * x / (a + 1.0))
    result = d
    for m in range(1, 1000):
        even = m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m))
        d = 1.0 / _nonzero(1.0 + even * d)
        c = _nonzero(1.0 + even / c)
        result *= d * c
        odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0))
        d = 1.0 / _nonzero(1.0 + odd * d)
        c = _nonzero(1.0 + odd / c)
        step = d * c
        result *= step
        if abs(step - 1.0) < _EPSILON:
            break
    return result


def _nonzero(value: float) -> float:
    return value if abs(value) > _TINY else _TINY


def incomplete_beta(a: float, b: float, x: float) -> float:
    """Return the regularised incomplete beta function I_x(a, b).

    ``a`` and ``b`` > 0, ``x`` in [0, 1]; raises ValueError outside.
    """
    if not (a > 0.0 and b > 0.0 and 0.0 <= x <= 1.0):
        raise ValueError(f"incomplete beta: a {a} and b {b} must be > 0 and x {x} within 0..1")
    if x in (0.0, 1.0):
        return x
    front = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(1.0 - x))
    if x < (a + 1.0) / (a + b + 2.0):
        return front * _continued_fraction(a, b, x) / a
    return 1.0 - front * _continued_fraction(b, a, 1.0 - x) / b


def t_upper_tail(t: float, df: float) -> float:
    """Return P(T > t) for t >= 0 and df > 0."""
    return 0.5 * incomplete_beta(0.5 * df, 0.5, df / (df + t * t))


def _t_expansion(p: float, df: float) -> float:
    """Return an approximate t quantile, p > 0.5: Cornish-Fisher expansion in 1/df (A&S 26.7.5)."""
    z = _NORMAL.inv_cdf(p)
    z2 = z * z
    return z * (
        1.0
        + (z2 + 1.0) / (4.0 * df)
        + ((5.0 * z2 + 16.0) * z2 + 3.0) / (96.0 * df * df)
        + (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / (384.0 * df**3)
    )


@lru_cache(maxsize=4096)
def t_quantile(p: float, df: float) -> float:
    """Return the quantile of Student's t at probability ``p``.

    ``p`` in (0, 1); ``df`` >= 0.5, may be fractional (as effective degrees of freedom are) or inf. Raises ValueError
    outside. Costs about 50 us, nothing on a repeated call.
    """
    if not (0.0 < p < 1.0 and df >= 0.5):
        raise ValueError(f"t quantile: p {p} must lie within 0..1 and df {df} be >= 0.5")
    if p < 0.5:
        return -t_quantile(1.0 - p, df)
    if p == 0.5:
        return 0.0
    if df > _LARGE_DF:
        return _t_expansion(p, df)
    if df <= 2.0:
        # The start is poor here and the density's tail long: solve in log(t), where the tail is nearly
        # straight.
        return _solve(partial(t_upper_tail, df=df), 1.0 - p, 1.0)
    t = _t_expansion(p, df)
    scale = exp(lgamma(0.5 * (df + 1.0)) - lgamma(0.5 * df)) / sqrt(df * pi)
    for _ in range(20):
        density = scale * (1.0 + t * t / df) ** (-0.5 * (df + 1.0))
        step = (t_upper_tail(t, df) - (1.0 - p)) / density
        t += step
        if abs(step) < 1e-12 * t:
            break
    return t


def _solve(upper_tail: Callable[[float], float], tail: float, start: float) -> float:
    """Return the x > 0 with upper_tail(x) = tail by bisection of log(x)."""
    low = high = start
    while upper_tail(high) > tail:
        high *= 4.0
    while upper_tail(low) < tail:
        low *= 0.25
    while high / low > 1.0 + 1e-13:
        middle = sqrt(low * high)
        if upper_tail(middle) > tail:
            low = middle
        else:
            high = middle
    return sqrt(low * high)


def _f_upper_tail(f: float, df1: float, df2: float) -> float:
    return incomplete_beta(0.5 * df2, 0.5 * df1, df2 / (df2 + df1 * f))


@lru_cache(maxsize=4096)
def f_quantile(p: float, df1: float, df2: float) -> float:
    """Return the quantile of Fisher's F with ``df1``, ``df2`` > 0 degrees of freedom, ``p`` in (0, 1).

    Raises ValueError outside. Costs about 1 ms, nothing on a repeated call.
    """
    if not (0.0 < p < 1.0 and df1 > 0.0 and df2 > 0.0):
        raise ValueError(f"F quantile: p {p} must lie within 0..1, df {df1} and {df2} be > 0")
    return _solve(partial(_f_upper_tail, df1=df1, df2=df2), 1.0 - p, 1.0)
