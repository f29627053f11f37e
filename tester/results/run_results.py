"""A run's results as the tables show them: every condition reduced from its committed repeats, in recipe order."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import isfinite

from tester.analysis.flags import DISAGREES, OUT_OF_LIMITS, REFERENCE, THERMOMETER, flags_in, joined
from tester.analysis.left_out import Combining, combining_of
from tester.analysis.measurand import pooled, with_budget, with_budget_of_replicates
from tester.analysis.reference import RESERVED, is_reference
from tester.analysis.reference_watch import ReferenceWatch, doubted
from tester.analysis.repeats import ConditionResult, combine_replicates
from tester.analysis.results import NAN, SoakCheck
from tester.analysis.ring_errors import RingRun
from tester.analysis.schemes import Misalignment, misalignment
from tester.analysis.wear_rate import TOUCH, ConditionWear, WearCheck, WearRate, condition_wear, wear_rate
from tester.base.axes import Axes, surface_of
from tester.base.quantities import Quantities
from tester.results.settings_compared import RepeatedSetting, settings_of
from tester.results.surroundings import SurroundingsOf
from tester.results.table_rows import Measured, TableRow
from tester.store.amend import standing
from tester.store.journal_records import StoredExclusion
from tester.store.records import PieceInfo, StoredCondition, StoredRepeat, StoredRun
from tester.store.run_folders import RunStatus, run_status, under_way
from tester.store.run_reader import RunReader


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
    """Result of the references; None without any."""
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
        installed_mm = next((one.installed_diameter_mm for one in self.pieces if one.piece == piece), NAN)
        return wear_rate([check for check in self.checks if check.piece == piece], installed_mm)

    def condition_wear(self, condition: int) -> ConditionWear | None:
        """Return the wear by a condition; None without checks around it."""
        return condition_wear(self.checks, condition) if self.checks else None

    def wear_lines(self) -> Iterator[str]:
        """Yield the diameter and the wear rate of each piece with checks, or with a rate that touches resolve."""
        for piece in self.pieces:
            checks = [check for check in self.checks if check.piece == piece.piece]
            if not checks:
                continue
            rate = wear_rate(checks, piece.installed_diameter_mm)
            if not rate.resolved and all(check.method == TOUCH for check in checks):
                continue
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
    run, pieces, checks = reader.run(), tuple(reader.pieces()), tuple(reader.wear_checks())
    conditions = _combined(reader, run)
    references = [condition for condition in conditions if _watches(condition, run)]
    surroundings = surroundings_of(reader, run, conditions, pieces, checks)
    watch = None
    if references:
        watch = surroundings.watch(references, reserved=RESERVED in run.info.metadata)
        doubts = _doubted(watch, [condition for condition in conditions if not _watches(condition, run)])
        flags = dict.fromkeys(doubts, OUT_OF_LIMITS) | {c.info.condition: REFERENCE for c in references}
        conditions = [_flagged(c, flags[c.info.condition]) if c.info.condition in flags else c for c in conditions]
    conditions, settings = _budgeted(conditions, surroundings)
    rows = _rows(conditions, surroundings)
    in_use = under_way(reader.path.parent) is not None
    return RunResults(
        run,
        tuple(row for row in rows if not _watches(row, run)),
        run_status(run.status, held=in_use, missing=any(not row.result.ok for row in rows)),
        reader.quantities(),
        pieces,
        checks,
        tuple(row for row in rows if _watches(row, run)),
        watch,
        settings,
        reader.record_head(),
    )


def surroundings_of(
    reader: RunReader,
    run: StoredRun,
    conditions: Sequence[Measured],
    pieces: Sequence[PieceInfo],
    checks: Sequence[WearCheck],
) -> SurroundingsOf:
    """Return the sources of uncertainty of a run's conditions; raises StoreError."""
    pool = pooled([condition.result for condition in conditions])
    ordinary = [(c.info.setpoint, c.result) for c in conditions if not _watches(c, run)]
    return SurroundingsOf(reader, run, pieces, checks, pool, ordinary)


