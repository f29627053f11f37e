"""From repeats to a condition's coefficient, and from replicates on several wheels to a common one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from math import sqrt

from tester.analysis.change import LIMIT_PERCENT, change_of, greatest
from tester.analysis.directions import BothWays, mean_of_both_ways
from tester.analysis.flags import CHANGED, CLOSEST_TWO, DOUBTS, EXCLUDED, OUTLIER, SHORT, flags_in, joined
from tester.analysis.left_out import (
    CLOSEST_STANDARD,
    NO_COUNTS,
    NONE_BY_HAND,
    NOT_CLOSEST,
    REPEATS,
    REPLICATES,
    Combining,
    Counts,
    Exclusion,
    exclusions,
    make_ups_of,
    outliers,
    taken,
)
from tester.analysis.quantiles import t_quantile
from tester.analysis.reduce import standard_deviation
from tester.analysis.results import (
    NAN,
    NO_MEANS,
    NOT_JUDGED,
    ConditionStatus,
    Judgement,
    RepeatResult,
    RepeatStatus,
    greatest_swing,
)
from tester.analysis.uncertainty import CONFIDENCE, NO_BUDGET, STEADY, Budget, Unsteadiness, unsteadiness
from tester.base.quantities import Means, mean_of


@dataclass(frozen=True, slots=True)
class ConditionResult:
    """A condition's coefficient. ``s``: standard deviation between its ``n_valid`` values.

    ``mu`` is the coefficient at the nominal temperature, as are its components ``longitudinal`` and ``lateral`` and
    both budgets. ``mu_resultant``, ``mu_longitudinal`` and ``mu_lateral`` are as measured, at the mean measured
    temperature; ``correction`` converts the latter to the former.

    ``interval`` is half the 95 % t interval of the mean, ``type_a`` s / sqrt(n). ``budget`` is that of the mounted
    piece in this condition, ``compound_budget`` that of the compound (module ``measurand`` makes both).

    Drift and its bound (one-sided, 98.75 %; of repeats judged alone 95 %) are per window, the trend over the repeats,
    all per cent of the coefficient (``Judgement``); ``unsteady``: their contribution to the budget. ``change_percent``
    is the greatest sudden change of level, within a repeat or from one to the next, ``swing_percent`` and ``swing_hz``
    those of the repeat that swings most (``RepeatResult``). ``measured`` has the means over the valid repeats of the
    averaged channels. ``mu_without_flagged`` leaves out flagged outliers.
    """

    status: ConditionStatus
    reason: str = ""
    flags: str = ""
    mu_resultant: float = NAN
    mu_longitudinal: float = NAN
    mu_lateral: float = NAN
    mu_without_flagged: float = NAN
    s: float = NAN
    n_valid: int = 0
    counts: Counts = NO_COUNTS
    interval: float = NAN
    type_a: float = NAN
    measured: Means = NO_MEANS
    excluded: tuple[Exclusion, ...] = ()
    flagged: tuple[int, ...] = ()
    drift_percent: float = NAN
    drift_bound_percent: float = NAN
    trend_percent: float = NAN
    change_percent: float = NAN
    swing_percent: float = NAN
    swing_hz: float = NAN
    unsteady: Unsteadiness = STEADY
    correction: float = 1.0
    """The coefficient at the nominal temperature, over that as measured; 1 without a correction."""
    budget: Budget = NO_BUDGET
    compound_budget: Budget = NO_BUDGET
    both_ways: BothWays | None = None
    """Result of each direction of sliding, where both were measured; values are then those of pairs."""

    @property
    def mu(self) -> float:
        """Return the coefficient at the nominal temperature: the one that every output calls mu."""
        return self.correction * self.mu_resultant

    @property
    def longitudinal(self) -> float:
        """Return the coefficient's component along the direction of sliding."""
        return self.correction * self.mu_longitudinal

    @property
    def lateral(self) -> float:
        """Return the coefficient's component across the direction of sliding."""
        return self.correction * self.mu_lateral

    @property
    def without_flagged(self) -> float:
        """Return the coefficient without outliers."""
        return self.correction * self.mu_without_flagged

    @property
    def repeats_each(self) -> int:
        """Return the number of repeats behind each of its values."""
        return 1 if self.both_ways is None else 2

    @property
    def ok(self) -> bool:
        """Return whether there is a coefficient; ``doubts`` lists reasons for care."""
        return self.status is ConditionStatus.OK

    @property
    def doubts(self) -> tuple[str, ...]:
        """Return the flags that call for care with the value."""
        return tuple(flag for flag in flags_in(self.flags) if flag in DOUBTS)


