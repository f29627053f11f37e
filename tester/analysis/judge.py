"""A condition's repeats judged together: refusals, steadiness of the coefficient, carry-over.

Make-up repeats must not hide a run-in: a coefficient that settles during the measurement loses its first repeats to the
drift test, and the rest look steady at a value that depends on when it was measured. The condition is flagged
``carry-over`` in three cases: two or more repeats were refused for drift of the same sign, or the first repeat was,
where a run-in is strongest; the means fall or rise with the sliding distance, or the drift itself decays along it (both
at 1 %); or the remaining repeats drift in the direction of the refused ones (5 %). The tests of the trend use all
repeats, including refused ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import inf, isfinite, sqrt

from tester.analysis.blocks import Block
from tester.analysis.drift import CONFIDENCE, LOOK_CONFIDENCE, Drift, fit_drift, refusals
from tester.analysis.flags import CARRY_OVER, NOT_SHOWN, flags_in, joined
from tester.analysis.left_out import REPEATABILITY, counting
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN, NOT_JUDGED, Judgement, RepeatResult, RepeatStatus
from tester.analysis.stability import Window, centred, seconds_of
from tester.base.quantities import temperatures

ALONE = 2
"""Up to this many repeats are judged separately: there is nothing to pool."""

TREND_LEVEL = 0.01
"""Level of the tests for a trend over the repeats."""
HISTORY_DF = 8.0
"""Weight of the historic standard deviation between repeats beside the condition's own, degrees of freedom [A]."""
LEAST_CHANGE_PERCENT = 1.0
"""A drift dies away where it changes by more than this over the repeats, per cent a window [A]: half the limit."""

_LEAST_FOR_TREND = 3


def judge(
    results: Sequence[RepeatResult],
    blocks: Sequence[Sequence[Block]],
    planned: int,
    window: Window,
) -> tuple[list[RepeatResult], Judgement]:
    """Return a condition's repeats as judged, and the judgement on all of them.

    ``results`` are its committed repeats in order, ``blocks`` the valid blocks of each (not needed for an invalid
    repeat). The recipe requests ``planned`` repeats, each of one ``window`` or more. Valid repeats are judged; their
    drift and bound are then those of the common fit.
    """
    judged = list(results)
    valid = [i for i, result in enumerate(results) if result.valid]
    if any("rolling" in flags_in(results[i].flags) for i in valid):
        return judged, NOT_JUDGED
    # Without siblings there is nothing to pool.
    if planned <= ALONE and valid:
        return judged, _each_alone([results[i] for i in valid], [blocks[i] for i in valid], window)
    # Drift first: a drifting repeat also fluctuates, and the reason must be the drift.
    drift = _refuse(judged, valid, blocks, window)
    kept = counting(judged)
    if any(judged[i].valid and i not in kept for i in valid):
        drift = _refuse(judged, kept, blocks, window)
        kept = counting(judged)
    if not kept:
        return judged, _left_with_refused(judged, blocks, window)
    return judged, _judgement(judged, drift, [blocks[i] for i in kept], window)


def _refuse(
    judged: list[RepeatResult],
    positions: Sequence[int],
    blocks: Sequence[Sequence[Block]],
    window: Window,
) -> Drift:
    """Write the drift of the repeats at ``positions`` into ``judged`` and refuse those that drift.

    Return the fit.
    """
    drift, refused = refusals([blocks[i] for i in positions], window)
    singles = iter(drift.repeats)
    for position, index in enumerate(positions):
        own_drift = refused[position] if position in refused else next(singles, None)
        if own_drift is None:
            continue  # too little was measured for a fit: its drift is unknown
        judged[index] = replace(
            judged[index], drift_percent=own_drift.drift_percent, bound_percent=own_drift.bound_percent
        )
        if position in refused:
            judged[index] = replace(judged[index], status=RepeatStatus.REFUSED, reason=own_drift.reason)
    return drift


def _judgement(
    results: Sequence[RepeatResult],
    drift: Drift,
    blocks: Sequence[Sequence[Block]],
    window: Window,
) -> Judgement:
    trend, carries = trend_of(results, drift.per_kelvin_percent)
    carries |= _go_the_same_way(results, drift)
    flags = [word for word, on in ((NOT_SHOWN, not drift.stable), (CARRY_OVER, carries)) if on]
    return Judgement(
        drift_percent=drift.drift_percent,
        drift_error_percent=drift.error_percent,
        drift_bound_percent=drift.bound_percent,
        per_kelvin_percent=drift.per_kelvin_percent,
        repeat_windows=_windows(blocks, window),
        trend_percent=trend,
        flags=joined(flags),
    )


def _go_the_same_way(results: Sequence[RepeatResult], drift: Drift) -> bool:
    """Return whether the refused repeats indicate a run-in: the first is among them, or the others drift as well.

    A run-in is strongest in the first repeat; where only later ones were refused, the drift of the others must be
    significant and of the same sign.
    """
    if (first := next((r for r in results if r.valid or r.drifts), None)) is not None and first.drifts:
        return True
    refused = [r.drift_percent * drift.drift_percent > 0.0 for r in results if r.drifts]
    return drift.shown and bool(refused) and all(refused)


