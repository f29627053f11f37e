"""Runs laid over each other: coefficients against an axis, and each later run's difference and ratio to the first."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, isfinite
from typing import Any, Final

from tester.base.axes import Axis, condition_words
from tester.base.words import finite
from tester.page.stored.run_cache import QuestionError
from tester.results.columns import unit_of
from tester.results.compared import Pair, pairs
from tester.results.measured_tables import repeats_table
from tester.results.repeats_compared import ALONG, HOW, ComparedRepeats, compared_along, place_of
from tester.results.run_results import RunResults
from tester.results.table_rows import TableRow
from tester.store.records import Travel
from tester.store.run_reader import RunReader

MOST: Final = 6
"""Runs in one picture: as many as there are colours that three kinds of colour-blind people tell apart."""


def overlay_page(runs: Sequence[tuple[RunReader, RunResults]], against: str) -> dict[str, Any]:
    """Return one to six runs against an axis of their conditions, or repeat by repeat; ``how``: where they are
    compared, in words. Raises QuestionError.
    """
    if not 1 <= len(runs) <= MOST:
        raise QuestionError(f"runs: expected 1 to {MOST}")
    results = [found for _, found in runs]
    if against in ALONG:
        return _along(runs, against)
    axis = _axis(results, against)
    first = results[0]
    matched = [(one, list(pairs(first, one))) for one in results[1:]]
    return {
        "against": {"key": axis.name, "title": axis.name.replace("_", " "), "unit": unit_of(axis)},
        "runs": [{"run": one.run.info.name, "points": [_point(row, axis) for row in one.rows]} for one in results],
        "difference": [
            {"run": one.run.info.name, "points": [p for pair in found if (p := _difference(pair, axis))]}
            for one, found in matched
        ],
        "ratio": [
            {"run": one.run.info.name, "points": [p for pair in found if (p := _ratio(pair, axis))]}
            for one, found in matched
        ],
        "how": "Compared condition by condition, at the same setting.",
    }  # fmt: skip


def _along(runs: Sequence[tuple[RunReader, RunResults]], along: str) -> dict[str, Any]:
    """Return the repeats of runs along a word of ``ALONG``. Raises QuestionError for runs of different kinds."""
    _one_kind([found for _, found in runs])
    title, unit = ALONG[along]
    travels = [reader.travels() for reader, _ in runs]
    first = runs[0][1]
    compared = [
        (one.run.info.name, list(compared_along(list(pairs(first, one)), along, (travels[0], of))))
        for (_, one), of in zip(runs[1:], travels[1:], strict=True)
    ]
    return {
        "against": {"key": along, "title": title, "unit": unit},
        "runs": [
            {"run": one.run.info.name, "points": _repeats(one, along, of)}
            for (_, one), of in zip(runs, travels, strict=True)
        ],
        "difference": [
            {"run": run, "points": [_beside(one, one.found.value, one.found.expanded) for one in found]}
            for run, found in compared
        ],
        "ratio": [
            {"run": run, "points": [_beside(one, one.ratio, one.ratio_u) for one in found]}
            for run, found in compared
        ],
        "how": f"{HOW[along]} U: of the scatter within the repeats.",
    }


def _beside(one: ComparedRepeats, y: float, u: float) -> dict[str, Any]:
    return {"x": one.x, "y": finite(y), "u": finite(u), "label": one.label}


def _axis(results: Sequence[RunResults], name: str) -> Axis:
    """Return the axis of a name, that all runs have. Raises QuestionError."""
    _one_kind(results)
    for axis in results[0].axes:
        if axis.name == name and all(name in one.axes.places for one in results):
            return axis
    known = ", ".join([*(axis.name for axis in results[0].axes), *ALONG])
    raise QuestionError(f"against: no axis {name!r} of all these runs (expected one of {known})")


def _one_kind(results: Sequence[RunResults]) -> None:
    kinds = {one.run.info.kind for one in results}
    if len(kinds) > 1:
        raise QuestionError(f"runs: of different kinds of rigs: {', '.join(sorted(kinds))}")


def _point(row: TableRow, axis: Axis) -> dict[str, Any]:
    return {
        "x": axis.of(row.info.setpoint), "mu": finite(row.result.mu), "u": finite(row.result.budget.expanded),
        "label": condition_words(row.info.setpoint), "n": row.info.condition, "compound": row.info.compound,
    }  # fmt: skip


def _difference(pair: Pair, axis: Axis) -> dict[str, Any] | None:
    """Return the difference of a matched pair with its expanded uncertainty; None without one."""
    if not isfinite(pair.found.value):
        return None
    u = pair.found.coverage * pair.found.standard
    return _compared(pair, axis, pair.found.value, u)


def _ratio(pair: Pair, axis: Axis) -> dict[str, Any] | None:
    """Return the ratio of a matched pair, and its expanded uncertainty from that of the difference; None without one.

    The ratio is 1 + difference / first, so what both runs share (the same calibration) does not count twice. The
    first's own uncertainty scales only the deviation from 1.
    """
    if pair.first is None or not isfinite(pair.found.value) or not pair.first.result.mu:
        return None
    mu, own = pair.first.result.mu, pair.first.result.budget.expanded
    off = pair.found.value / mu
    u = hypot(pair.found.coverage * pair.found.standard / mu, off * own / mu)
    return _compared(pair, axis, 1.0 + off, u)


def _compared(pair: Pair, axis: Axis, y: float, u: float) -> dict[str, Any]:
    setpoint = pair.either.info.setpoint
    return {"x": axis.of(setpoint), "y": y, "u": finite(u), "label": condition_words(setpoint)}


def _repeats(results: RunResults, along: str, travels: dict[int, Travel]) -> list[Any]:
    """Return the committed repeats of a run along their number, rig time or the sliding of their piece."""
    points: list[Any] = []
    for row in repeats_table(results).rows:
        place = place_of(row.repeat, along, travels.get(row.repeat.key))
        points.append({
            "x": finite(place.x), "mu": finite(place.mu), "u": finite(place.expanded),
            "label": f"{condition_words(row.measured.info.setpoint)}, repeat {row.repeat.repeat}",
        })  # fmt: skip
    return points
