"""From repeats to a condition's coefficient, and from replicates on several wheels to a common one.

A repeat is left out automatically only on objective grounds: a gate or the drift test (module ``judge``) made it
invalid, or it fluctuates in excess, by Cochran's C (1 %) and by a variation within its window of more than three times
its siblings' median and of more than 1 %. A value far from the others is flagged and stays: leaving out values that
disagree makes any machine look precise (the closest two of three show a third of the true scatter). Both means are
reported. Repeats that a person leaves out, with the reason on record, are flagged ``excluded``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from math import isfinite, sqrt
from statistics import median
from types import MappingProxyType

from tester.analysis import closest
from tester.analysis.change import LIMIT_PERCENT, change_of, greatest
from tester.analysis.closest import Combining, taken
from tester.analysis.counts import NO_COUNTS, REPEATS, REPLICATES, Counts, make_ups_of
from tester.analysis.directions import BothWays, mean_of_both_ways
from tester.analysis.flags import CHANGED, CLOSEST_TWO, DOUBTS, EXCLUDED, OUTLIER, SHORT, flags_in, joined
from tester.analysis.quantiles import f_quantile, t_quantile
from tester.analysis.reduce import standard_deviation
from tester.analysis.results import (
    NAN,
    NO_MEANS,
    NOT_JUDGED,
    ConditionStatus,
    Judgement,
    RepeatResult,
    RepeatStatus,
    most_swinging,
)
from tester.analysis.uncertainty import CONFIDENCE, NO_BUDGET, STEADY, Budget, Unsteadiness, unsteadiness
from tester.base.quantities import Means, mean_of

COCHRAN_ALPHA = 0.01
"""Level at which ISO 5725-2 calls a variance an outlier."""

EXCESS_FACTOR = 3.0
"""A repeat fluctuates in excess if it varies by more than this times its siblings' median [A] ..."""

EXCESS_PERCENT = 1.0
"""... and by more than this, per cent: on a quiet rig three times next to nothing is nothing [A]."""

BY_HAND = "excluded by hand"
"""Begins the reason of a person's exclusion."""
NOT_CLOSEST = "not one of the closest two of three"
"""Why a valid repeat is in no mean where the recipe combines the paper's way."""

_NOTHING: Mapping[int, str] = MappingProxyType({})

OUTLIER_SIGMAS = 3.5
REPEATABILITY = 0.02
"""Historic standard deviation between repeats as a share of the coefficient [A]."""


@dataclass(frozen=True, slots=True)
class Exclusion:
    """A repeat left out of the mean: its position in the sequence, from 0, and the reason."""

    position: int
    reason: str


@dataclass(frozen=True, slots=True)
class ConditionResult:
    """A condition's coefficient. ``s``: standard deviation between its ``n_valid`` values.

    ``mu`` is the coefficient at the nominal temperature, as are its components ``longitudinal`` and ``lateral`` and
    both budgets. ``mu_resultant``, ``mu_longitudinal`` and ``mu_lateral`` are as measured, at the mean measured
    temperature; ``correction`` leads from these to those.

    ``interval`` is half the 95 % t interval of the mean, ``type_a`` s / sqrt(n). ``budget`` is that of the mounted
    piece in this condition, ``compound_budget`` that of the compound (module ``measurand`` makes both); ``standard``,
    ``coverage`` and ``expanded`` (95 %) are the former's. Drift and its bound (one-sided, 98.75 %; of repeats judged
    alone 95 %) are per window, the trend over the repeats, all per cent of the coefficient (``Judgement``);
    ``unsteady`` is their addition to the budget. ``change_percent`` is the greatest sudden change of level, within a
    repeat or from one to the next, ``swing_percent`` and ``swing_hz`` those of the repeat that swings most
    (``RepeatResult``). ``measured`` has the means over the valid repeats of the averaged channels.
    ``mu_without_flagged`` leaves out flagged outliers.
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
        """Return its component along the sliding."""
        return self.correction * self.mu_longitudinal

    @property
    def lateral(self) -> float:
        """Return its component across the sliding."""
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
    def standard(self) -> float:
        """Return the standard uncertainty of the mounted piece in this condition."""
        return self.budget.standard

    @property
    def coverage(self) -> float:
        """Return its coverage factor, 95 %."""
        return self.budget.coverage

    @property
    def expanded(self) -> float:
        """Return its expanded uncertainty, 95 %."""
        return self.budget.expanded

    @property
    def ok(self) -> bool:
        """Return whether there is a coefficient; ``doubts`` lists reasons for care."""
        return self.status is ConditionStatus.OK

    @property
    def doubts(self) -> tuple[str, ...]:
        """Return the flags that call for care with the value."""
        return tuple(flag for flag in flags_in(self.flags) if flag in DOUBTS)


def cochran_critical(groups: int, df: float, alpha: float = COCHRAN_ALPHA) -> float:
    """Return the critical value of Cochran's C for ``groups`` (>= 2) variances of ``df`` degrees of freedom."""
    f = f_quantile(1.0 - alpha / groups, df, (groups - 1) * df)
    return f / (f + groups - 1.0)


