"""The conditions of a run, as fits and master curves take them: measured speed, temperature and load, and interface."""

from __future__ import annotations

from math import isfinite, sqrt
from pathlib import Path
from statistics import median
from typing import Final

from tester.analysis.measurand import REPEATABILITY
from tester.analysis.reference import NAME
from tester.analysis.results import DOUBTS, flags_in
from tester.analysis.terms import Acts, Term, with_settings
from tester.axes import condition_words
from tester.export.results import Measured, RunResults, results_of
from tester.fit.law import NAN, Common, FitPoint, Source, Sourced, Variable
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.store.reader import RunReader

SPEED, TEMPERATURE, LOAD, INTERFACE = range(4)
"""Places of the variables; an interface is its place among ``INTERFACES``."""
VARIABLES: Final = (
    Variable("speed", "mm/s", 1e3),
    Variable("temperature", "degC", ratio=False),
    Variable("load", "N"),
    Variable("interface", "", ratio=False),
)


def run_points(folder: Path) -> Sourced:
    """Return the conditions of a run that have a value to rely on; raises StoreError where it cannot be read."""
    with RunReader(folder) as reader:
        return points_of(folder.name, results_of(reader))


def points_of(name: str, results: RunResults) -> Sourced:
    """Return the conditions of the results of a run of this name: speed in m/s, temperature in degC, load in N.

    Left out: conditions without a value, and those with one that is to be taken with care. Specimens of replicates are
    conditions of their own. What the conditions share: a factor, which is the budget without its type A and without
    its temperature (the median over the conditions); the difference from specimen to specimen; the thermometer's bias.
    """
    info = results.run.info
    terms = with_settings(info.terms, info.metadata)
    left_out: list[tuple[str, str]] = []
    kept: list[tuple[str, Measured]] = []
    for one in results.conditions():
        label = f"{name}/{one.info.condition}"
        reason = _reason(one)
        if reason:
            left_out.append((f"{label} ({condition_words(one.info.setpoint)})", reason))
        else:
            kept.append((label, one))
    apart = {REPEATABILITY, *(one.name for one in terms if one.acts is Acts.TEMPERATURE)}
    systematic = [_systematic(one, apart) for _, one in kept]
    common = (
        Common("calibration and alignment", median(systematic) if systematic else 0.0),
        Common("specimen to specimen", _standard(terms, Acts.PIECE)),
        Common("thermometer", _standard(terms, Acts.TEMPERATURE), TEMPERATURE),
    )
    source = Source(name, common)
    return Sourced(tuple(_point(label, one, source) for label, one in kept), tuple(left_out))


def _reason(one: Measured) -> str:
    """Return why a condition is left out, "" where it is not."""
    result = one.result
    if not result.ok:
        return result.status.value
    if NAME in flags_in(result.flags):
        return "a reference condition: one setpoint many times over"
    if result.doubts:
        return ", ".join(flag for flag in result.doubts if flag in DOUBTS)
    if not (result.mu_resultant > 0.0 and all(isfinite(value) for value in _measured(one)) and _measured(one)[0] > 0.0):
        return "no measured speed, temperature or load"
    return ""


def _measured(one: Measured) -> tuple[float, float, float, float]:
    means = one.result.measured
    return abs(means.sliding), means.temperature, means.normal, _interface(one)


def _interface(one: Measured) -> float:
    return float(INTERFACES.index(held_by(one.info.setpoint).interface))


def _standard(terms: tuple[Term, ...], acts: Acts) -> float:
    """Return the standard uncertainty of all terms that act in a way, in their unit."""
    return sqrt(sum(one.standard**2 for one in terms if one.acts is acts))


def _systematic(one: Measured, apart: set[str]) -> float:
    """Return what repeating does not average out and no name of ``apart`` stands for, as a share of the coefficient."""
    result = one.result
    squares = sum(one.standard**2 for one in result.budget.contributions if one.name not in apart)
    return sqrt(squares) / result.mu_resultant if isfinite(squares) else 0.0


def _point(label: str, one: Measured, source: Source) -> FitPoint:
    result, held = one.result, held_by(one.info.setpoint)
    repeated = result.n_valid > 1 and result.type_a > 0.0
    return FitPoint(
        label=label,
        group=one.info.compound,
        nominal=(held.track_m_s, held.temperature_c, held.load_n, _interface(one)),
        measured=_measured(one),
        value=result.mu_resultant,
        source=source,
        type_a=result.type_a / result.mu_resultant if repeated else NAN,
        df=float(result.n_valid - 1) if repeated else 0.0,
    )
