"""The tables of a run: the paper's appendix, conditions, repeats, samples, as rows of cells.

Appendix, conditions and repeats hold no wall-clock time, path, host or version: the same data gives the
same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from math import isnan

from tester.analysis.directions import is_reversed
from tester.analysis.repeats import ConditionResult
from tester.analysis.wear import ConditionWear
from tester.analysis.wear_check import WearCheck
from tester.quantities import Means, Quantities
from tester.results.cells import Cell, Number, exact, nominal
from tester.results.run_results import Measured, RunResults
from tester.store.reader import RunReader
from tester.store.records import ConditionInfo, RunInfo, StoredRepeat

_OF_CONDITION = ("specimen", "replicate", "grid", "compound", "note")

_CONDITION = (
    "status",
    "reason",
    "flags",
    "mu_resultant",
    "mu_longitudinal",
    "mu_lateral",
    "mu_without_flagged",
    "s",
    "n_valid",
    "n",
    "interval_95",
    "u_type_a",
    "u_standard",
    "u_expanded",
    "coverage_factor",
    "drift_percent",
    "drift_bound_percent",
    "trend_percent",
    "change_percent",
    "swing_percent",
    "swing_hz",
    "mu_corrected",
)

_COMPOUND = ("u_standard_compound", "u_expanded_compound", "coverage_factor_compound")
"""Of the compound: what any piece of it would show. Before them stands the expanded uncertainty of this piece in this
condition once more, under its name: that of ``u_expanded``."""

_REPEAT = (
    "status",
    "reason",
    "flags",
    "in_mean",
    "exclusion",
    "mu_resultant",
    "mu_longitudinal",
    "mu_lateral",
    "u_window",
    "fluctuation_percent",
    "drift_percent",
    "drift_bound_percent",
    "change_percent",
    "swing_percent",
    "swing_hz",
    "swing_skewness",
    "revolutions",
    "truncated_revolutions",
    "window_s",
    "bursts",
    "started_s",
    "ended_s",
)

_REFERENCE = (
    "status",
    "started_s",
    "counterface_travel_m",
    "piece_sliding_m",
    "mu_corrected",
    "u_expanded",
    "centre",
    "limit_low",
    "limit_high",
    "within",
)

_DRIFT = ("change_percent", "change_low_percent", "change_high_percent", "change_over_m", "told_apart")

_WEAR = ("diameter_before_mm", "diameter_after_mm", "u_worn_mm", "wear_mm3_n_m", "wear_u_expanded")
"""Of a condition that lies between two checks of a diameter. ``u_worn_mm``: standard, of the difference."""

_CHECK = tuple(field.name for field in fields(WearCheck) if field.name != "piece")

HEAD_COLUMN = "record_head"
AS_ASKED, REVERSED = "as asked", "reversed"
"""Directions of sliding."""
RISK_COLUMN = "accepted_risk"
"""Last column of every table of a run for which a risk was accepted; ``conditions.csv`` has it among the metadata."""

OWNER = ("condition", "repeat", "attempt")
"""Last columns of the samples: whose they are."""


def marked(rows: Iterator[tuple[Cell, ...]], run: RunInfo) -> Iterator[tuple[Cell, ...]]:
    """Yield a table's rows, with a last column that names the risk, where one was accepted for the run."""
    if not run.risk:
        yield from rows
        return
    yield (*next(rows), RISK_COLUMN)
    for row in rows:
        yield (*row, run.risk)


def appendix_rows(results: RunResults, decimals: int = 2) -> Iterator[tuple[Cell, ...]]:
    """Yield the paper's table: nominal setpoints, one row for each condition that has a value to be trusted.

    Reference conditions are not in it: one setpoint many times over is no further condition of a compound, and who
    plots or fits the table would count it as often.

    The paper's six columns, and one more for every axis that is off its default in any condition of the recipe.
    """
    axes = results.axes.columns(row.info.setpoint for row in results.rows)
    yield ("Formula", *(axis.header for axis in axes), "Friction Coefficient")
    for row in results.rows:
        if row.result.ok:
            yield (
                row.info.compound,
                *(nominal(axis.of(row.info.setpoint)) for axis in axes),
                Number(f"{row.result.mu_resultant:.{decimals}f}"),
            )


