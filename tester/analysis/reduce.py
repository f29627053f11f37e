"""From the blocks of a repeat to one coefficient.

mu is a ratio of means, which noise of the forces does not bias (a mean of ratios is biased by noise of Fz):

  longitudinal = mean(Fx) / mean(Fz)    lateral = mean(Fy) / mean(Fz)    resultant = hypot of the two

with Fx along the sliding, Fy across it and the measured load Fz (``tester.base.quantities.Roles``), over the whole
revolutions that remain after truncation, each of equal weight. The recorded samples are net of the tare. The paper's
tabulated coefficient is the resultant.

The uncertainty comes from 10 batch means: consecutive revolutions correlate, so s / sqrt(n) of raw samples covers 33 %
of cases instead of 95 %. The blocks' own standard error, with allowance for their correlation, replaces it where that
is larger (AR(1) noise of 1 % and 0.3 s).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from math import isfinite, isnan, sqrt

from tester.analysis.blocks import Block, BlockCounter, resultant
from tester.analysis.change import change_within
from tester.analysis.drift import Drift, fit_drift
from tester.analysis.flags import EXTENDED, NOT_SHOWN, ROLLING, STICK_SLIP, STICK_SLIP_UNKNOWN, TRUNCATED, joined
from tester.analysis.results import NAN, Burst, RepeatResult, RepeatStatus, Swing
from tester.analysis.stability import ANY_LENGTH, Window, enough, filled, left_out, seconds_of
from tester.analysis.swing import LIMIT_PERCENT
from tester.base.quantities import mean_of

BATCHES = 10
"""Number of batch means per repeat."""


def batch_means(blocks: Sequence[Block]) -> list[float]:
    """Return the resultant coefficients of up to 10 consecutive batches, of as equal length as possible."""
    n = len(blocks)
    count = min(BATCHES, n)
    edges = [i * n // count for i in range(count + 1)]
    return [_resultant(blocks[a:b]) for a, b in pairwise(edges)]


def _resultant(blocks: Sequence[Block]) -> float:
    means = mean_of(block.means for block in blocks)
    return resultant(means.along, means.across, means.normal)


def standard_deviation(values: Sequence[float]) -> float:
    """Return the sample standard deviation (n - 1) of at least two values, NaN for fewer."""
    n = len(values)
    if n < 2:
        return NAN
    mean = sum(values) / n
    return sqrt(sum((value - mean) ** 2 for value in values) / (n - 1))


def bursts_of(blocks: Sequence[Block]) -> list[Burst]:
    """Return one record for every burst with at least one whole revolution, in order."""
    bursts: list[Burst] = []
    first = 0
    for end in range(1, len(blocks) + 1):
        if end == len(blocks) or blocks[end].burst != blocks[first].burst:
            a, b = blocks[first], blocks[end - 1]
            bursts.append(Burst(a.burst, end - first, a.started_s, b.ended_s, a.means.temperature, b.means.temperature))
            first = end
    return bursts


def without_value(status: RepeatStatus, reason: str, started_s: float = NAN, ended_s: float = NAN) -> RepeatResult:
    """Return the result of a repeat without a coefficient, with the reason for people; rig seconds."""
    return RepeatResult(status=status, reason=reason, started_s=started_s, ended_s=ended_s)


def counted(blocks: Sequence[Block], window: Window) -> Sequence[Block]:
    """Return the blocks of a repeat that count: those after the transient at its beginning."""
    return blocks[left_out(blocks, window) :]


def reduce_repeat(
    blocks: Sequence[Block],
    window: Window = ANY_LENGTH,
    *,
    rolling: bool = False,
    alone: bool = False,
    swing: Swing | None = None,
) -> RepeatResult:
    """Return a repeat's result from its blocks, in order of time.

    ``rolling`` marks a condition of 0 mm/s. Its drift is not judged: the coefficient is rolling resistance, close to 0.
    ``alone``: the repeat has no siblings for a judgement, so a drift not shown to be small is flagged here. ``swing``:
    the swing of friction within a revolution; None where it was not analysed. Status: VALID, TOO_FEW when the window is
    not full, REFUSED without a coefficient; the last two keep their figures.
    """
    if not blocks:
        return without_value(RepeatStatus.TOO_FEW, "not one whole accepted revolution")
    used = counted(blocks, window)
    drift = fit_drift([used], window)
    result = _averaged(blocks, used, drift)
    status, reason = _status(blocks, used, window)
    if not isfinite(result.mu_resultant) or not (result.mu_resultant > 0.0 or rolling):
        status, reason = RepeatStatus.REFUSED, "coefficient without a value"
    flags = _flags(blocks, used, window)
    result = replace(result, status=status, reason=reason)
    if rolling:
        return replace(result, flags=joined([ROLLING, *flags]))
    if alone and not drift.stable:
        flags.append(NOT_SHOWN)
    if swing is not None:
        flags += _swing_flags(swing)
        result = replace(result, swing_percent=swing.percent, swing_hz=swing.hz, swing_skewness=swing.skewness)
    return replace(
        result,
        flags=joined(flags),
        drift_percent=drift.drift_percent,
        bound_percent=drift.bound_percent,
        change_percent=change_within(blocks),
    )


def _averaged(blocks: Sequence[Block], used: Sequence[Block], drift: Drift) -> RepeatResult:
    """Return a repeat's coefficient from the blocks that count (``used``), with its uncertainty and their number."""
    means = mean_of(block.means for block in used)
    batches = batch_means(used)
    mu, load = _resultant(used), means.normal
    return RepeatResult(
        status=RepeatStatus.VALID,
        mu_resultant=mu,
        mu_longitudinal=means.along / load if load > 0.0 else NAN,
        mu_lateral=means.across / load if load > 0.0 else NAN,
        uncertainty=_uncertainty(used, batches, drift),
        fluctuation_percent=100.0 * standard_deviation(batches) / mu if mu > 0.0 else NAN,
        batches=len(batches),
        revolutions=len(used),
        truncated=len(blocks) - len(used),
        window_s=seconds_of(used),
        bursts=len(bursts_of(used)),
        started_s=blocks[0].started_s,
        ended_s=blocks[-1].ended_s,
        means=means,
    )