def _doubted(watch: ReferenceWatch, conditions: Sequence[Measured]) -> Iterator[int]:
    """Yield the conditions that the references on their surface leave in doubt."""
    for surface in watch.drifts:
        charts = [chart for chart in watch.charts if chart.surface == surface]
        own = [one.info.condition for one in conditions if surface_of(one.info.setpoint) == surface]
        yield from doubted(charts, own)


def _watches(measured: Measured | TableRow, run: StoredRun) -> bool:
    """Return whether a condition, or a row, is a reference."""
    return is_reference(measured.info.grid, run.info.metadata)


def _combined(reader: RunReader, run: StoredRun) -> list[Measured]:
    """Return the conditions with their repeats combined, flagged where the thermometer was off after the soak."""
    combining, left_out, soaks = combining_of(run.info.metadata), standing(reader.exclusions()), reader.soaks()
    repeats: dict[int, list[StoredRepeat]] = {}
    for repeat in reader.repeats():
        repeats.setdefault(repeat.condition, []).append(repeat)
    conditions: list[Measured] = []
    for stored in reader.conditions():
        number = stored.info.condition
        soak = soaks.get(number)
        measured = _measured(stored, repeats.get(number, []), left_out, combining, soak)
        off = soak is not None and not soak.agrees
        conditions.append(_flagged(measured, THERMOMETER) if off else measured)
    return conditions


def _budgeted(
    conditions: Sequence[Measured], surroundings: SurroundingsOf
) -> tuple[list[Measured], tuple[RepeatedSetting, ...]]:
    """Return the conditions with their budgets, flagged where their setting disagrees, and the repeated settings."""
    by = [surroundings.of(condition.info, condition.repeats, condition.result) for condition in conditions]
    listed = [replace(c, result=with_budget(c.result, sources)) for c, sources in zip(conditions, by, strict=True)]
    repeated = settings_of(zip(listed, by, strict=True))
    doubts = {number for setting in repeated if setting.disagrees for number in setting.conditions}
    return [_flagged(c, DISAGREES) if c.info.condition in doubts else c for c in listed], repeated


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


def _flagged(measured: Measured, flag: str) -> Measured:
    """Return a condition with one more flag."""
    flags = joined([*flags_in(measured.result.flags), flag])
    return replace(measured, result=replace(measured.result, flags=flags))


def _measured(
    stored: StoredCondition,
    repeats: list[StoredRepeat],
    left_out: dict[tuple[int, int, int], StoredExclusion],
    combining: Combining,
    soak: SoakCheck | None,
) -> Measured:
    by_hand = {i: left_out[repeat.target] for i, repeat in enumerate(repeats) if repeat.target in left_out}
    return Measured(stored, tuple(repeats), combined(stored, repeats, by_hand, combining), by_hand, soak)


def combined(
    stored: StoredCondition,
    repeats: Sequence[StoredRepeat],
    by_hand: Mapping[int, StoredExclusion],
    combining: Combining,
) -> ConditionResult:
    """Return a condition's result, without a budget, from its first repeats; ``by_hand``: as of ``Measured``."""
    info = stored.info
    return info.scheme.combine(
        [repeat.result for repeat in repeats],
        planned=info.repeats,
        min_valid=info.min_valid,
        ended=stored.status,
        reason=stored.reason,
        judged=stored.judged,
        by_hand={i: exclusion.reason for i, exclusion in by_hand.items() if i < len(repeats)},
        combining=combining,
    )


@dataclass(frozen=True, slots=True)
class RingPart:
    """A kind's contribution for a machine that reaches a device on a turning part through a slip ring.

    In words: ``title`` its name, ``counted`` the counted requests, ``turns`` the part that
    turns it."""

    title: str
    counted: str
    turns: str
    of: Callable[[RunReader, str], RingRun]
    """Returns the ring's statistics in a run of some name; raises StoreError."""
