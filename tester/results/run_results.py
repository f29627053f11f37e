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
from tester.analysis.wear import ConditionWear, WearCheck, WearRate, condition_wear, wear_rate
from tester.base.axes import Axes, condition_words
from tester.base.quantities import Quantities
from tester.base.words import coefficient
from tester.results.settings import RepeatedSetting, SettingsOf, in_doubt
from tester.results.surroundings import Reduced, SurroundingsOf
from tester.store.amend import standing
from tester.store.catalogue import RunStatus, run_status, under_way
from tester.store.reader import RunReader
from tester.store.records import ConditionInfo, PieceInfo, StoredCondition, StoredExclusion, StoredRepeat, StoredRun


@dataclass(frozen=True, slots=True)
class Measured:
    """One condition of the plan with its repeats and what they give."""

    condition: StoredCondition
    repeats: tuple[StoredRepeat, ...]
    result: ConditionResult
    by_hand: Mapping[int, StoredExclusion]
    """What a person has left out, by its position in ``repeats``."""
    soak: SoakCheck | None = None
    """The surface's thermometer after the soak; None where nothing is on record of it."""

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
        """Return the repeats that were made in place of refused ones; of pairs, both repeats of each."""
        each = self.result.repeats_each
        return [one for i, one in enumerate(self.repeats) if i // each in self.result.counts.make_ups]

    def left_out_by(self, repeat: StoredRepeat) -> StoredExclusion | None:
        """Return who has left a repeat out, None where nobody has."""
        return self.by_hand.get(self.repeats.index(repeat))


@dataclass(frozen=True, slots=True)
class TableRow:
    """A row of the recipe's table: its replicates, and the value that stands for them."""

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
        """Return the row's setpoints and why it has no value, in a line for people."""
        parts = [self.result.status.value, self.result.reason]
        for measured in self.replicates:
            c = measured.condition
            if not measured.result.ok and isfinite(c.warming_k_s) and not c.reason:
                parts.append(f"warming {c.warming_k_s:.2g} K/s; {c.holdable_band_k:.2g} K of band would do")
        return ": ".join([condition_words(self.info.setpoint), *[part for part in parts if part]])

    def advise(self) -> str:
        """Return what is wrong with the row, or to be taken with care, and what to do about it, for people."""
        told = self.describe()
        if self.result.ok:
            told = f"{told}: {', '.join(self.result.doubts)}"
        advice = remedy(self.result)
        return f"{told}: {advice}" if advice else told


@dataclass(frozen=True, slots=True)
class ReferenceWatch:
    """What a run's reference conditions say: themselves, the counterface's drift, a control chart for each compound."""

    references: tuple[Reference, ...]
    drift: CounterfaceDrift | None
    charts: tuple[ControlChart, ...]

    def lines(self, worn: str) -> Iterator[str]:
        """Yield what was found, for people; ``worn``: what they call a piece."""
        if self.drift is not None:
            yield self.drift.sentence(worn)
        else:
            yield "counterface: fewer than two references have a value, nothing is known of it"
        for chart in self.charts:
            outside = [f"{one.number}" for one in chart.points if isfinite(one.mu) and not one.within]
            told = f"references of {chart.compound}: limits {coefficient(chart.low)} to {coefficient(chart.high)}"
            yield f"{told}; outside: {', '.join(outside)}" if outside else f"{told}; all inside"


_WHAT_TO_DO: Mapping[ConditionStatus, str] = {
    ConditionStatus.CANNOT_HOLD: "a wider temperature_band, a lower load or a lower speed would help",
    ConditionStatus.NOT_REACHED: "check heating and cooling, or allow more time (soak.at_most)",
    ConditionStatus.INSUFFICIENT: "a wider temperature_band or more max_bursts would help",
    ConditionStatus.PENDING: "tester resume goes on with the run",
}


def remedy(result: ConditionResult) -> str:
    """Return what to do about a condition without a value, or with one to be taken with care; "" where nothing is."""
    if not result.ok:
        return _WHAT_TO_DO.get(result.status, "")
    return remedy_of(result.doubts)


@dataclass(frozen=True, slots=True)
class RunResults:
    """All results of a run."""

    run: StoredRun
    rows: tuple[TableRow, ...]
    status: RunStatus
    """How the run stood when this was read."""
    quantities: Quantities
    """The record's own channels."""
    pieces: tuple[PieceInfo, ...] = ()
    """What was mounted to be measured."""
    checks: tuple[WearCheck, ...] = ()
    """Of their diameters, in the order in which they were made."""
    references: tuple[TableRow, ...] = ()
    """Reference conditions, in the order in which they were planned: none of the recipe's own conditions."""
    watch: ReferenceWatch | None = None
    """What they say; None without any."""
    settings: tuple[RepeatedSetting, ...] = ()
    """What was measured several times, references among it."""
    record_head: str = ""
    """The last head of the record's chain, hexadecimal."""

    @property
    def axes(self) -> Axes:
        """Return the axes of the run's conditions."""
        return self.run.info.axes

    @property
    def worn(self) -> str:
        """Return what people call what is mounted: the part of the machine that wears."""
        return self.run.info.worn

    @property
    def both_directions(self) -> bool:
        """Return whether any condition is measured in both directions of sliding."""
        return any(measured.info.both_directions for measured in self.conditions())

    def misalignment(self) -> Misalignment:
        """Return by what angle the cell's axes seem to be off, over all conditions measured in both directions."""
        return misalignment(measured.result for measured in self.conditions())

    def angle_lines(self) -> Iterator[str]:
        """Yield by what angle the cell's axes seem to be off, in a line for people, where both directions tell it."""
        found = self.misalignment()
        if found.pairs:
            known = f" ± {found.expanded_deg:.2f}" if isfinite(found.expanded_deg) else ""
            told = f"the cell's axes seem to be off by {found.deg:+.2f}{known} deg (95 %, {found.pairs} pairs)"
            yield f"both directions: {told}, crosstalk in it; the coefficients are free of it"

    def watch_lines(self) -> Iterator[str]:
        """Yield what references and settings that were measured several times say, in lines for people."""
        if self.watch is not None:
            yield from self.watch.lines(self.worn)
        for one in self.settings:
            yield from one.lines(self.worn)

    def wear_of(self, piece: int) -> WearRate:
        """Return the wear rate over the life of what was mounted under a number."""
        return wear_rate([one for one in self.checks if one.piece == piece])

    def condition_wear(self, condition: int) -> ConditionWear | None:
        """Return what a condition took off; None where no check says."""
        return condition_wear(self.checks, condition) if self.checks else None

    def wear_lines(self) -> Iterator[str]:
        """Yield, for everything mounted that was checked, its diameter and its wear rate in a line for people."""
        for one in self.pieces:
            checks = [check for check in self.checks if check.piece == one.piece]
            if not checks:
                continue
            found = wear_rate(checks)
            text = f"{self.worn} {one.piece} ({one.compound}): {one.diameter_mm:.3f} mm after {len(checks)} checks"
            if isfinite(found.rate):
                text += f", wear {found.rate:.3g} ± {found.expanded:.2g} mm3/(N m)"
                text += "" if found.resolved else ", not resolved from 0"
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
        """Return how many of the recipe's own rows have a value that can be trusted."""
        return sum(row.result.ok for row in self.rows)

    def doubtful(self) -> list[TableRow]:
        """Return the rows whose value is to be taken with care."""
        return [row for row in self.rows if row.result.ok and row.result.doubts]

    def missing(self) -> list[TableRow]:
        """Return the rows without a value that can be trusted, references among them."""
        return [row for row in self.all_rows() if not row.result.ok]


def results_of(reader: RunReader) -> RunResults:
    """Reduce a run's committed repeats; raises StoreError where the record cannot be read."""
    run = reader.run()
    combining = combining_of(run.info.metadata)
    left_out = standing(reader.exclusions())
    repeats: dict[int, list[StoredRepeat]] = {}
    for repeat in reader.repeats():
        repeats.setdefault(repeat.condition, []).append(repeat)
    stored = reader.conditions()
    found = [_measured(one, repeats.get(one.info.condition, []), left_out, combining) for one in stored]
    soaks = reader.soaks()
    found = [replace(one, soak=soaks.get(one.info.condition)) for one in found]
    found = [one if one.soak is None or one.soak.agrees else _flagged(one, THERMOMETER) for one in found]
    pieces, checks = tuple(reader.pieces()), tuple(reader.wear_checks())
    surroundings = SurroundingsOf(reader, run, pieces, checks, pooled([one.result for one in found]))
    watching = [is_reference(one.info.grid, run.info.metadata) for one in found]
    for one, watches in zip(found, watching, strict=True):
        if not watches:
            surroundings.add(one.info.setpoint, one.result)
    watch = None
    if any(watching):
        references = [one for one, watches in zip(found, watching, strict=True) if watches]
        watch = watch_of(references, surroundings, run)
        surroundings.watched(watch.drift)
        own = [one.info.condition for one, watches in zip(found, watching, strict=True) if not watches]
        doubts = doubted(watch.charts, own)
        found = [
            _flagged(one, REFERENCE if watches else OUT_OF_LIMITS)
            if watches or one.info.condition in doubts else one
            for one, watches in zip(found, watching, strict=True)
        ]
    found, settings = _budgeted(found, surroundings)
    rows = _rows(found, surroundings)
    missing = any(not row.result.ok for row in rows)
    ours = [row for row in rows if not is_reference(row.info.grid, run.info.metadata)]
    references = [row for row in rows if is_reference(row.info.grid, run.info.metadata)]
    held = under_way(reader.path.parent) is not None
    status = run_status(run.status, held=held, missing=missing)
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
    found: Sequence[Measured], surroundings: SurroundingsOf
) -> tuple[list[Measured], tuple[RepeatedSetting, ...]]:
    """Return the conditions with their budgets, those of a setting that disagrees flagged, and such settings."""
    listed: list[Measured] = []
    settings = SettingsOf()
    for one in found:
        by = surroundings.of(one.info, one.repeats, one.result)
        result = with_budget(one.result, by)
        settings.add(one.info, one.repeats, result, by)
        listed.append(replace(one, result=result))
    repeated = settings.repeated()
    doubts = in_doubt(repeated)
    flagged = [_flagged(one, DISAGREES) if one.info.condition in doubts else one for one in listed]
    return flagged, repeated


