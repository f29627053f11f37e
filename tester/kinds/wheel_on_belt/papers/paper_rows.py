"""Rows of the paper's appendices, for the checks of its items.

The rows form series over one variable; the errors of Eqs 7 to 9 are given by compound.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from tester.analysis.fit.fit_law import FitPoint, by_group
from tester.kinds.wheel_on_belt.fit.data import appendix
from tester.kinds.wheel_on_belt.fit.laws import LOAD, SLIP, TEMPERATURE
from tester.kinds.wheel_on_belt.fit.published import FIT, VALIDATION, errors_on, of_table_3

USUAL_LOAD_N, USUAL_SLIP_M_S = 200.0, 0.3
"""Load and slip that the paper keeps while it varies the other."""
COMPOUND_NAMES = ("1#", "2#", "3#")


def readable() -> list[FitPoint]:
    """Return the legible rows of both appendices, without sideslip and without inferred values."""
    return [*appendix(FIT).points, *appendix(VALIDATION).points]


def over_load() -> list[FitPoint]:
    """Return the rows at the usual slip velocity."""
    return [entry for entry in readable() if entry.nominal[SLIP] == USUAL_SLIP_M_S]


def over_slip() -> list[FitPoint]:
    """Return the rows at the usual load."""
    return [entry for entry in readable() if entry.nominal[LOAD] == USUAL_LOAD_N]


def series(points: Iterable[FitPoint], variable: int) -> list[list[FitPoint]]:
    """Return the rows that differ in one variable alone, each series ascending."""
    result: dict[tuple[object, ...], list[FitPoint]] = {}
    for entry in points:
        setting = tuple(value for i, value in enumerate(entry.nominal) if i != variable)
        result.setdefault((entry.group, *setting), []).append(entry)
    return [sorted(subset, key=lambda entry: entry.nominal[variable]) for subset in result.values()]


def steps(points: Iterable[FitPoint], variable: int, up: bool) -> tuple[int, int]:
    """Return the number of steps along a variable in which the coefficient changes as stated, and of all steps."""
    pairs = [pair for subset in series(points, variable) for pair in pairwise(subset)]
    return sum((b.value > a.value) is up and a.value != b.value for a, b in pairs), len(pairs)


def peaks(points: Iterable[FitPoint]) -> tuple[int, int, list[str]]:
    """Return how many series over temperature peak at 70 degC, how many extend beyond it, and the exceptions."""
    phrase: list[str] = []
    count = 0
    for subset in series(points, TEMPERATURE):
        if not {55.0, 70.0, 85.0} <= {entry.nominal[TEMPERATURE] for entry in subset}:
            continue
        count += 1
        top = max(subset, key=lambda entry: entry.value)
        if top.nominal[TEMPERATURE] != 70.0:
            phrase.append(f"{top.label} at {top.nominal[TEMPERATURE]:g} degC")
    return count - len(phrase), count, phrase


def by_compound_words(points: Sequence[FitPoint]) -> str:
    """Return the errors of Eqs 7 to 9 on rows by compound, in words."""
    each = [errors_on(of_table_3, subset) for subset in by_group(points).values()]
    every = errors_on(of_table_3, points)
    means = ", ".join(f"{100.0 * entry.mean:.1f}" for entry in each)
    return f"mean {means} % ({', '.join(by_group(points))}), largest {100.0 * every.largest:.0f} %"


def bias(points: Sequence[FitPoint]) -> float:
    """Return the mean ratio of measured values to Eqs 7 to 9, less 1; NaN without rows."""
    if not points:
        return float("nan")
    return sum(entry.value / value for entry, value in zip(points, of_table_3(points), strict=True)) / len(points) - 1.0


def at(
    points: Iterable[FitPoint], compound: str, *, celsius: float | None = None, load: float | None = None,
    slip: float | None = None,
) -> list[FitPoint]:  # fmt: skip
    """Return the rows of a compound at given values."""
    asked = {TEMPERATURE: celsius, LOAD: load, SLIP: slip}
    setting = {place: value for place, value in asked.items() if value is not None}
    return [
        entry
        for entry in points
        if entry.group == compound and all(entry.nominal[i] == value for i, value in setting.items())
    ]
