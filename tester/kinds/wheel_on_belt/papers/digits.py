"""Uncertainty from the printed digits: the appendices give coefficients to two decimals, and no repeats.

A printed coefficient m stands for m - 0.005 to m + 0.005, with equal probability: standard uncertainty
0.005 / sqrt(3) (GUM 4.3.7), carried through a result by the change that each coefficient makes to it (GUM 5.1.2,
Eq 10). The scatter of the paper's repeats is not printed, so a true U is larger.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import hypot, sqrt
from typing import Final, TypeVar

import numpy as np

from tester.analysis.fit.check import NEAR
from tester.analysis.fit.fit_law import FitPoint, Law, by_group
from tester.analysis.fit.joint import predict
from tester.base.arrays import Array
from tester.kinds.wheel_on_belt.fit.published import Predicted, errors_on

HALF_DIGIT: Final = 0.005
COVERAGE: Final = 2.0
"""Coverage factor of U (95 %, GUM 6.2.1)."""

STEP: Final = 1e-6
"""Relative step of a derivative."""

T = TypeVar("T")
Results = Callable[[Sequence[FitPoint]], Sequence[float]]


def digits_u(results: Results, points: Sequence[FitPoint]) -> list[float]:
    """Return U of each result of rows, from the last printed digit of their coefficients."""
    at = results(points)
    changes: list[list[float]] = []
    for i, entry in enumerate(points):
        moved = [*points[:i], replace(entry, value=entry.value + HALF_DIGIT), *points[i + 1 :]]
        changes.append([b - a for a, b in zip(at, results(moved), strict=True)])
    return [COVERAGE / sqrt(3.0) * hypot(*(change[k] for change in changes)) for k in range(len(at))]


def errors_u(predicted: Predicted, points: Sequence[FitPoint]) -> str:
    """Return U of the errors of given predictions, in words: of mean and largest, and the span of the count."""

    def sizes(rows: Sequence[FitPoint]) -> list[float]:
        errors = errors_on(predicted, rows)
        return [errors.mean, errors.largest]

    mean, largest = digits_u(sizes, points)
    each = [
        (abs(value / entry.value - 1.0), COVERAGE / sqrt(3.0) * HALF_DIGIT * value / entry.value**2)
        for entry, value in zip(points, predicted(points), strict=True)
    ]
    least, most = (sum(off + sign * u <= NEAR for off, u in each) for sign in (1.0, -1.0))
    return f"{100.0 * mean:.1f} and {100.0 * largest:.1f} %; {least} to {most} rows"


def fit_u(
    law: Law, parameters: Sequence[float], points: Sequence[FitPoint], result: Callable[[Sequence[float]], float]
) -> float:
    """Return U of a result of fitted parameters, from the last printed digit of the rows' coefficients.

    Fits search the least squares of logarithms, so a row's relative change moves the parameters by its column of the
    pseudo-inverse of the derivatives (GUM 5.1.2): the rows need not be fitted again.
    """
    at, base = np.log(predict(law, parameters, points)), result(parameters)
    columns: list[Array] = []
    gradient: list[float] = []
    for i, value in enumerate(parameters):
        step = STEP * (abs(value) or 1.0)
        moved = [*parameters[:i], value + step, *parameters[i + 1 :]]
        columns.append((np.log(predict(law, moved, points)) - at) / step)
        gradient.append((result(moved) - base) / step)
    shares = HALF_DIGIT / np.array([entry.value for entry in points])
    changes = np.array(gradient) @ np.linalg.pinv(np.array(columns).T) * shares
    return COVERAGE / sqrt(3.0) * float(np.linalg.norm(changes))


def each_once(fit: Callable[[Sequence[FitPoint]], T]) -> Callable[[Sequence[FitPoint]], dict[str, T]]:
    """Return a fit by compound that remembers: of rows with one moved, only that row's compound is fitted again."""
    known: dict[tuple[FitPoint, ...], T] = {}

    def of(points: Sequence[FitPoint]) -> dict[str, T]:
        result: dict[str, T] = {}
        for group, rows in by_group(points).items():
            subset = tuple(rows)
            if subset not in known:
                known[subset] = fit(subset)
            result[group] = known[subset]
        return result

    return of


def per_cent_u(values: Sequence[float]) -> str:
    """Return shares in per cent, each with two digits."""
    return ", ".join(f"{100.0 * value:.2g}" for value in values) + " %"