def combine_repeats(
    results: Sequence[RepeatResult],
    planned: int,
    min_valid: int = 3,
    ended: ConditionStatus | None = None,
    reason: str = "",
    *,
    judged: Judgement = NOT_JUDGED,
    by_hand: Mapping[int, str] = NONE_BY_HAND,
    combining: Combining = "mean",
    changed_percent: float | None = None,
    counted: str = REPEATS,
) -> ConditionResult:
    """Return a condition's result from its repeats (one result per repeat: its last attempt; none void).

    The recipe requests ``planned`` repeats: if fewer count at the end, the value is flagged ``short``. Valid repeats
    that a person left out cause no flag while at least ``min_valid`` remain. Where all repeats were refused for their
    drift, their value is used and flagged. ``ended`` and ``reason`` are the status with which the run left the
    condition (None: it has not left it), ``judged`` the judgement of its drift. ``by_hand``: positions that a person
    has left out, each with the reason. ``combining``: the mean of all that count, or the paper's way.
    ``changed_percent``: the greatest sudden change, where it is not computed from ``results`` (pairs of repeats).
    ``counted``: the unit of ``results``, from ``tester.analysis.left_out``.
    """
    kept, excluded = _kept(results, by_hand)
    refused = {exclusion.position for exclusion in exclusions(results)}
    counts = Counts(planned, len(results), make_ups=make_ups_of(planned, len(results), refused), of=counted)
    if changed_percent is None:
        changed_percent = change_of(results, by_hand)
    status, why = _condition_status(results, excluded, counts, ended, reason)
    if not kept:
        return ConditionResult(status, why, EXCLUDED if by_hand else "", counts=counts, excluded=tuple(excluded))
    shell = ConditionResult(status, why, counts=counts, excluded=tuple(excluded), change_percent=changed_percent)
    result = _of_kept(shell, results, kept, judged, combining)
    asked = planned - sum(results[i].valid for i in by_hand if i < len(results))
    short = result.ok and len(kept) < max(asked, min_valid)
    marks = ((EXCLUDED, by_hand), (SHORT, short), (CHANGED, abs(changed_percent) > LIMIT_PERCENT))
    return replace(result, flags=joined([*flags_in(result.flags), *(word for word, on in marks if on)]))


def _kept(results: Sequence[RepeatResult], by_hand: Mapping[int, str]) -> tuple[list[int], list[Exclusion]]:
    """Return the positions of the repeats with a value for the condition, and the others."""
    excluded = exclusions(results, by_hand)
    left_out = {exclusion.position for exclusion in excluded}
    kept = [i for i in range(len(results)) if i not in left_out]
    if not kept:
        # No repeat is steady: a flagged value is better than none.
        kept = [i for i, result in enumerate(results) if result.drifts and i not in by_hand]
        excluded = [exclusion for exclusion in excluded if exclusion.position not in kept]
    return kept, excluded


def _of_kept(
    shell: ConditionResult,
    results: Sequence[RepeatResult],
    kept: Sequence[int],
    judged: Judgement,
    combining: Combining,
) -> ConditionResult:
    """Return ``shell`` with the mean of the repeats at the positions ``kept``, their flags and their drift."""
    repeats = [results[i] for i in kept]
    values = [repeat.mu_resultant for repeat in repeats]
    flagged, used = outliers(values), taken(values, combining)
    not_taken = [Exclusion(place, NOT_CLOSEST) for i, place in enumerate(kept) if i not in used]
    marks = ((OUTLIER, flagged), (CLOSEST_TWO, not_taken))
    flags = [flag for text in (judged.flags, *(repeat.flags for repeat in repeats)) for flag in flags_in(text)]
    shell = replace(
        shell,
        flags=joined([*flags, *(word for word, on in marks if on)]),
        counts=replace(shell.counts, valid=len(used)),
        measured=mean_of(repeats[i].means for i in used),
        excluded=tuple(sorted([*shell.excluded, *not_taken], key=lambda exclusion: exclusion.position)),
        flagged=tuple(kept[i] for i in flagged),
        drift_percent=judged.drift_percent,
        drift_bound_percent=judged.drift_bound_percent,
        trend_percent=judged.trend_percent,
        unsteady=unsteadiness(judged),
    )
    return _with_mean(shell, repeats, flagged, used)