def excess_fluctuation(results: Sequence[RepeatResult]) -> int | None:
    """Return the position of the repeat that fluctuates in excess of its siblings, None if there is none.

    Needs three repeats: of two, neither can be identified as the odd one.
    """
    spreads = [result.fluctuation_percent * result.mu_resultant for result in results]
    df = min((result.batches for result in results), default=0) - 1
    if len(results) < 3 or df < 1 or not all(map(isfinite, spreads)):
        return None
    worst = max(range(len(spreads)), key=spreads.__getitem__)
    total = sum(spread * spread for spread in spreads)
    if total <= 0.0 or spreads[worst] ** 2 / total <= cochran_critical(len(spreads), df):
        return None
    siblings = [result.fluctuation_percent for i, result in enumerate(results) if i != worst]
    limit = max(EXCESS_FACTOR * median(siblings), EXCESS_PERCENT)
    return worst if results[worst].fluctuation_percent > limit else None


def counting(results: Sequence[RepeatResult]) -> list[int]:
    """Return the positions of the repeats that count: valid, and not fluctuating in excess of the others."""
    left_out = {exclusion.position for exclusion in _exclusions(results, _NOTHING)}
    return [i for i in range(len(results)) if i not in left_out]


def _exclusions(results: Sequence[RepeatResult], by_hand: Mapping[int, str]) -> list[Exclusion]:
    excluded = [Exclusion(i, f"{BY_HAND}: {reason}") for i, reason in by_hand.items()]
    excluded += [
        Exclusion(i, f"{result.status.value}{': ' + result.reason if result.reason else ''}")
        for i, result in enumerate(results)
        if not result.valid and i not in by_hand
    ]
    kept = [i for i, result in enumerate(results) if result.valid and i not in by_hand]
    # Excess fluctuation is relative to the siblings, so the test is repeated after each exclusion.
    while True:
        worst = excess_fluctuation([results[i] for i in kept])
        if worst is None:
            return sorted(excluded, key=lambda exclusion: exclusion.position)
        position = kept.pop(worst)
        percent = results[position].fluctuation_percent
        excluded.append(Exclusion(position, f"fluctuates by {percent:.1f} %, in excess of the other repeats"))


def outliers(values: Sequence[float], repeatability: float = REPEATABILITY) -> list[int]:
    """Return the positions of values more than 3.5 historic standard deviations from the median."""
    if len(values) < 3:
        return []
    middle = median(values)
    limit = OUTLIER_SIGMAS * repeatability * abs(middle)
    return [i for i, value in enumerate(values) if abs(value - middle) > limit]


