"""The joint fit of one group: all parameters from all conditions at once, with intervals and verdicts."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean
from typing import Final

import numpy as np

from tester.analysis.fit.check import Errors, errors_of, levels, refuse
from tester.analysis.fit.fit_law import FitError, FitPoint, Law
from tester.analysis.fit.lack import Lack, lack_of
from tester.analysis.fit.resample import RESAMPLES, SEED, Resamples, covariance, resample, without_cells
from tester.analysis.fit.solve import FitProblem, solve
from tester.analysis.fit.trends import Interval, Trends, trends_of
from tester.base.arrays import Array

OPEN: Final = 1e6
"""Condition number above which the data leave a combination of parameters open [A]: data carry six digits."""


@dataclass(frozen=True, slots=True)
class Level:
    """Conditions at one nominal value of a variable: mean of ln(measured / fitted), and how many there are."""

    value: float
    mean: float
    count: int


@dataclass(frozen=True, slots=True)
class GroupFit:
    """A fit: parameters (natural, in the law's order) with their 95 % intervals, and its quality.

    By the name of a parameter: ``impossible`` is why it cannot have the fitted value, ``heated`` why its effect cannot
    be separated from that of the contact's own heat. ``silent`` is why no interval is reliable. ``cells_kept``: how
    many cells could not be left out.
    """

    law: Law
    group: str
    points: tuple[FitPoint, ...]
    cells: tuple[int, ...]
    """Places of the variables that make a cell."""
    held: tuple[str, ...]
    parameters: tuple[float, ...]
    intervals: tuple[Interval, ...]
    impossible: Mapping[str, str]
    heated: Mapping[str, str]
    condition_number: float
    covariance: Array
    """Of the fitted parameters, as searched: logarithms of those that are positive."""
    resamples: Resamples
    errors: Errors
    left_out_pairs: tuple[tuple[float, float], ...]
    """Coefficient predicted without its cell, and measured."""
    cells_kept: int
    residuals: tuple[tuple[Level, ...], ...]
    lack: Lack
    trends: Trends

    @property
    def silent(self) -> str:
        """Return why no interval of this fit is reliable, "" where some are."""
        if self.lack.shown is None:
            return "nothing is known of the repeatability: no repeats, and none declared"
        if self.lack.shown:
            return "the law does not describe the conditions"
        return f"no such rubber has this {', '.join(self.impossible)}" if self.impossible else ""

    @property
    def sound(self) -> bool:
        """Return whether the law describes the conditions, as far as they can resolve it, with parameters that are
        possible for a rubber on a surface."""
        return not self.lack.shown and not self.impossible

    def why_no_interval(self, name: str) -> str:
        """Return why the interval of a parameter is not reliable, "" where it is."""
        return self.silent or self.heated.get(name, "")

    @property
    def beyond(self) -> list[str]:
        """Return why the law does not hold at some of the conditions."""
        reasons = self.law.beyond
        return [*reasons(self.parameters, [point.measured for point in self.points])] if reasons is not None else []

    @property
    def left_out(self) -> Errors:
        """Return the errors of conditions, each predicted by fitting the other cells (``cells``)."""
        return _errors(self.left_out_pairs)

    def predict(self, points: Sequence[FitPoint]) -> list[float]:
        """Return the coefficients of conditions, at their measured values."""
        return predict(self.law, self.parameters, points)

    def errors_on(self, points: Sequence[FitPoint]) -> Errors:
        """Return the errors of the fit on other conditions."""
        return errors_of(self.predict(points), [point.value for point in points])


@dataclass(frozen=True, slots=True)
class Overall:
    """Errors over all groups: of conditions fitted, left out with their cell, and not used (None: there are none)."""

    fitted: Errors
    left_out: Errors
    validation: Errors | None


def overall(fits: Sequence[GroupFit], others: Mapping[str, Sequence[FitPoint]] | None) -> Overall:
    """Return the errors over all groups; ``others``: conditions that were not fitted, by group."""
    fitted = [pair for fit in fits for pair in _pairs(fit, fit.points)]
    left_out = [pair for fit in fits for pair in fit.left_out_pairs]
    others_seen = [pair for fit in fits for pair in _pairs(fit, (others or {}).get(fit.group, ()))]
    return Overall(_errors(fitted), _errors(left_out), _errors(others_seen) if others is not None else None)


def _pairs(fit: GroupFit, points: Sequence[FitPoint]) -> list[tuple[float, float]]:
    return [(value, point.value) for value, point in zip(fit.predict(points), points, strict=True)]


def _errors(pairs: Sequence[tuple[float, float]]) -> Errors:
    return errors_of([predicted for predicted, _ in pairs], [measured for _, measured in pairs])


def predict(law: Law, parameters: Sequence[float], points: Sequence[FitPoint]) -> list[float]:
    """Return a law's coefficients of conditions, at their measured values."""
    if not points:
        return []
    x = np.array([point.measured for point in points], dtype=np.float64)
    return [float(value) for value in law.value(np.array(parameters, dtype=np.float64), x)]


def fit_group(
    law: Law,
    group: str,
    points: Sequence[FitPoint],
    cells: Sequence[int],
    held: Mapping[str, float] | None = None,
    *,
    count: int = RESAMPLES,
    seed: int = SEED,
) -> GroupFit:
    """Fit a law to the conditions of a group; raises FitError where that is impossible, and MissingExtraError.

    ``cells``: places of the variables that make a cell (``without_cells``). ``held``: parameters that are not fitted.
    """
    held = held or {}
    problem, fitted = _searched(law, group, points, held)
    parameters = tuple(float(value) for value in problem.natural(fitted))
    resamples = resample(problem, fitted, count, seed)
    intervals = tuple(resamples.interval(resamples.parameters[:, i]) for i in range(len(parameters)))
    left_out, kept = without_cells(problem, fitted, cells)
    residual = problem.y - np.log(problem.law.value(problem.natural(fitted), problem.x))
    measured = [point.value for point in points]
    trends = trends_of(law, points, parameters, resamples)
    lack = lack_of(problem, fitted)
    known = intervals if lack.denominator is not None else ()
    return GroupFit(
        law=law,
        group=group,
        points=tuple(points),
        cells=tuple(cells),
        held=tuple(name for name in law.names if name in held),
        parameters=parameters,
        intervals=intervals,
        impossible=_impossible(law, held, parameters, known),
        heated=_heated(law, trends),
        condition_number=_condition_number(group, problem, fitted),
        covariance=covariance(problem, fitted),
        resamples=resamples,
        errors=errors_of(predict(law, parameters, points), measured),
        left_out_pairs=tuple((value, measured[i]) for i, value in left_out),
        cells_kept=kept,
        residuals=tuple(_by_level(points, residual, i) for i in range(len(law.variables))),
        lack=lack,
        trends=trends,
    )


def _impossible(
    law: Law, held: Collection[str], parameters: Sequence[float], intervals: Sequence[Interval]
) -> dict[str, str]:
    """Return, by name, why parameters cannot have the fitted value: it, or an end of its interval, lies outside the
    band.
    """
    reasons: dict[str, str] = {}
    for i, (parameter, value) in enumerate(zip(law.parameters, parameters, strict=True)):
        band = f"{parameter.band.low:.4g} to {parameter.band.high:.4g} {parameter.unit}".rstrip()
        if parameter.name in held:
            continue  # its value was given, not fitted
        if not parameter.band.holds(value):
            reasons[parameter.name] = f"outside {band} ({parameter.band.source})"
        elif intervals and not all(map(parameter.band.holds, intervals[i])):
            reasons[parameter.name] = f"open beyond {band} ({parameter.band.source})"
    return reasons


def _heated(law: Law, trends: Trends) -> dict[str, str]:
    """Return, by name, why the effects of parameters cannot be separated from that of the contact's own heat."""
    by = {trend.variable.name: trend.own_heat for trend in trends.each if trend.own_heat}
    named = [(parameter.name, parameter.levels[0]) for parameter in law.parameters if parameter.levels is not None]
    return {name: f"{variable}: {by[variable]}" for name, variable in named if variable in by}


def fit_only(law: Law, group: str, points: Sequence[FitPoint]) -> tuple[float, ...]:
    """Return the parameters of ``fit_group`` alone, without resamples; raises the same errors."""
    problem, fitted = _searched(law, group, points, {})
    return tuple(float(value) for value in problem.natural(fitted))


def _searched(
    law: Law, group: str, points: Sequence[FitPoint], held: Mapping[str, float]
) -> tuple[FitProblem, Array]:
    """Return the problem with its weights, and the best fit."""
    problem = FitProblem(law, points, held)
    refuse(law, group, points, held)
    return problem, solve(problem, law.begins())


def _condition_number(group: str, problem: FitProblem, fitted: Array) -> float:
    """Return the condition number of the derivatives, each scaled to length 1; raises FitError above ``OPEN``."""
    prior = np.zeros(problem.priors)
    jacobian = problem.jacobian(fitted, problem.y, prior)[: len(problem.points), : len(problem.free)]
    lengths = np.linalg.norm(jacobian, axis=0)
    names = [problem.law.names[i] for i in problem.free]
    if not lengths.all():
        silent = ", ".join(name for name, length in zip(names, lengths, strict=True) if not length)
        raise FitError(f"{group}: the conditions say nothing of {silent}: hold it (--hold), or measure others")
    _, values, axes = np.linalg.svd(jacobian / lengths)
    number = float(values[0] / max(values[-1], 1e-300))
    if number > OPEN:
        largest = np.abs(axes[-1])
        mixed = ", ".join(name for name, part in zip(names, largest, strict=True) if part > 0.3 * largest.max())
        raise FitError(
            f"{group}: the conditions cannot tell {mixed} apart (condition number {number:.1g}, expected below "
            f"{OPEN:g}): hold one of them (--hold), or vary what they stand for one by one"
        )
    return number


def _by_level(points: Sequence[FitPoint], residual: Array, variable: int) -> tuple[Level, ...]:
    levels_found: list[Level] = []
    for value in levels(points, variable):
        residuals = [float(r) for point, r in zip(points, residual, strict=True) if point.nominal[variable] == value]
        levels_found.append(Level(value, fmean(residuals), len(residuals)))
    return tuple(levels_found)
