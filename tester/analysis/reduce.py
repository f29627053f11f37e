"""From the blocks of a repeat to one coefficient.

mu is a ratio of means, which noise of the forces does not bias (a mean of ratios is biased by noise of Fz):

    longitudinal = mean(Fx) / mean(Fz)    lateral = mean(Fy) / mean(Fz)    resultant = hypot of the two

with the measured load Fz, over the whole revolutions that are left after truncation, each of equal weight.
The tare was subtracted before the samples were recorded. The paper's tabulated coefficient is the
resultant.

The uncertainty comes from 10 batch means: consecutive revolutions correlate, so s / sqrt(n) of raw samples
covers 33 % where 95 % is claimed (physics.md 6). Batch means alone cover 93 % of windows of a fixed length, but 88 %
of those that ended because they looked steady; with the blocks' own standard error, their correlation allowed for,
where that is larger, 95 % (AR(1) noise of 1 % and 0.3 s, windows of 30 to 90 revolutions, 500 trials).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import sqrt

from tester.analysis.blocks import AVERAGED, Block, resultant
from tester.analysis.results import NAN, Burst, RepeatResult, RepeatStatus
from tester.analysis.stability import Stability, assess, enough

BATCHES = 10
"""Number of batch means per repeat."""


def batch_means(blocks: Sequence[Block]) -> list[float]:
    """Return the resultant coefficients of up to 10 consecutive batches, as equal in length as they can be."""
    n = len(blocks)
    count = min(BATCHES, n)
    edges = [i * n // count for i in range(count + 1)]
    return [_resultant(blocks[a:b]) for a, b in pairwise(edges)]


def _resultant(blocks: Sequence[Block]) -> float:
    n = len(blocks)
    return resultant(
        sum(block.force_x_n for block in blocks) / n,
        sum(block.force_y_n for block in blocks) / n,
        sum(block.force_z_n for block in blocks) / n,
    )


def standard_deviation(values: Sequence[float]) -> float:
    """Return the sample standard deviation (n - 1) of at least two values, NaN of fewer."""
    n = len(values)
    if n < 2:
        return NAN
    mean = sum(values) / n
    return sqrt(sum((value - mean) ** 2 for value in values) / (n - 1))


def bursts_of(blocks: Sequence[Block]) -> list[Burst]:
    """Return one record for every burst that gave at least one whole revolution, in order."""
    found: list[Burst] = []
    first = 0
    for end in range(1, len(blocks) + 1):
        if end == len(blocks) or blocks[end].burst != blocks[first].burst:
            a, b = blocks[first], blocks[end - 1]
            found.append(Burst(a.burst, end - first, a.started_s, b.ended_s, a.surface_c, b.surface_c))
            first = end
    return found


def without_value(status: RepeatStatus, reason: str, started_s: float = NAN, ended_s: float = NAN) -> RepeatResult:
    """Return the result of a repeat that gave no coefficient, with the reason for people; rig seconds."""
    return RepeatResult(status=status, reason=reason, started_s=started_s, ended_s=ended_s)


def reduce_repeat(
    blocks: Sequence[Block],
    revolutions: float | None = None,
    seconds: float | None = None,
    *,
    rolling: bool = False,
    stability: Stability | None = None,
) -> RepeatResult:
    """Return a repeat's result from its blocks, in order of time.

    ``revolutions`` or ``seconds`` is the nominal window of accepted samples (both None: any length will do).
    ``rolling`` marks a condition of 0 mm/s. ``stability`` saves assessing the same blocks again. Status:
    VALID, NOT_STABILISED, or TOO_FEW when the window is not full; the latter two carry their figures too.
    """
    if not blocks:
        return without_value(RepeatStatus.TOO_FEW, "not one whole accepted revolution")
    verdict = stability if stability is not None else assess(blocks, revolutions, seconds)
    status, reason = _status(blocks, verdict, revolutions, seconds)
    used = blocks[verdict.truncated :]
    n = len(used)
    means: dict[str, float] = {name: sum(getattr(block, name) for block in used) / n for name in AVERAGED}
    batches = batch_means(used)
    mu, load, spread = _resultant(used), means["force_z_n"], standard_deviation(batches)
    return RepeatResult(
        status=status,
        reason=reason,
        flags=_flags(blocks, verdict, revolutions, seconds, rolling),
        mu_resultant=mu,
        mu_longitudinal=means["force_x_n"] / load if load > 0.0 else NAN,
        mu_lateral=means["force_y_n"] / load if load > 0.0 else NAN,
        uncertainty=_uncertainty(used, batches, verdict),
        fluctuation_percent=100.0 * spread / mu if mu > 0.0 else NAN,
        batches=len(batches),
        drift_percent=verdict.drift_percent,
        bound_percent=verdict.bound_percent,
        revolutions=n,
        truncated=verdict.truncated,
        window_s=sum(block.ended_s - block.started_s for block in used),
        bursts=len(bursts_of(used)),
        started_s=blocks[0].started_s,
        ended_s=blocks[-1].ended_s,
        **means,
    )


def _uncertainty(used: Sequence[Block], batches: Sequence[float], verdict: Stability) -> float:
    """Return the larger standard error of two: of the batch means, and of the blocks with their correlation."""
    of_batches = standard_deviation(batches) / sqrt(len(batches))
    if verdict.effective < 1.0:
        return of_batches
    of_blocks = standard_deviation([block.mu for block in used]) / sqrt(verdict.effective)
    return max(of_batches, of_blocks)


def _status(
    blocks: Sequence[Block], verdict: Stability, revolutions: float | None, seconds: float | None
) -> tuple[RepeatStatus, str]:
    if verdict.stabilised:
        return RepeatStatus.VALID, ""
    if enough(blocks, revolutions, seconds):
        return RepeatStatus.NOT_STABILISED, verdict.reason
    if revolutions is None:
        return RepeatStatus.TOO_FEW, f"{len(blocks)} revolutions in less than {seconds:g} s"
    return RepeatStatus.TOO_FEW, f"{len(blocks)} of {revolutions:g} revolutions"


def _flags(
    blocks: Sequence[Block],
    verdict: Stability,
    revolutions: float | None,
    seconds: float | None,
    rolling: bool,
) -> str:
    windowed = revolutions is not None or seconds is not None
    flags = ["rolling"] if rolling else []
    if windowed and len(blocks) > 1 and enough(blocks[:-1], revolutions, seconds):
        flags.append("extended")
    if verdict.truncated:
        flags.append("truncated")
    return " ".join(flags)