def condition_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each condition, and for one measured in replicates a row that combines them.

    ``level`` is ``condition`` or ``combined``; what the recipe says of the test follows, a column each, and last the
    head of the record's chain: empty for a simulated run, which its seed proves, byte for byte.
    """
    metadata = dict(sorted(results.run.info.metadata.items()))
    last = (*metadata.values(), "" if results.run.info.simulated else results.record_head)
    rate = ("warming_k_s", "holdable_band_k")
    means = _measured_header(results.quantities)
    own = ("level", "condition", *setpoint_header(results), *_CONDITION, *_measurands(results), *rate, *means, *_WEAR)
    yield (*own, *(key if key not in (*own, HEAD_COLUMN) else f"recipe_{key}" for key in metadata), HEAD_COLUMN)
    for row in results.all_rows():
        for measured in row.replicates:
            held = (measured.condition.warming_k_s, measured.condition.holdable_band_k)
            held_at = setpoints(measured.info, measured.info.replicate)
            result = _condition(measured.result, results.quantities)
            wear = _wear(results.condition_wear(measured.info.condition))
            cells = (*held_at, *result[0], *held, *result[1], *wear)
            yield ("condition", measured.info.condition, *cells, *last)
        if len(row.replicates) > 1:
            result = _condition(row.result, results.quantities)
            held_at = setpoints(row.info, None)
            yield ("combined", None, *held_at, *result[0], None, None, *result[1], *_wear(None), *last)


def repeat_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each committed repeat: its last attempt."""
    held = setpoint_header(results)
    both = results.both_directions
    way = ("direction",) if both else ()
    yield ("condition", "repeat", "attempt", results.worn, *held, *_REPEAT, *_measured_header(results.quantities), *way)
    for measured in results.conditions():
        for repeat in measured.repeats:
            yield (
                repeat.condition,
                repeat.repeat,
                repeat.attempt,
                repeat.piece,
                *setpoints(measured.info, measured.info.replicate),
                *_repeat(measured, repeat, results.quantities),
                *((_direction(measured, repeat),) if both else ()),
            )


def _direction(measured: Measured, repeat: StoredRepeat) -> str:
    turned = measured.info.both_directions and is_reversed(repeat.repeat)
    return REVERSED if turned else AS_ASKED


def reference_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each reference condition, in the order of measurement: the points of its control chart.

    ``mu_corrected`` is at the temperature asked for, ``u_expanded`` its expanded repeatability (95 %); ``within`` is
    empty where it has no value. What is found of the counterface is the same in every row: change over the travel
    between the first and the last of them, per cent, with its interval (95 %), and whether it is told apart.
    """
    watch = results.watch
    own = ("reference", "condition", results.worn, "compound", *(axis.column for axis in results.axes), *_REFERENCE)
    yield (*own, *_DRIFT)
    if watch is None:
        return
    points = {point.condition: (chart, point) for chart in watch.charts for point in chart.points}
    drift = watch.drift
    found: tuple[Cell, ...] = (None,) * len(_DRIFT)
    if drift is not None:
        found = (*drift.changed_percent(drift.over_m), drift.over_m, int(drift.apart))
    rows = {row.info.condition: row for row in results.references}
    for one in watch.references:
        info = rows[one.condition].info
        result = rows[one.condition].result
        chart, point = points.get(one.condition, (None, None))
        limits = (None, None, None) if chart is None else (chart.centre, chart.low, chart.high)
        within = int(point.within) if point is not None and not isnan(point.mu) else None
        expanded = None if point is None else point.expanded
        held = (nominal(axis.of(info.setpoint)) for axis in info.setpoint.axes)
        said = (result.status.value, one.t_s, one.counterface_m, one.piece_m, one.mu, expanded, *limits, within)
        yield (one.number, one.condition, one.piece or None, one.compound, *held, *said, *found)


def piece_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each piece that was mounted: what it was and is, and its wear rate over all its checks (95 %
    interval)."""
    own = ("specimen", "replicate", "compound", "installed_diameter_mm", "diameter_mm", "sliding_m")
    yield (results.worn, *own, "checks", "wear_mm3_n_m", "wear_u_standard", "wear_u_expanded")
    for one in results.pieces:
        found = results.wear_of(one.piece)
        cells = (getattr(one, name) for name in own)
        yield (one.piece, *cells, found.checks, found.rate, found.standard, found.expanded)


