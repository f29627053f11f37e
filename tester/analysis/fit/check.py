"""Whether conditions determine a law's parameters, before any search; the size of a law's errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Final

from tester.analysis.fit.fit_law import NAN, FitError, FitPoint, Law, LawParameter, Variable

SPARE: Final = 3
"""Conditions needed beyond the number of parameters: without them residuals carry no information [A]."""
NEAR, FAR = 0.05, 0.10
"""Relative errors within which rows are counted: the paper claims the first."""


def levels(points: Sequence[FitPoint], variable: int) -> list[float]:
    """Return the nominal values of a variable, ascending."""
    return sorted({point.nominal[variable] for point in points})


def place_of(law: Law, name: str) -> int:
    """Return the place of a law's variable; raises KeyError."""
    places = {variable.name: i for i, variable in enumerate(law.variables)}
    return places[name]


def refuse(law: Law, group: str, points: Sequence[FitPoint], held: Mapping[str, float]) -> None:
    """Raise FitError where the conditions of a group cannot determine a law's free parameters; the message names a
    remedy."""
    free = [parameter for parameter in law.parameters if parameter.name not in held]
    if not free:
        raise FitError(f"{group}: all parameters of the law {law.name} are held: there is nothing to fit")
    for needed, names in _needs(free).items():
        variable = law.variables[place_of(law, needed[0])]
        values = levels(points, place_of(law, needed[0]))
        if len(values) < needed[1]:
            raise FitError(_too_few(group, variable, needed[1], values, names))
    least = len(free) + SPARE
    if len(points) < least:
        raise FitError(
            f"{group}: {len(points)} conditions for {len(free)} parameters (expected at least {least}): "
            "measure more, add a source, or hold parameters (--hold)"
        )


def _needs(free: Sequence[LawParameter]) -> dict[tuple[str, int], list[str]]:
    by_need: dict[tuple[str, int], list[str]] = {}
    for law_parameter in free:
        if law_parameter.levels is not None:
            by_need.setdefault(law_parameter.levels, []).append(law_parameter.name)
    return by_need


def _too_few(group: str, variable: Variable, needed: int, values: Sequence[float], names: Sequence[str]) -> str:
    there = ", ".join(map(variable.words, values))
    many = f"one {variable.name} only" if len(values) == 1 else f"{len(values)} values of {variable.name}"
    listed = ",".join(names)
    return (
        f"{group}: {many} ({there}), and {', '.join(names)} need at least {needed}: "
        f"measure at more, add a source, or hold them (--hold {listed})"
    )


@dataclass(frozen=True, slots=True)
class Errors:
    """Relative errors |predicted / measured - 1| of some rows: mean, median, largest, rows within 5 and 10 %."""

    rows: int
    mean: float
    median: float
    largest: float
    near: int
    far: int


def errors_of(predicted: Sequence[float], measured: Sequence[float]) -> Errors:
    """Return relative errors of predictions; NaN for no rows."""
    off = [abs(p / m - 1.0) for p, m in zip(predicted, measured, strict=True)]
    if not off:
        return Errors(0, NAN, NAN, NAN, 0, 0)
    near, far = (sum(error <= limit for error in off) for limit in (NEAR, FAR))
    return Errors(len(off), fmean(off), median(off), max(off), near, far)