def _left_with_refused(
    results: Sequence[RepeatResult],
    blocks: Sequence[Sequence[Block]],
    window: Window,
) -> Judgement:
    """Return the judgement where no repeat is left: that of all repeats refused for drift."""
    drifting = [i for i, result in enumerate(results) if result.drifts and blocks[i]]
    if not drifting:
        return NOT_JUDGED
    left = [blocks[i] for i in drifting]
    drift = fit_drift(left, window, LOOK_CONFIDENCE)
    judgement = _judgement(results, drift, left, window)
    return replace(judgement, flags=joined([NOT_SHOWN, *flags_in(judgement.flags)]))


def _each_alone(
    results: Sequence[RepeatResult],
    blocks: Sequence[Sequence[Block]],
    window: Window,
) -> Judgement:
    """Return the judgement of repeats without siblings: that of the worst."""
    drift = max((fit_drift([block], window) for block in blocks), key=_bound)
    flags = [NOT_SHOWN] if any(NOT_SHOWN in flags_in(result.flags) for result in results) else []
    windows = _windows(blocks, window)
    return Judgement(
        drift.drift_percent, drift.error_percent, drift.bound_percent, drift.per_kelvin_percent, windows,
        flags=joined(flags),
    )  # fmt: skip


def _bound(drift: Drift) -> float:
    return drift.bound_percent if isfinite(drift.bound_percent) else inf


def _windows(blocks: Sequence[Sequence[Block]], window: Window) -> float:
    """Return the mean number of windows that a repeat collected."""
    if window.revolutions is not None:
        return sum(len(repeat) for repeat in blocks) / (window.revolutions * len(blocks))
    return sum(seconds_of(repeat) for repeat in blocks) / (window.seconds * len(blocks)) if window.seconds else 1.0


def trend_of(results: Sequence[RepeatResult], per_kelvin_percent: float) -> tuple[float, bool]:
    """Return the change of the coefficient from first repeat to last, per cent, and whether it carries over.

    ``results``: all committed repeats in order; of those without a value only the sliding distance counts.
    """
    middles: list[float] = []
    slid = 0.0
    for result in results:
        distance = abs(result.means.sliding) * result.window_s
        distance = distance if isfinite(distance) and distance > 0.0 else 1.0
        middles.append(slid + 0.5 * distance)
        slid += distance
    seen = [i for i, result in enumerate(results) if result.valid or result.drifts]
    signs = [results[i].drift_percent > 0.0 for i in seen if results[i].drifts]
    carries = max(signs.count(True), signs.count(False)) >= 2
    if len(seen) < 2:
        return NAN, carries
    x = centred([middles[i] for i in seen])
    span = x[-1] - x[0]
    kelvin = per_kelvin_percent if isfinite(per_kelvin_percent) else 0.0
    off_k = centred(temperatures(results[i].means for i in seen))
    values = [results[i].mu_resultant * (1.0 - 0.01 * kelvin * k) for i, k in zip(seen, off_k, strict=True)]
    mean = sum(values) / len(values)
    y = [100.0 * (value / mean - 1.0) for value in values]
    per_m = sum(a * b for a, b in zip(x, y, strict=True)) / sum(a * a for a in x)
    if len(seen) >= _LEAST_FOR_TREND:
        rest = sum((b - per_m * a) ** 2 for a, b in zip(x, y, strict=True))
        df = len(seen) - 2 + HISTORY_DF
        s = sqrt((rest + HISTORY_DF * (100.0 * REPEATABILITY) ** 2) / df)
        error = s / sqrt(sum(a * a for a in x))
        # One-sided where the drift within the repeats goes the same way.
        drifts = [results[i].drift_percent for i in seen if isfinite(results[i].drift_percent)]
        sides = 1.0 if sum(drifts) * per_m > 0.0 else 2.0
        carries |= abs(per_m) > t_quantile(1.0 - TREND_LEVEL / sides, df) * error
        carries |= _dies_away(x, [results[i] for i in seen])
    return per_m * span, carries


def _dies_away(x: Sequence[float], results: Sequence[RepeatResult]) -> bool:
    """Return whether the drift decreases significantly from repeat to repeat."""
    drifts = [result.drift_percent for result in results]
    if not all(map(isfinite, drifts)):
        return False
    t = t_quantile(CONFIDENCE, inf)
    errors = [(result.bound_percent - abs(result.drift_percent)) / t for result in results]
    squares = sum(a * a for a in x)
    mean = sum(drifts) / len(drifts)
    per_m = sum(a * b for a, b in zip(x, drifts, strict=True)) / squares
    # Scatter about the line counts as well: a single odd repeat among steady ones is no drift that dies away.
    rest = sum((d - mean - per_m * a) ** 2 for a, d in zip(x, drifts, strict=True)) / max(len(x) - 2, 1)
    error = sqrt(sum(a * a * max(e * e, rest) for a, e in zip(x, errors, strict=True))) / squares
    first, last = mean + per_m * x[0], mean + per_m * x[-1]
    if abs(first) <= abs(last) or abs(last - first) <= LEAST_CHANGE_PERCENT:
        return False
    return abs(per_m) > t_quantile(1.0 - 0.5 * TREND_LEVEL, inf) * error