def _swing_flags(swing: Swing) -> list[str]:
    if swing.seen_percent > LIMIT_PERCENT:
        return [STICK_SLIP]
    return [STICK_SLIP_UNKNOWN] if isnan(swing.percent) else []


def _uncertainty(used: Sequence[Block], batches: Sequence[float], drift: Drift) -> float:
    """Return the larger of two standard errors: of the batch means, and of the blocks with their correlation."""
    of_batches = standard_deviation(batches) / sqrt(len(batches))
    effective = len(used) / drift.inflation
    if effective < 1.0:
        return of_batches
    of_blocks = standard_deviation([block.mu for block in used]) / sqrt(effective)
    return max(of_batches, of_blocks)


def _status(blocks: Sequence[Block], used: Sequence[Block], window: Window) -> tuple[RepeatStatus, str]:
    if enough(used, window):
        return RepeatStatus.VALID, ""
    transient = f", {len(blocks) - len(used)} more are transient" if len(used) < len(blocks) else ""
    if window.revolutions is None:
        return RepeatStatus.TOO_FEW, f"{len(used)} revolutions in less than {window.seconds:g} s{transient}"
    return RepeatStatus.TOO_FEW, f"{len(used)} of {window.revolutions:g} revolutions{transient}"


def _flags(blocks: Sequence[Block], used: Sequence[Block], window: Window) -> list[str]:
    wanted = window.of_repeat
    flags: list[str] = []
    if wanted != ANY_LENGTH and len(used) > 1 and enough(used[:-1], wanted):
        flags.append(EXTENDED)
    if len(used) < len(blocks):
        flags.append(TRUNCATED)
    return flags


def collected(counter: BlockCounter, window: Window, *, alone: bool) -> bool:
    """Return whether a repeat is complete.

    ``alone``: it has no siblings for a judgement, so it is extended until its drift is shown to be small, at most to
    ``window.extend_to``.
    """
    blocks = counter.blocks
    have = float(len(blocks)) if window.revolutions is not None else counter.seconds
    if have >= window.extend_to:
        return True
    if not filled(counter, window):
        return False
    return not alone or fit_drift([counted(blocks, window)], window).stable
