"""Cubic splines by least squares: their basis, and the part of measured values outside the span of a set of columns."""

from __future__ import annotations

from typing import Final

import numpy as np

from tester.base.arrays import Array

ORDER: Final = 4
"""Order of a cubic spline: its degree and one."""
_RANK: Final = 1e-9
"""Share of the greatest singular value below which a column is redundant."""


def quantile_knots(x: Array, interior: int) -> Array:
    """Return the knots of a cubic spline over ``x``, shape (interior + 8,): ``interior`` ones at its quantiles."""
    inner = np.quantile(x, np.linspace(0.0, 1.0, interior + 2)[1:-1]) if interior else np.zeros(0)
    low, high = float(np.min(x)), float(np.max(x))
    return np.concatenate([np.full(ORDER, low), inner, np.full(ORDER, max(high, low + 1e-12))])


def basis(x: Array, knots: Array) -> Array:
    """Return the B-splines of order 4 at ``x`` (within the knots), shape (n, knots - 4), by Cox and de Boor."""
    return _basis(x, knots, ORDER)


def slopes(x: Array, knots: Array) -> Array:
    """Return the derivatives of the B-splines of order 4 at ``x``, shape (n, knots - 4)."""
    lower = _basis(x, knots, ORDER - 1)
    degree = ORDER - 1
    scaled = degree * lower / _above_zero(knots[degree:] - knots[:-degree])[: lower.shape[1]]
    return scaled[:, :-1] - scaled[:, 1:]


def _basis(x: Array, knots: Array, order: int) -> Array:
    last = int(np.flatnonzero(knots < knots[-1])[-1])
    place = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, last)
    splines = np.zeros((x.size, knots.size - 1))
    splines[np.arange(x.size), place] = 1.0
    for k in range(2, order + 1):
        width = knots[k - 1 :] - knots[: -(k - 1)]
        left, right = width[:-1], width[1:]
        first = (x[:, None] - knots[None, : -k]) / _above_zero(left) * (left > 0.0)
        second = (knots[None, k:] - x[:, None]) / _above_zero(right) * (right > 0.0)
        splines = first * splines[:, :-1] + second * splines[:, 1:]
    return splines


def _above_zero(width: Array) -> Array:
    return np.where(width > 0.0, width, 1.0)


def orthonormal(columns: Array) -> Array:
    """Return an orthonormal basis of the span of columns (n, k), (n, rank): redundant columns drop out."""
    u, s, _ = np.linalg.svd(columns, full_matrices=False)
    kept = s > _RANK * s[0] if s.size and s[0] > 0.0 else np.zeros(s.shape, dtype=bool)
    return np.asarray(u[:, kept], dtype=np.float64)


def left_over(q: Array, y: Array) -> Array:
    """Return the residual of ``y``, shape (n,) or (n, B), after projection on an orthonormal basis (n, r)."""
    return np.asarray(y - q @ (q.T @ y), dtype=np.float64)
