"""From measured conditions to what a fit takes: which can be relied on, what repeating leaves, and each as a point."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Set
from math import isfinite, sqrt

from tester.analysis.flags import REFERENCE, flags_in
from tester.analysis.terms import Acts, Term
from tester.axes import condition_words
from tester.fit.law import NAN, FitPoint, Source
from tester.results.run_results import Measured, RunResults

Labelled = list[tuple[str, Measured]]
LeftOut = tuple[tuple[str, str], ...]


def sorted_out(name: str, results: RunResults, refused: Callable[[Measured], str]) -> tuple[Labelled, LeftOut]:
    """Return the conditions of a run of this name that can be relied on, and the others with the reason.

    ``refused``: why a kind takes none of a condition that has a value without doubt, "" where it does.
    """
    kept: Labelled = []
    left_out: list[tuple[str, str]] = []
    for one in results.conditions():
        label = f"{name}/{one.info.condition}"
        reason = _doubt(one) or refused(one)
        if reason:
            left_out.append((f"{label} ({condition_words(one.info.setpoint)})", reason))
        else:
            kept.append((label, one))
    return kept, tuple(left_out)


def _doubt(one: Measured) -> str:
    result = one.result
    if not result.ok:
        return result.status.value
    if REFERENCE in flags_in(result.flags):
        return "a reference condition: one setpoint many times over"
    return ", ".join(result.doubts)


def standard_of(terms: Iterable[Term], acts: Acts) -> float:
    """Return the standard uncertainty of all terms that act in a way, in their unit."""
    return sqrt(sum(one.standard**2 for one in terms if one.acts is acts))


def systematic_of(one: Measured, apart: Set[str]) -> float:
    """Return what repeating does not average out and no name of ``apart`` stands for, as a share of the coefficient."""
    result = one.result
    squares = sum(part.standard**2 for part in result.budget.contributions if part.name not in apart)
    return sqrt(squares) / result.mu_resultant if isfinite(squares) else 0.0


def point_of(
    label: str, one: Measured, source: Source, nominal: tuple[float, ...], measured: tuple[float, ...]
) -> FitPoint:
    """Return a condition with what its repeats scatter, as a share of the coefficient."""
    result = one.result
    repeated = result.n_valid > 1 and result.type_a > 0.0
    return FitPoint(
        label=label,
        group=one.info.setpoint.compound,
        nominal=nominal,
        measured=measured,
        value=result.mu_resultant,
        source=source,
        type_a=result.type_a / result.mu_resultant if repeated else NAN,
        df=float(result.n_valid - 1) if repeated else 0.0,
    )
