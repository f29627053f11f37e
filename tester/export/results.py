"""A run's results as the tables show them: every condition reduced from its committed repeats, in recipe order."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import groupby
from math import isfinite

from tester.analysis.closest import Combining, combining_of
from tester.analysis.measurand import pooled, with_budget, with_budget_of_replicates
from tester.analysis.misalignment import Misalignment, misalignment
from tester.analysis.repeats import ConditionResult, combine_replicates
from tester.analysis.results import CARRY_OVER, IMPRECISE, NOT_SHOWN, SHORT, ConditionStatus
from tester.analysis.wear import ConditionWear, WearRate, condition_wear, wear_rate
from tester.analysis.wear_check import WearCheck
from tester.axes import Axes, condition_words
from tester.export.surroundings import SurroundingsOf
from tester.quantities import Quantities
from tester.store import older
from tester.store.catalogue import under_way
from tester.store.exclusions import standing
from tester.store.reader import RunReader
from tester.store.records import ConditionInfo, PieceInfo, StoredCondition, StoredExclusion, StoredRepeat, StoredRun
from tester.store.status import RunStatus, run_status


@dataclass(frozen=True, slots=True)
class Measured:
    """One condition of the plan with its repeats and what they give."""

    condition: StoredCondition
    repeats: tuple[StoredRepeat, ...]
    result: ConditionResult
    by_hand: Mapping[int, StoredExclusion]
    """What a person has left out, by its position in ``repeats``."""

    @property
    def info(self) -> ConditionInfo:
        """Return the condition's setpoints."""
        return self.condition.info

    def exclusion(self, repeat: StoredRepeat) -> str:
        """Return why a repeat is not in the mean, an empty text if it is."""
        position = self.repeats.index(repeat)
        return next((e.reason for e in self.result.excluded if e.position == position), "")

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


_WHAT_TO_DO: Mapping[ConditionStatus, str] = {
    ConditionStatus.CANNOT_HOLD: "a wider temperature_band, a lower load or a lower speed would help",
    ConditionStatus.NOT_REACHED: "check heating and cooling, or allow more time (soak.at_most)",
    ConditionStatus.INSUFFICIENT: "a wider temperature_band or more max_bursts would help",
    ConditionStatus.PENDING: "tester resume goes on with the run",
}
_WHAT_OF_FLAGS: Mapping[str, str] = {
    CARRY_OVER: "the rubber was still running in: grind it longer before (pre_grind), then measure the condition again",
    NOT_SHOWN: "allow more repeats (repeats: at_most), or look for what drifts",
    SHORT: "allow more repeats (repeats: at_most)",
    IMPRECISE: "allow more repeats (repeats: at_most), or ask for less (until)",
}


def remedy(result: ConditionResult) -> str:
    """Return what to do about a condition without a value, or with one to be taken with care; "" where nothing is."""
    if not result.ok:
        return _WHAT_TO_DO.get(result.status, "")
    return next((text for flag, text in _WHAT_OF_FLAGS.items() if flag in result.doubts), "")


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
    record_head: str = ""
    """The last head of the record's chain, hexadecimal; "" where an older version recorded without one."""

    @property
    def axes(self) -> Axes:
        """Return the axes of the run's conditions."""
        return self.run.info.axes or older.AXES

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

    def conditions(self) -> Iterator[Measured]:
        """Yield the conditions, in recipe order, replicates one after the other."""
        for row in self.rows:
            yield from row.replicates

    def doubtful(self) -> list[TableRow]:
        """Return the rows whose value is to be taken with care."""
        return [row for row in self.rows if row.result.ok and row.result.doubts]

    def missing(self) -> list[TableRow]:
        """Return the rows without a value that can be trusted."""
        return [row for row in self.rows if not row.result.ok]


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
    pieces, checks = tuple(reader.pieces()), tuple(reader.wear_checks())
    surroundings = SurroundingsOf(reader, run, pieces, checks, pooled([one.result for one in found]))
    for one in found:
        surroundings.add(one.info.setpoint, one.result)
    rows: list[TableRow] = []
    for _, group in groupby(found, key=lambda one: one.info.row):
        replicates = tuple(
            replace(one, result=with_budget(one.result, surroundings.of(one.info, one.repeats, one.result)))
            for one in group
        )
        if len(replicates) == 1:
            rows.append(TableRow(replicates, replicates[0].result))
            continue
        results = [one.result for one in replicates]
        combined = combine_replicates(results)
        measured = [repeat for one in replicates for repeat in one.repeats]
        by = surroundings.of(replicates[0].info, measured, combined)
        rows.append(TableRow(replicates, with_budget_of_replicates(combined, results, by)))
    missing = any(not row.result.ok for row in rows)
    held = under_way(reader.path.parent) is not None
    status = run_status(run.status, held=held, missing=missing)
    return RunResults(run, tuple(rows), status, reader.quantities(), pieces, checks, reader.record_head())


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
