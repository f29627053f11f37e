"""From measured conditions to points of a fit: the reliable ones, and their uncertainties."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from math import inf, isfinite, sqrt
from statistics import median
from typing import Final, NamedTuple

from tester.analysis.fit.fit_law import Common, FitPoint, Source
from tester.analysis.flags import REFERENCE, flags_in
from tester.analysis.kelvin import TEMPERATURE_SENSITIVITY
from tester.analysis.measurand import REPEATABILITY
from tester.analysis.repeats import REPEATABILITY as STATED
from tester.analysis.terms import PREFIX, Acts, Term, setting_of, with_settings
from tester.base.axes import condition_words
from tester.results.run_results import Measured, RunResults
from tester.store.records import RunInfo

REPEATS: Final = "repeatability"
BETWEEN: Final = "between_conditions"
"""Settings of a recipe's metadata: standard deviations between repeats, and between conditions, as shares."""


class Scatter(NamedTuple):
    """A standard deviation as a share of the coefficient, its source, "" for none, and its degrees of freedom."""

    standard: float
    source: str
    df: float = inf


Labelled = list[tuple[str, Measured]]
LeftOut = tuple[tuple[str, str], ...]


def sorted_out(name: str, results: RunResults, refused: Callable[[Measured], str]) -> tuple[Labelled, LeftOut]:
    """Return the reliable conditions of a run of this name, and the others with the reason.

    ``refused``: returns why a kind rejects a condition that has a value without doubt, "" where it accepts it.
    """
    kept: Labelled = []
    left_out: list[tuple[str, str]] = []
    for condition in results.conditions():
        label = f"{name}/{condition.info.condition}"
        reason = _doubt(condition) or refused(condition)
        if reason:
            left_out.append((f"{label} ({condition_words(condition.info.setpoint)})", reason))
        else:
            kept.append((label, condition))
    return kept, tuple(left_out)


def _doubt(measured: Measured) -> str:
    result = measured.result
    if not result.ok:
        return result.status.value
    if REFERENCE in flags_in(result.flags):
        return "a reference condition: one setpoint many times over"
    return ", ".join(result.doubts)


def standard_of(terms: Iterable[Term], acts: Acts) -> float:
    """Return the standard uncertainty of all terms that act in one way, in their unit."""
    return sqrt(sum(term.standard**2 for term in terms if term.acts is acts))


def source_of(
    name: str, info: RunInfo, kept: Labelled, *, temperature: int, worn: str, scatter: Callable[[str], Scatter]
) -> Source:
    """Return a run as a source of conditions, with the errors that they share.

    These are a factor of all, which is the budget without the contributions of repeats and temperature (the median over
    the conditions); the difference from piece to piece, called ``worn``; and the thermometer's bias, which moves the
    variable ``temperature``. ``scatter``: returns a compound's declared scatter between conditions.
    """
    terms = with_settings(info.terms, info.metadata)
    factors = [_rest(condition, _apart(terms), own=False) for _, condition in kept]
    between = standard_of(terms, Acts.PIECE)
    pieces = sorted({_piece(condition) for _, condition in kept})
    common = (
        Common("calibration and alignment", median(factors) if factors else 0.0),
        *(Common(f"{worn} to {worn}", between, piece=piece) for piece in pieces),
        Common("thermometer", standard_of(terms, Acts.TEMPERATURE), temperature),
    )
    repeats = next((_repeatability(condition, info.metadata).source for _, condition in kept), "")
    compounds = dict.fromkeys(condition.info.compound for _, condition in kept)
    declared = dict.fromkeys(scatter(compound).source for compound in compounds)
    return Source(name, common, repeats, "; ".join(condition for condition in declared if condition))


def point_of(
    label: str, one: Measured, source: Source, nominal: tuple[float, ...], measured: tuple[float, ...], between: float,
    info: RunInfo,
) -> FitPoint:  # fmt: skip
    """Return a condition as a point, with the scatter of its repeats; ``between``: scatter of conditions, as a
    share."""
    result = one.result
    known = _repeatability(one, info.metadata)
    return FitPoint(
        label=label,
        group=one.info.setpoint.compound,
        nominal=nominal,
        measured=measured,
        value=result.mu_resultant,
        source=source,
        type_a=known.standard,
        df=known.df,
        own=_rest(one, _apart(info.terms), own=True),
        between=between,
        piece=_piece(one),
    )


def declared_scatter(compound: str, metadata: Mapping[str, str], declared: Mapping[str, Scatter]) -> Scatter:
    """Return the standard deviation by which conditions of a compound miss any smooth law: the recipe's, or the kind's
    declared one for the compound, else for any ("").
    """
    text = metadata.get(PREFIX + BETWEEN)
    if text is not None:
        return Scatter(setting_of(PREFIX + BETWEEN, text), f"the recipe's {PREFIX}{BETWEEN}")
    return declared.get(compound, declared.get("", Scatter(0.0, "")))


def _repeatability(measured: Measured, metadata: Mapping[str, str]) -> Scatter:
    """Return the standard uncertainty of a condition's mean from repeats, as a share: pooled over the run, else as
    declared by the recipe or the rig.
    """
    result = measured.result
    pooled = next((part for part in result.budget.contributions if part.name == REPEATABILITY), None)
    if pooled is not None and isfinite(pooled.standard) and pooled.standard > 0.0:
        return Scatter(pooled.standard / result.mu_resultant, "repeats of the run", pooled.df)
    text = metadata.get(PREFIX + REPEATS)
    share = STATED if text is None else setting_of(PREFIX + REPEATS, text)
    source = f"{100.0 * share:g} % a repeat, declared by the {'rig [A]' if text is None else 'recipe'}"
    return Scatter(share / sqrt(max(result.n_valid, 1)), source)


def _rest(measured: Measured, apart: Set[str], *, own: bool) -> float:
    """Return the budget without the names in ``apart``, as a share of the coefficient; ``own``: the condition's
    independent part, else the part that conditions share.
    """
    result = measured.result
    parts = [part for part in result.budget.contributions if part.name not in apart and own is not bool(part.common)]
    squares = sum(part.standard**2 for part in parts)
    return sqrt(squares) / result.mu_resultant if isfinite(squares) else 0.0


def _apart(terms: Iterable[Term]) -> Set[str]:
    """Return the names of terms for which a fit has unknowns or a denominator of its own."""
    return {REPEATABILITY, TEMPERATURE_SENSITIVITY, *(term.name for term in terms if term.acts is Acts.TEMPERATURE)}


def _piece(measured: Measured) -> int:
    """Return the piece on which a condition was measured, of several the last."""
    return max((repeat.piece for repeat in measured.repeats if repeat.result.valid), default=0)