def _rows(found: Sequence[Measured], surroundings: SurroundingsOf) -> list[TableRow]:
    """Return the rows of conditions with their budgets; of replicates the value that stands for them, with its own."""
    rows: list[TableRow] = []
    for _, group in groupby(found, key=lambda one: one.info.row):
        replicates = tuple(group)
        if len(replicates) == 1:
            rows.append(TableRow(replicates, replicates[0].result))
            continue
        results = [one.result for one in replicates]
        combined = combine_replicates(results)
        measured = [repeat for one in replicates for repeat in one.repeats]
        by = surroundings.of(replicates[0].info, measured, combined)
        rows.append(TableRow(replicates, with_budget_of_replicates(combined, results, by)))
    return rows


def watch_of(references: Sequence[Measured], surroundings: SurroundingsOf, run: StoredRun) -> ReferenceWatch:
    """Return what the reference conditions of a run say; each with its coefficient at the temperature asked for."""
    in_order = sorted(references, key=lambda one: one.info.condition)
    found: list[Reference] = []
    for number, one in enumerate(in_order, start=1):
        result = with_budget(one.result, surroundings.of(one.info, one.repeats, one.result))
        at = Reduced(one.condition.started_s, result)
        found.append(surroundings.reference(number, one.info, one.repeats, at))
    known = surroundings.known(RESERVED in run.info.metadata)
    return ReferenceWatch(tuple(found), counterface_drift(found, known), control_charts(found, known))


def _flagged(one: Measured, flag: str) -> Measured:
    """Return a condition with one more flag."""
    flags = joined([*flags_in(one.result.flags), flag])
    return replace(one, result=replace(one.result, flags=flags))


def _measured(
    stored: StoredCondition,
    repeats: list[StoredRepeat],
    left_out: dict[tuple[int, int, int], StoredExclusion],
    combining: Combining,
) -> Measured:
    info = stored.info
    by_hand = {i: left_out[one.target] for i, one in enumerate(repeats) if one.target in left_out}
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
