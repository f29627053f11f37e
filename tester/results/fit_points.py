"""From measured conditions to points of a fit: the reliable ones, and their uncertainties."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, field
from math import inf, isfinite, sqrt
from statistics import median
from typing import Final, NamedTuple

from tester.analysis.fit.fit_law import Common, FitPoint, Source, Sourced
from tester.analysis.flags import REFERENCE, flags_in
from tester.analysis.kelvin import TEMPERATURE_SENSITIVITY
from tester.analysis.left_out import REPEATABILITY as STATED
from tester.analysis.measurand import REPEATABILITY
from tester.analysis.terms import PREFIX, Acts, Term, setting_of, with_settings
from tester.base.axes import condition_words
from tester.results.run_results import RunResults
from tester.results.table_rows import Measured
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


def _no_heat(measured: Measured) -> float:
    return 0.0


def _compound(measured: Measured) -> str:
    return measured.info.setpoint.compound


@dataclass(frozen=True, slots=True)
class ConditionReader:
    """A kind's reader of conditions for a fit; values of variables are in a law's own units."""

    temperature: int
    """Place of the temperature among the variables."""
    nominal: Callable[[Measured], tuple[float, ...]]
    measured: Callable[[Measured], tuple[float, ...]]
    refused: Callable[[Measured], str]
    """Why the kind rejects a condition that has a value without doubt, "" where it accepts it."""
    scatter: Mapping[str, Scatter] = field(default_factory=dict[str, Scatter])
    """Declared standard deviation between conditions by compound; "": of any other."""
    group: Callable[[Measured], str] = _compound
    """The group of a condition: those of one are fitted together."""
    own_heat_k: Callable[[Measured], float] = _no_heat
    """Warming of the contact by friction above the measured temperature, K."""


def points_of(name: str, results: RunResults, by: ConditionReader) -> Sourced:
    """Return the reliable conditions of a run of this name, and the others with the reason.

    Pieces of replicates are conditions of their own.
    """
    info = results.run.info
    kept: Labelled = []
    left_out: list[tuple[str, str]] = []
    for condition in results.conditions():
        label = f"{name}/{condition.info.condition}"
        reason = _doubt(condition) or by.refused(condition)
        if reason:
            left_out.append((f"{label} ({condition_words(condition.info.setpoint)})", reason))
        else:
            kept.append((label, condition))
    source = _source_of(name, info, kept, by)
    return Sourced(tuple(_point_of(label, condition, source, info, by) for label, condition in kept), tuple(left_out))


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


def _source_of(name: str, info: RunInfo, kept: Labelled, by: ConditionReader) -> Source:
    """Return a run as a source of conditions, with the errors that they share.

    These are a factor of all, which is the budget without the contributions of repeats and temperature (the median over
    the conditions); the difference from piece to piece; and the thermometer's bias, which moves the temperature.
    """
    terms = with_settings(info.terms, info.metadata)
    factors = [_rest(condition, _apart(terms), own=False) for _, condition in kept]
    between = standard_of(terms, Acts.PIECE)
    pieces = sorted({_piece(condition) for _, condition in kept})
    common = (
        Common("calibration and alignment", median(factors) if factors else 0.0),
        *(Common(f"{info.worn} to {info.worn}", between, piece=piece) for piece in pieces),
        Common("thermometer", standard_of(terms, Acts.TEMPERATURE), by.temperature),
    )
    repeats = next((_repeatability(condition, info.metadata).source for _, condition in kept), "")
    compounds = dict.fromkeys(condition.info.compound for _, condition in kept)
    declared = dict.fromkeys(_scatter(compound, info, by).source for compound in compounds)
    return Source(name, common, repeats, "; ".join(source for source in declared if source))


def _point_of(label: str, condition: Measured, source: Source, info: RunInfo, by: ConditionReader) -> FitPoint:
    """Return a condition as a point, with the scatter of its repeats."""
    known = _repeatability(condition, info.metadata)
    return FitPoint(
        label=label,
        group=by.group(condition),
        nominal=by.nominal(condition),
        measured=by.measured(condition),
        value=condition.result.mu_resultant,
        source=source,
        type_a=known.standard,
        df=known.df,
        own=_rest(condition, _apart(info.terms), own=True),
        between=_scatter(condition.info.compound, info, by).standard,
        piece=_piece(condition),
        own_heat_k=by.own_heat_k(condition),
    )


def _scatter(compound: str, info: RunInfo, by: ConditionReader) -> Scatter:
    """Return the standard deviation by which conditions of a compound miss any smooth law: the recipe's, or the kind's
    declared one for the compound, else for any.
    """
    text = info.metadata.get(PREFIX + BETWEEN)
    if text is not None:
        return Scatter(setting_of(PREFIX + BETWEEN, text), f"the recipe's {PREFIX}{BETWEEN}")
    return by.scatter.get(compound, by.scatter.get("", Scatter(0.0, "")))


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
    independent part; otherwise the part that conditions share."""
    result = measured.result
    parts = [part for part in result.budget.contributions if part.name not in apart and own is not bool(part.common)]
    squares = sum(part.standard**2 for part in parts)
    return sqrt(squares) / result.mu_resultant if isfinite(squares) else 0.0


def _apart(terms: Iterable[Term]) -> Set[str]:
    """Return the names of terms for which a fit has unknowns or a denominator of its own."""
    return {REPEATABILITY, TEMPERATURE_SENSITIVITY, *(term.name for term in terms if term.acts is Acts.TEMPERATURE)}


def _piece(measured: Measured) -> int:
    """Return the piece on which a condition was measured, the last of several."""
    return max((repeat.piece for repeat in measured.repeats if repeat.result.valid), default=0)
