"""The least squares of one group: residuals of ln mu at the measured conditions, for any number of parameter sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Final

import numpy as np

from tester.analysis.fit.fit_law import FitError, FitPoint, Law, Source
from tester.base.arrays import Array

ROBUST: Final = 0.05
"""Residual in ln mu above which a condition counts less than its square (soft L1): 5 % [A]."""
_LEAST_MU: Final = 1e-9
_MOST_MU: Final = 1e9
"""Limits of a law's value: an impossible coefficient, 0 or less or infinite, is clipped, so the search avoids it."""
_STEP: Final = 1e-6
"""Step of the differences for derivatives, in steps of the search."""
_WIDEST: Final = 50.0
"""Largest logarithm of a parameter: keeps a search that has gone astray finite."""


@dataclass(frozen=True, slots=True)
class _Shared:
    """An error common to some conditions: a further unknown with a prior of mean 0."""

    rows: Array
    standard: float
    variable: int | None


class FitProblem:
    """Conditions as arrays, weights, and the free parameters.

    The search vector ``z`` has shape (..., q): the free parameters (logarithms of those that are positive), then the
    errors common to a source, in units of their standard uncertainty. Everything is evaluated for many ``z`` at once.
    """

    def __init__(self, law: Law, points: Sequence[FitPoint], held: Mapping[str, float]) -> None:
        """``held``: parameters that are not fitted, by name. Raises FitError for an unknown name, or a value out of
        range."""
        self.law, self.points = law, tuple(points)
        unknown = sorted(set(held) - set(law.names))
        if unknown:
            raise FitError(f"no parameter {', '.join(unknown)} of the law {law.name} (it has {', '.join(law.names)})")
        self.free = tuple(i for i, parameter in enumerate(law.parameters) if parameter.name not in held)
        self._positive = np.array([parameter.positive for parameter in law.parameters])
        for parameter in law.parameters:
            if parameter.positive and parameter.name in held and not held[parameter.name] > 0.0:
                raise FitError(f"{parameter.name} is held at {held[parameter.name]:g} (expected above 0)")
        self._held = np.array([held.get(parameter.name, 1.0) for parameter in law.parameters])
        self.x: Array = np.array([point.measured for point in points], dtype=np.float64)
        self.y: Array = np.log(np.array([point.value for point in points], dtype=np.float64))
        self.sigma: Array = _sigmas(points)
        """Standard deviation of each condition's ln mu from independent scatter; 1 where unknown."""
        self.reference = sqrt(1.0 / float(np.mean(1.0 / self.sigma**2)))
        """The standard deviation that represents all conditions."""
        self.weight: Array = self.reference / self.sigma
        self._shared = _shared(points)
        self.steps: Array = np.array([*(law.parameters[i].step for i in self.free), *(1.0 for _ in self._shared)])

    @property
    def priors(self) -> int:
        """Return how many errors common to a source are unknowns of the fit."""
        return len(self._shared)

    def inward(self, natural: Sequence[float]) -> Array:
        """Return the search vector of a law's parameters, with the common errors at 0."""
        values = [log(natural[i]) if self._positive[i] else natural[i] for i in self.free]
        return np.array([*values, *(0.0 for _ in self._shared)])

    def natural(self, z: Array) -> Array:
        """Return the law's parameters, shape (..., p)."""
        parameters = np.broadcast_to(self._held, (*z.shape[:-1], len(self._held))).copy()
        for place, i in enumerate(self.free):
            searched = z[..., place]
            parameters[..., i] = np.exp(np.clip(searched, -_WIDEST, _WIDEST)) if self._positive[i] else searched
        return parameters

    def logarithms(self, z: Array) -> Array:
        """Return ln mu of the law for the conditions, with the common errors, shape (..., n)."""
        x, gain = self.x, np.zeros(())
        for j, one in enumerate(self._shared):
            error = one.standard * z[..., len(self.free) + j, None] * one.rows
            if one.variable is None:
                gain = gain + error
            else:
                moved = np.zeros((*error.shape, x.shape[-1]))
                moved[..., one.variable] = error
                x = x + moved
        with np.errstate(over="ignore", invalid="ignore"):  # a search that goes astray for a step
            value = np.nan_to_num(self.law.value(self.natural(z), x), nan=_LEAST_MU, posinf=_MOST_MU)
        return np.log(np.clip(value, _LEAST_MU, _MOST_MU)) + gain

    def residuals(self, z: Array, y: Array, prior: Array) -> Array:
        """Return weighted residuals, shape (..., n + priors): of ln mu against ``y``, of errors against ``prior``."""
        of_data = self.weight * (self.logarithms(z) - y)
        of_prior = self.reference * (z[..., len(self.free) :] - prior)
        return np.concatenate([of_data, of_prior], axis=-1)

    def jacobian(self, z: Array, y: Array, prior: Array) -> Array:
        """Return the derivatives of the residuals, shape (..., n + priors, q)."""
        columns: list[Array] = []
        for j, step in enumerate(_STEP * self.steps):
            away = np.zeros(z.shape[-1])
            away[j] = step
            ahead, behind = self.residuals(z + away, y, prior), self.residuals(z - away, y, prior)
            columns.append((ahead - behind) / (2.0 * step))
        return np.stack(columns, axis=-1)


def _sigmas(points: Sequence[FitPoint]) -> Array:
    """Return the standard deviation of each condition's ln mu.

    Conditions without repeats get the mean variance of those with repeats. Without any repeats all get 1.
    """
    known = [point.type_a**2 for point in points if point.type_a == point.type_a]
    if not known:
        return np.ones(len(points))
    mean = sum(known) / len(known)
    squares = [
        (point.type_a**2 if point.type_a == point.type_a else mean) + point.own**2 + point.between**2
        for point in points
    ]
    return np.sqrt(np.maximum(squares, 1e-12))


def _shared(points: Sequence[FitPoint]) -> tuple[_Shared, ...]:
    sources = dict.fromkeys(point.source for point in points)
    return tuple(
        _Shared(_rows(points, source, common.piece), common.standard, common.variable)
        for source in sources
        for common in source.common
        if common.standard > 0.0
    )


def _rows(points: Sequence[FitPoint], source: Source, piece: int) -> Array:
    """Return 1 for each condition of a source and a piece (0: any piece), and 0 for the others."""
    return np.array([float(point.source == source and piece in (0, point.piece)) for point in points])