def check_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each check of a diameter; ``before`` and ``after`` are conditions, empty for none."""
    yield (results.worn, *_CHECK)
    for check in results.checks:
        cells = ((name, getattr(check, name)) for name in _CHECK)
        yield (check.piece, *(None if name in ("before", "after") and not value else value for name, value in cells))


def _wear(found: ConditionWear | None) -> tuple[Cell, ...]:
    if found is None:
        return (None,) * len(_WEAR)
    return found.before_mm, found.after_mm, found.u_mm, found.rate.rate, found.rate.expanded


def sample_rows(reader: RunReader) -> Iterator[tuple[Cell, ...]]:
    """Yield every recorded sample with the condition, repeat and attempt it belongs to (empty: none)."""
    channels = reader.quantities().recorded
    yield (*(one.name for one in channels), *OWNER)
    owners = {repeat.key: repeat for repeat in reader.repeats(attempts=True)}
    for block in reader.sample_blocks():
        owner = owners.get(block.repeat_key)
        ids = (owner.condition, owner.repeat, owner.attempt) if owner is not None else (None, None, None)
        columns = [
            [_whole(value) if one.whole else exact(value) for value in block.columns[one.name]] for one in channels
        ]
        for cells in zip(*columns, strict=True):
            yield (*cells, *ids)


def _whole(value: float) -> Number:
    return Number("") if isnan(value) else Number(int(value))


def _measurands(results: RunResults) -> tuple[str, ...]:
    return (f"u_expanded_this_{results.worn}", *_COMPOUND)


def setpoint_header(results: RunResults) -> tuple[str, ...]:
    """Return the columns that say which condition a row is of."""
    return (*_OF_CONDITION, *(axis.column for axis in results.axes))


def setpoints(i: ConditionInfo, replicate: int | None) -> tuple[Cell, ...]:
    """Return their cells; ``replicate`` None for what stands for all replicates."""
    return (
        i.specimen,
        replicate,
        i.grid,
        i.compound,
        i.note,
        *(nominal(axis.of(i.setpoint)) for axis in i.setpoint.axes),
    )


def _measured_header(quantities: Quantities) -> tuple[str, ...]:
    return tuple(one.measured_column for one in quantities.averaged)


def _measured(means: Means, quantities: Quantities) -> tuple[Cell, ...]:
    return tuple(one.scaled(means.get(one.name)) for one in quantities.averaged)


def _condition(r: ConditionResult, quantities: Quantities) -> tuple[tuple[Cell, ...], tuple[Cell, ...]]:
    """Return the cells of _CONDITION, of the measurands, and of what was measured."""
    found = (
        r.status.value,
        r.reason,
        r.flags,
        r.mu_resultant,
        r.mu_longitudinal,
        r.mu_lateral,
        r.mu_without_flagged,
        r.s,
        r.n_valid,
        r.n,
        r.interval,
        r.type_a,
        r.standard,
        r.expanded,
        r.coverage,
        r.drift_percent,
        r.drift_bound_percent,
        r.trend_percent,
        r.change_percent,
        r.swing_percent,
        r.swing_hz,
        r.mu_corrected,
        r.expanded,
        r.compound_budget.standard,
        r.compound_budget.expanded,
        r.compound_budget.coverage,
    )
    return found, _measured(r.measured, quantities)


def _repeat(measured: Measured, repeat: StoredRepeat, quantities: Quantities) -> tuple[Cell, ...]:
    """Return the cells of _REPEAT and of what was measured."""
    r = repeat.result
    exclusion = measured.exclusion(repeat)
    return (
        r.status.value,
        r.reason,
        r.flags,
        int(not exclusion),
        exclusion,
        r.mu_resultant,
        r.mu_longitudinal,
        r.mu_lateral,
        r.uncertainty,
        r.fluctuation_percent,
        r.drift_percent,
        r.bound_percent,
        r.change_percent,
        r.swing_percent,
        r.swing_hz,
        r.swing_skewness,
        r.revolutions,
        r.truncated,
        r.window_s,
        r.bursts,
        r.started_s,
        r.ended_s,
        *_measured(r.means, quantities),
    )
