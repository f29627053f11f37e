"""The tables of a run: the paper's appendix, conditions, repeats, samples, as rows of cells.

Appendix, conditions and repeats hold no wall-clock time, path, host or version: the same data gives the
same bytes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from math import isnan

from tester.analysis.blocks import AVERAGED
from tester.analysis.repeats import ConditionResult
from tester.analysis.wear import ConditionWear
from tester.analysis.wear_check import WearCheck
from tester.axes import AXES, columns
from tester.export.cells import Cell, Number, exact, nominal
from tester.export.results import Measured, RunResults
from tester.process import SAMPLE_COLUMNS
from tester.store.reader import RunReader
from tester.store.records import ConditionInfo, RunInfo, StoredRepeat

_SETPOINTS = (
    "specimen",
    "replicate",
    "grid",
    "compound",
    "note",
    *(axis.column for axis in AXES),
)

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
)

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
    "revolutions",
    "truncated_revolutions",
    "window_s",
    "bursts",
    "started_s",
    "ended_s",
)

_MEASURED = tuple("measured_slip_mm_s" if name == "slip_m_s" else f"measured_{name}" for name in AVERAGED)

_WEAR = ("diameter_before_mm", "diameter_after_mm", "u_worn_mm", "wear_mm3_n_m", "wear_u_expanded")
"""Of a condition that lies between two checks of its wheel. ``u_worn_mm``: standard, of the difference."""

_CHECK = tuple(field.name for field in fields(WearCheck))

HEAD_COLUMN = "record_head"
RISK_COLUMN = "accepted_risk"
"""Last column of every table of a run for which a risk was accepted; ``conditions.csv`` has it among the metadata."""

WHOLE_COLUMNS = frozenset({"gate", "burst", "repeat_key"})
"""Columns of a sample whose values are whole numbers."""

SAMPLE_HEADER: tuple[str, ...] = (*SAMPLE_COLUMNS, "condition", "repeat", "attempt")


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

    The paper's six columns, and one more for every axis that is off its default in any condition of the recipe.
    """
    axes = columns(row.info for row in results.rows)
    yield ("Formula", *(axis.header for axis in axes), "Friction Coefficient")
    for row in results.rows:
        if row.result.ok:
            yield (
                row.info.compound,
                *(nominal(axis.of(row.info)) for axis in axes),
                Number(f"{row.result.mu_resultant:.{decimals}f}"),
            )


def condition_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each condition, and for one measured on several wheels a row that combines them.

    ``level`` is ``condition`` or ``combined``; what the recipe says of the test follows, a column each, and last the
    head of the record's chain: empty for a simulated run, which its seed proves, byte for byte.
    """
    metadata = dict(sorted(results.run.info.metadata.items()))
    last = (*metadata.values(), "" if results.run.info.simulated else results.record_head)
    own = ("level", "condition", *_SETPOINTS, *_CONDITION, "warming_k_s", "holdable_band_k", *_MEASURED, *_WEAR)
    yield (*own, *(key if key not in (*own, HEAD_COLUMN) else f"recipe_{key}" for key in metadata), HEAD_COLUMN)
    for row in results.rows:
        for measured in row.replicates:
            rate = (measured.condition.warming_k_s, measured.condition.holdable_band_k)
            setpoints = _setpoints(measured.info, measured.info.replicate)
            result = _condition(measured.result)
            wear = _wear(results.condition_wear(measured.info.condition))
            cells = (*setpoints, *result[0], *rate, *result[1], *wear)
            yield ("condition", measured.info.condition, *cells, *last)
        if len(row.replicates) > 1:
            result = _condition(row.result)
            setpoints = _setpoints(row.info, None)
            yield ("combined", None, *setpoints, *result[0], None, None, *result[1], *_wear(None), *last)


def repeat_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each committed repeat: its last attempt."""
    yield ("condition", "repeat", "attempt", "wheel", *_SETPOINTS, *_REPEAT, *_MEASURED)
    for measured in results.conditions():
        for repeat in measured.repeats:
            yield (
                repeat.condition,
                repeat.repeat,
                repeat.attempt,
                repeat.wheel,
                *_setpoints(measured.info, measured.info.replicate),
                *_repeat(measured, repeat),
            )


def wheel_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each wheel: what it was and is, and its wear rate over all its checks (95 % interval)."""
    own = ("wheel", "specimen", "replicate", "compound", "installed_diameter_mm", "diameter_mm", "sliding_m")
    yield (*own, "checks", "wear_mm3_n_m", "wear_u_standard", "wear_u_expanded")
    for wheel in results.wheels:
        found = results.wear_of(wheel.wheel)
        yield (*(getattr(wheel, name) for name in own), found.checks, found.rate, found.standard, found.expanded)


def check_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each check of a wheel's diameter; ``before`` and ``after`` are conditions, empty for none."""
    yield _CHECK
    for check in results.checks:
        yield tuple(None if name in ("before", "after") and not value else value for name, value in _cells(check))


def _cells(check: WearCheck) -> Iterator[tuple[str, Cell]]:
    return ((name, getattr(check, name)) for name in _CHECK)


def _wear(found: ConditionWear | None) -> tuple[Cell, ...]:
    if found is None:
        return (None,) * len(_WEAR)
    return found.before_mm, found.after_mm, found.u_mm, found.rate.rate, found.rate.expanded


def sample_rows(reader: RunReader) -> Iterator[tuple[Cell, ...]]:
    """Yield every recorded sample with the condition, repeat and attempt it belongs to (empty: none)."""
    yield SAMPLE_HEADER
    owners = {repeat.key: repeat for repeat in reader.repeats(attempts=True)}
    for block in reader.sample_blocks():
        owner = owners.get(block.repeat_key)
        ids = (owner.condition, owner.repeat, owner.attempt) if owner is not None else (None, None, None)
        columns = [
            [_whole(value) for value in block.columns[name]]
            if name in WHOLE_COLUMNS
            else [exact(value) for value in block.columns[name]]
            for name in SAMPLE_COLUMNS
        ]
        for cells in zip(*columns, strict=True):
            yield (*cells, *ids)


def _whole(value: float) -> Number:
    return Number("") if isnan(value) else Number(int(value))


def _setpoints(i: ConditionInfo, replicate: int | None) -> tuple[Cell, ...]:
    return (
        i.specimen,
        replicate,
        i.grid,
        i.compound,
        i.note,
        *(nominal(axis.of(i)) for axis in AXES),
    )


def _condition(r: ConditionResult) -> tuple[tuple[Cell, ...], tuple[Cell, ...]]:
    """Return the cells of _CONDITION and of _MEASURED."""
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
    )
    return found, tuple(_scaled(name, r.measured.get(name)) for name in AVERAGED)


def _repeat(measured: Measured, repeat: StoredRepeat) -> tuple[Cell, ...]:
    """Return the cells of _REPEAT and of _MEASURED."""
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
        r.revolutions,
        r.truncated,
        r.window_s,
        r.bursts,
        r.started_s,
        r.ended_s,
        *(_scaled(name, getattr(r, name)) for name in AVERAGED),
    )


def _scaled(name: str, value: float | None) -> float | None:
    return 1e3 * value if name == "slip_m_s" and value is not None else value
