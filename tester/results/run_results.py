"""A run's results as the tables show them: every condition reduced from its committed repeats, in recipe order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import isfinite

from tester.analysis.closest import Combining, combining_of
from tester.analysis.flags import DISAGREES, OUT_OF_LIMITS, REFERENCE, THERMOMETER, flags_in, joined, remedy_of
from tester.analysis.measurand import pooled, with_budget, with_budget_of_replicates
from tester.analysis.misalignment import Misalignment, misalignment
from tester.analysis.reference import (
    RESERVED,
    ControlChart,
    CounterfaceDrift,
    Reference,
    control_charts,
    counterface_drift,
    doubted,
    is_reference,
)
from tester.analysis.repeats import ConditionResult, combine_replicates
from tester.analysis.results import ConditionStatus, SoakCheck
from tester.analysis.wear_rate import ConditionWear, WearCheck, WearRate, condition_wear, wear_rate
from tester.base.axes import Axes, condition_words
from tester.base.quantities import Quantities
from tester.base.words import coefficient
from tester.results.settings_compared import RepeatedSetting, SettingsOf, in_doubt
from tester.results.surroundings import Reduced, SurroundingsOf
from tester.store.amend import standing
from tester.store.records import ConditionInfo, PieceInfo, StoredCondition, StoredExclusion, StoredRepeat, StoredRun
from tester.store.run_folders import RunStatus, run_status, under_way
from tester.store.run_reader import RunReader


@dataclass(frozen=True, slots=True)
class Measured:
    """One condition of the plan with its repeats and their result."""

    condition: StoredCondition
    repeats: tuple[StoredRepeat, ...]
    result: ConditionResult
    by_hand: Mapping[int, StoredExclusion]
    """Exclusions by a person, by position in ``repeats``."""
    soak: SoakCheck | None = None
    """The surface's thermometer after the soak; None without a record of it."""

    @property
    def info(self) -> ConditionInfo:
        """Return the condition's setpoints."""
        return self.condition.info

    def exclusion(self, repeat: StoredRepeat) -> str:
        """Return why a repeat is not in the mean, an empty text if it is."""
        position = self.repeats.index(repeat)
        return next((e.reason for e in self.result.excluded if e.position == position), "")

    @property
    def make_ups(self) -> list[StoredRepeat]:
        """Return the repeats made in place of refused ones; of pairs, both repeats of each."""
        each = self.result.repeats_each
        return [repeat for i, repeat in enumerate(self.repeats) if i // each in self.result.counts.make_ups]

    def left_out_by(self, repeat: StoredRepeat) -> StoredExclusion | None:
        """Return a person's exclusion of a repeat, None without one."""
        return self.by_hand.get(self.repeats.index(repeat))


@dataclass(frozen=True, slots=True)
class TableRow:
    """A row of the recipe's table: its replicates, and their value."""

    replicates: tuple[Measured, ...]
    result: ConditionResult

    @property
    def info(self) -> ConditionInfo:
        """Return the setpoints, those of the first replicate."""
        return self.replicates[0].info

    @property
    def tried(self) -> bool:
        """Return whether the run came to this row: a repeat is on record, or why there is none."""
        return self.result.status is not ConditionStatus.PENDING or any(m.repeats for m in self.replicates)

    def describe(self) -> str:
        """Return the row's setpoints and why it has no value, as a line for people."""
        parts = [self.result.status.value, self.result.reason]
        for measured in self.replicates:
            c = measured.condition
            if not measured.result.ok and isfinite(c.warming_k_s) and not c.reason:
                parts.append(f"warming {c.warming_k_s:.2g} K/s; {c.holdable_band_k:.2g} K of band would do")
        return ": ".join([condition_words(self.info.setpoint), *[part for part in parts if part]])

    def advise(self) -> str:
        """Return the row's problem or doubts, and the remedy, for people."""
        sentence = self.describe()
        if self.result.ok:
            sentence = f"{sentence}: {', '.join(self.result.doubts)}"
        advice = remedy(self.result)
        return f"{sentence}: {advice}" if advice else sentence


@dataclass(frozen=True, slots=True)
class ReferenceWatch:
    """Result of a run's references: themselves, the counterface's drift, a control chart for each compound."""

    references: tuple[Reference, ...]
    drift: CounterfaceDrift | None
    charts: tuple[ControlChart, ...]

    def lines(self, worn: str) -> Iterator[str]:
        """Yield the result, for people; ``worn``: the kind's word for a piece."""
        if self.drift is not None:
            yield self.drift.sentence(worn)
        else:
            yield "counterface: fewer than two references have a value, nothing is known of it"
        for chart in self.charts:
            outside = [f"{point.number}" for point in chart.points if isfinite(point.mu) and not point.within]
            limits = f"references of {chart.compound}: limits {coefficient(chart.low)} to {coefficient(chart.high)}"
            yield f"{limits}; outside: {', '.join(outside)}" if outside else f"{limits}; all inside"


_WHAT_TO_DO: Mapping[ConditionStatus, str] = {
    ConditionStatus.CANNOT_HOLD: "a wider temperature_band, a lower load or a lower speed would help",
    ConditionStatus.NOT_REACHED: "check heating and cooling, or allow more time (soak.at_most)",
    ConditionStatus.INSUFFICIENT: "a wider temperature_band or more max_bursts would help",
    ConditionStatus.PENDING: "tester resume continues the run",
}


def remedy(result: ConditionResult) -> str:
    """Return the remedy for a condition without a value, or with one that needs care; "" where none is needed."""
    if not result.ok:
        return _WHAT_TO_DO.get(result.status, "")
    return remedy_of(result.doubts)


@dataclass(frozen=True, slots=True)
class RunResults:
    """All results of a run."""

    run: StoredRun
    rows: tuple[TableRow, ...]
    status: RunStatus
    """The run's status at the time of reading."""
    quantities: Quantities
    """The record's own channels."""
    pieces: tuple[PieceInfo, ...] = ()
    """The mounted pieces."""
    checks: tuple[WearCheck, ...] = ()
    """Checks of their diameters, in order of time."""
    references: tuple[TableRow, ...] = ()
    """Reference conditions, in the order of the plan; they are not among the recipe's own conditions."""
    watch: ReferenceWatch | None = None
    """Their result; None without any."""
    settings: tuple[RepeatedSetting, ...] = ()
    """Settings measured several times, references included."""
    record_head: str = ""
    """The last head of the record's chain, hexadecimal."""

    @property
    def axes(self) -> Axes:
        """Return the axes of the run's conditions."""
        return self.run.info.axes

    @property
    def worn(self) -> str:
        """Return the kind's word for a piece: the part of the machine that wears."""
        return self.run.info.worn

    @property
    def both_directions(self) -> bool:
        """Return whether any condition is measured in both directions of sliding."""
        return any(measured.info.both_directions for measured in self.conditions())

    def misalignment(self) -> Misalignment:
        """Return the apparent misalignment of the cell's axes, over all conditions measured in both directions."""
        return misalignment(measured.result for measured in self.conditions())

    def angle_lines(self) -> Iterator[str]:
        """Yield the apparent misalignment of the cell's axes as a line for people, where both directions reveal it."""
        angle = self.misalignment()
        if angle.pairs:
            known = f" ± {angle.expanded_deg:.2f}" if isfinite(angle.expanded_deg) else ""
            sentence = f"the cell's axes seem to be off by {angle.deg:+.2f}{known} deg (95 %, {angle.pairs} pairs)"
            yield f"both directions: {sentence}, crosstalk in it; the coefficients are free of it"

    def watch_lines(self) -> Iterator[str]:
        """Yield the results of references and of settings measured several times, in lines for people."""
        if self.watch is not None:
            yield from self.watch.lines(self.worn)
        for setting in self.settings:
            yield from setting.lines(self.worn)

    def wear_of(self, piece: int) -> WearRate:
        """Return the wear rate over the life of a mounted piece, by number."""
        return wear_rate([check for check in self.checks if check.piece == piece])

    def condition_wear(self, condition: int) -> ConditionWear | None:
        """Return the wear by a condition; None without checks around it."""
        return condition_wear(self.checks, condition) if self.checks else None

    def wear_lines(self) -> Iterator[str]:
        """Yield, for each mounted piece with checks, its diameter and its wear rate as a line for people."""
        for piece in self.pieces:
            checks = [check for check in self.checks if check.piece == piece.piece]
            if not checks:
                continue
            rate = wear_rate(checks)
            text = (
                f"{self.worn} {piece.piece} ({piece.compound}): {piece.diameter_mm:.3f} mm after {len(checks)} checks"
            )
            if isfinite(rate.rate):
                text += f", wear {rate.rate:.3g} ± {rate.expanded:.2g} mm3/(N m)"
                text += "" if rate.resolved else ", not resolved from 0"
            yield text

    def all_rows(self) -> Iterator[TableRow]:
        """Yield the rows in recipe order, then the references."""
        yield from self.rows
        yield from self.references

    def conditions(self) -> Iterator[Measured]:
        """Yield the conditions, in recipe order, replicates one after the other, then the references."""
        for row in self.all_rows():
            yield from row.replicates

    def valued(self) -> int:
        """Return how many of the recipe's own rows have a trustworthy value."""
        return sum(row.result.ok for row in self.rows)

    def doubtful(self) -> list[TableRow]:
        """Return the rows whose value needs care."""
        return [row for row in self.rows if row.result.ok and row.result.doubts]

    def missing(self) -> list[TableRow]:
        """Return the rows without a trustworthy value, references included."""
        return [row for row in self.all_rows() if not row.result.ok]


def results_of(reader: RunReader) -> RunResults:
    """Return the results of a run's committed repeats; raises StoreError where the record cannot be read."""
    run = reader.run()
    combining = combining_of(run.info.metadata)
    left_out = standing(reader.exclusions())
    repeats: dict[int, list[StoredRepeat]] = {}
    for repeat in reader.repeats():
        repeats.setdefault(repeat.condition, []).append(repeat)
    stored = reader.conditions()
    conditions = [
        _measured(condition, repeats.get(condition.info.condition, []), left_out, combining) for condition in stored
    ]
    soaks = reader.soaks()
    conditions = [replace(condition, soak=soaks.get(condition.info.condition)) for condition in conditions]
    conditions = [
        condition if condition.soak is None or condition.soak.agrees else _flagged(condition, THERMOMETER)
        for condition in conditions
    ]
    pieces, checks = tuple(reader.pieces()), tuple(reader.wear_checks())
    surroundings = SurroundingsOf(reader, run, pieces, checks, pooled([condition.result for condition in conditions]))
    watching = [is_reference(condition.info.grid, run.info.metadata) for condition in conditions]
    for condition, watches in zip(conditions, watching, strict=True):
        if not watches:
            surroundings.add(condition.info.setpoint, condition.result)
    watch = None
    if any(watching):
        references = [condition for condition, watches in zip(conditions, watching, strict=True) if watches]
        watch = watch_of(references, surroundings, run)
        surroundings.watched(watch.drift)
        ordinary = [
            condition.info.condition for condition, watches in zip(conditions, watching, strict=True) if not watches
        ]
        doubts = doubted(watch.charts, ordinary)
        conditions = [
            _flagged(condition, REFERENCE if watches else OUT_OF_LIMITS)
            if watches or condition.info.condition in doubts
            else condition
            for condition, watches in zip(conditions, watching, strict=True)
        ]
    conditions, settings = _budgeted(conditions, surroundings)
    rows = _rows(conditions, surroundings)
    missing = any(not row.result.ok for row in rows)
    ours = [row for row in rows if not is_reference(row.info.grid, run.info.metadata)]
    references = [row for row in rows if is_reference(row.info.grid, run.info.metadata)]
    in_use = under_way(reader.path.parent) is not None
    status = run_status(run.status, held=in_use, missing=missing)
    return RunResults(
        run,
        tuple(ours),
        status,
        reader.quantities(),
        pieces,
        checks,
        tuple(references),
        watch,
        settings,
        reader.record_head(),
    )


def _budgeted(
    conditions: Sequence[Measured], surroundings: SurroundingsOf
) -> tuple[list[Measured], tuple[RepeatedSetting, ...]]:
    """Return the conditions with their budgets, flagged where their setting disagrees, and the repeated settings."""
    listed: list[Measured] = []
    settings = SettingsOf()
    for condition in conditions:
        by = surroundings.of(condition.info, condition.repeats, condition.result)
        result = with_budget(condition.result, by)
        settings.add(condition.info, condition.repeats, result, by)
        listed.append(replace(condition, result=result))
    repeated = settings.repeated()
    doubts = in_doubt(repeated)
    flagged = [
        _flagged(condition, DISAGREES) if condition.info.condition in doubts else condition for condition in listed
    ]
    return flagged, repeated


def _rows(conditions: Sequence[Measured], surroundings: SurroundingsOf) -> list[TableRow]:
    """Return the rows of conditions with their budgets; for replicates their mean, with its own."""
    rows: list[TableRow] = []
    for _, group in groupby(conditions, key=lambda condition: condition.info.row):
        replicates = tuple(group)
        if len(replicates) == 1:
            rows.append(TableRow(replicates, replicates[0].result))
            continue
        results = [replicate.result for replicate in replicates]
        combined = combine_replicates(results)
        measured = [repeat for replicate in replicates for repeat in replicate.repeats]
        by = surroundings.of(replicates[0].info, measured, combined)
        rows.append(TableRow(replicates, with_budget_of_replicates(combined, results, by)))
    return rows


def watch_of(references: Sequence[Measured], surroundings: SurroundingsOf, run: StoredRun) -> ReferenceWatch:
    """Return the result of a run's reference conditions, each with its coefficient at the nominal temperature."""
    in_order = sorted(references, key=lambda condition: condition.info.condition)
    listed: list[Reference] = []
    for number, condition in enumerate(in_order, start=1):
        result = with_budget(condition.result, surroundings.of(condition.info, condition.repeats, condition.result))
        at = Reduced(condition.condition.started_s, result)
        listed.append(surroundings.reference(number, condition.info, condition.repeats, at))
    known = surroundings.known(RESERVED in run.info.metadata)
    return ReferenceWatch(tuple(listed), counterface_drift(listed, known), control_charts(listed, known))


def _flagged(measured: Measured, flag: str) -> Measured:
    """Return a condition with one more flag."""
    flags = joined([*flags_in(measured.result.flags), flag])
    return replace(measured, result=replace(measured.result, flags=flags))


def _measured(
    stored: StoredCondition,
    repeats: list[StoredRepeat],
    left_out: dict[tuple[int, int, int], StoredExclusion],
    combining: Combining,
) -> Measured:
    info = stored.info
    by_hand = {i: left_out[repeat.target] for i, repeat in enumerate(repeats) if repeat.target in left_out}
    result = info.scheme.combine(
        [repeat.result for repeat in repeats],
        planned=info.repeats,
        min_valid=info.min_valid,
        ended=stored.status,
        reason=stored.reason,
        judged=stored.judged,
        by_hand={i: one.reason for i, one in by_hand.items()},
        combining=combining,
    )
    return Measured(stored, tuple(repeats), result, by_hand)