def combine_repeats(
    results: Sequence[RepeatResult],
    planned: int,
    min_valid: int = 3,
    ended: ConditionStatus | None = None,
    reason: str = "",
    *,
    judged: Judgement = NOT_JUDGED,
    by_hand: Mapping[int, str] = _NOTHING,
    repeatability: float = REPEATABILITY,
    combining: Combining = "mean",
    changed_percent: float | None = None,
    counted: str = REPEATS,
) -> ConditionResult:
    """Return a condition's result from its repeats (one result per repeat: its last attempt; none void).

    The recipe requests ``planned`` repeats: where in the end fewer count, the value is flagged ``short``. Valid ones
    that a person left out are not missed, as long as ``min_valid`` remain, the least for a value without that flag.
    Where all repeats were refused for their drift, the value is theirs, flagged. ``ended`` and ``reason`` are the
    status with which the run left the condition (None: it has not), ``judged`` the judgement of its drift. ``by_hand``:
    positions that a person has left out, each with the reason. ``repeatability`` is the historic standard deviation
    between repeats as a share of mu. ``combining``: the mean of all that count, or the paper's way
    (``tester.analysis.closest``). ``changed_percent``: the greatest sudden change, where it is not that between
    ``results`` (pairs of repeats). ``counted``: the unit of ``results``, of ``tester.analysis.counts``.
    """
    refused = {exclusion.position for exclusion in _exclusions(results, _NOTHING)}
    counts = Counts(planned, len(results), make_ups=make_ups_of(planned, len(results), refused), of=counted)
    excluded = _exclusions(results, by_hand)
    left_out = {exclusion.position for exclusion in excluded}
    kept = [i for i in range(len(results)) if i not in left_out]
    if not kept:
        # No repeat is steady: a flagged value is better than none.
        kept = [i for i, result in enumerate(results) if result.drifts and i not in by_hand]
        excluded = [exclusion for exclusion in excluded if exclusion.position not in kept]
    status, why = _condition_status(results, excluded, counts, ended, reason)
    if not kept:
        return ConditionResult(status, why, EXCLUDED if by_hand else "", counts=counts, excluded=tuple(excluded))
    asked = planned - sum(results[i].valid for i in by_hand if i < len(results))
    short = status is ConditionStatus.OK and len(kept) < max(asked, min_valid)
    values = [results[i].mu_resultant for i in kept]
    flagged = outliers(values, repeatability)
    flags = {flag for i in kept for flag in flags_in(results[i].flags)} | set(flags_in(judged.flags))
    used = taken(values, combining)
    fewer = len(used) < len(values)
    if changed_percent is None:
        changed_percent = change_of(with_coefficient(results, by_hand), repeatability)
    changed = abs(changed_percent) > LIMIT_PERCENT
    marks = ((OUTLIER, flagged), (EXCLUDED, by_hand), (SHORT, short), (CLOSEST_TWO, fewer), (CHANGED, changed))
    flags |= {word for word, on in marks if on}
    in_mean = [results[kept[i]] for i in used]
    excluded += [Exclusion(place, NOT_CLOSEST) for i, place in enumerate(kept) if i not in used]
    shell = ConditionResult(
        status=status,
        reason=why,
        flags=joined(flags),
        mu_longitudinal=_mean([result.mu_longitudinal for result in in_mean]),
        mu_lateral=_mean([result.mu_lateral for result in in_mean]),
        counts=replace(counts, valid=len(in_mean)),
        measured=mean_of(result.means for result in in_mean),
        excluded=tuple(sorted(excluded, key=lambda exclusion: exclusion.position)),
        flagged=tuple(kept[i] for i in flagged),
        drift_percent=judged.drift_percent,
        drift_bound_percent=judged.drift_bound_percent,
        trend_percent=judged.trend_percent,
        change_percent=changed_percent,
    )
    shell = replace(shell, unsteady=unsteadiness(judged))
    swings = most_swinging(results[i] for i in kept)
    shell = replace(shell, swing_percent=swings.swing_percent, swing_hz=swings.swing_hz)
    return _with_statistics(shell, values, flagged, used)


def with_coefficient(results: Sequence[RepeatResult], by_hand: Mapping[int, str] = _NOTHING) -> list[RepeatResult]:
    """Return the repeats that show friction: those that count, and those refused for their drift."""
    return [result for i, result in enumerate(results) if (result.valid or result.drifts) and i not in by_hand]


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
        mu_longitudinal=_mean([result.mu_longitudinal for result in kept]),
        mu_lateral=_mean([result.mu_lateral for result in kept]),
        counts=counts,
        measured=mean_of(result.measured for result in kept),
        # Wheels run in alike: a drift on one appears on the others, in the same direction.
        unsteady=Unsteadiness(*(_mean(values) for values in zip(*(astuple(r.unsteady) for r in kept), strict=True))),
        both_ways=_both_ways(kept),
        change_percent=greatest(result.change_percent for result in kept),
    )
    swings = most_swinging(kept)
    shell = replace(shell, swing_percent=swings.swing_percent, swing_hz=swings.swing_hz)
    return _with_statistics(shell, [result.mu_resultant for result in kept], [])


def _both_ways(kept: Sequence[ConditionResult]) -> BothWays | None:
    both = [condition_result.both_ways for condition_result in kept if condition_result.both_ways is not None]
    return mean_of_both_ways(both) if both and len(both) == len(kept) else None


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values)


def _with_statistics(
    shell: ConditionResult, values: Sequence[float], flagged: Sequence[int], used: Sequence[int] | None = None
) -> ConditionResult:
    """Return ``shell`` with mean and scatter of ``values``; a single value shows no scatter.

    ``used``: positions of those in the mean, where not all are; the scatter is that of all.
    """
    n = len(values)
    used = range(n) if used is None else used
    mu, s = _mean([values[i] for i in used]), standard_deviation(values)
    type_a = s / sqrt(n) if len(used) == n else s * closest.STANDARD
    others = [value for i, value in enumerate(values) if i not in flagged]
    df = float(max(n - 1, 1))
    return replace(
        shell,
        mu_resultant=mu,
        mu_without_flagged=_mean(others) if others else NAN,
        s=s,
        n_valid=n,
        interval=t_quantile(0.5 + 0.5 * CONFIDENCE, df) * type_a,
        type_a=type_a,
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