def combine_replicates(results: Sequence[ConditionResult]) -> ConditionResult:
    """Return a common result for a condition measured on several wheels, from the results of the wheels.

    The wheels' means have equal weight; ``s`` is the deviation between wheels. OK needs two wheels that are OK.
    """
    kept = [result for result in results if result.ok]
    missing = [f"replicate {i}: {result.status.value}" for i, result in enumerate(results, 1) if not result.ok]
    reason = "; ".join(missing)
    if len(kept) >= 2:
        status = ConditionStatus.OK
    elif any(result.status is ConditionStatus.PENDING for result in results):
        status = ConditionStatus.PENDING
    else:
        status = ConditionStatus.INSUFFICIENT
    tried = sum(bool(result.counts.made) or result.status is not ConditionStatus.PENDING for result in results)
    counts = Counts(len(results), tried, len(kept), of=REPLICATES)
    if not kept:
        return ConditionResult(status, reason, counts=counts)
    shell = ConditionResult(
        status=status,
        reason=reason,
        flags=joined(flag for result in kept for flag in flags_in(result.flags)),
        counts=counts,
        measured=mean_of(result.measured for result in kept),
        # Wheels run in alike: a drift on one appears on the others, in the same direction.
        unsteady=Unsteadiness(*(_mean(values) for values in zip(*(astuple(r.unsteady) for r in kept), strict=True))),
        both_ways=_both_ways(kept),
        change_percent=greatest(result.change_percent for result in kept),
    )
    return _with_mean(shell, kept)


def _both_ways(kept: Sequence[ConditionResult]) -> BothWays | None:
    both = [condition_result.both_ways for condition_result in kept if condition_result.both_ways is not None]
    return mean_of_both_ways(both) if both and len(both) == len(kept) else None


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _with_mean(
    shell: ConditionResult,
    items: Sequence[RepeatResult] | Sequence[ConditionResult],
    flagged: Sequence[int] = (),
    used: Sequence[int] | None = None,
) -> ConditionResult:
    """Return ``shell`` with mean and scatter of ``items``, and their greatest swing; a single item shows no scatter.

    ``used``: positions of the items in the mean, if some are left out; the scatter is that of all items. ``flagged``:
    positions of outliers.
    """
    values, n = [item.mu_resultant for item in items], len(items)
    used = range(n) if used is None else used
    s = standard_deviation(values)
    type_a = s / sqrt(n) if len(used) == n else s * CLOSEST_STANDARD
    others = [value for i, value in enumerate(values) if i not in flagged]
    swing_percent, swing_hz = greatest_swing((item.swing_percent, item.swing_hz) for item in items)
    return replace(
        shell,
        mu_resultant=_mean([values[i] for i in used]),
        mu_longitudinal=_mean([items[i].mu_longitudinal for i in used]),
        mu_lateral=_mean([items[i].mu_lateral for i in used]),
        mu_without_flagged=_mean(others) if others else NAN,
        s=s,
        n_valid=n,
        interval=t_quantile(0.5 + 0.5 * CONFIDENCE, float(max(n - 1, 1))) * type_a,
        type_a=type_a,
        swing_percent=swing_percent,
        swing_hz=swing_hz,
    )


def _condition_status(
    results: Sequence[RepeatResult],
    excluded: Sequence[Exclusion],
    counts: Counts,
    ended: ConditionStatus | None,
    reason: str,
) -> tuple[ConditionStatus, str]:
    n_valid = len(results) - len(excluded)
    if ended is None and counts.made < counts.asked:
        return ConditionStatus.PENDING, f"{counts.made} of {counts.asked} {counts.of} committed"
    if n_valid > 0:
        return ConditionStatus.OK, reason
    if ended not in (None, ConditionStatus.OK, ConditionStatus.PENDING, ConditionStatus.INSUFFICIENT):
        return ended, reason
    for repeat_status, status in (
        (RepeatStatus.CANNOT_HOLD, ConditionStatus.CANNOT_HOLD),
        (RepeatStatus.NOT_REACHED, ConditionStatus.NOT_REACHED),
    ):
        reasons = [result.reason for result in results if result.status is repeat_status]
        if reasons and len(reasons) == len(results):
            return status, reason or reasons[0]
    causes = "; ".join(f"{counts.of.removesuffix('s')} {e.position + 1} {e.reason}" for e in excluded)
    counted = f"none of {len(results)} {counts.of} is valid"
    return ConditionStatus.INSUFFICIENT, f"{counted}: {causes}" if causes else counted
