"""The conditions of a run, as a fit takes them: measured temperature, load and slip, with what its repeats scatter."""

from __future__ import annotations

from math import isfinite, sqrt
from pathlib import Path
from statistics import median

from tester.analysis.measurand import REPEATABILITY
from tester.analysis.reference import NAME
from tester.analysis.results import DOUBTS, flags_in
from tester.analysis.terms import Acts, with_settings
from tester.axes import condition_words
from tester.export.results import Measured, results_of
from tester.fit.law import NAN, Common, FitPoint, Source, Sourced
from tester.kinds.wheel_on_belt.axes import Held, held_by
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE
from tester.store.reader import RunReader

_KNOWN = frozenset({"temperature", "load", "slip_velocity", "wheel_speed"})
"""Axes that a law knows; of the wheel's speed only the slip counts. Any other has to be at its default."""


def run_points(folder: Path) -> Sourced:
    """Return the conditions of a run that a law can be fitted to; raises StoreError where it cannot be read.

    Left out: conditions without a value, with one that is to be taken with care, with an angle (the laws know none).
    Wheels of replicates are conditions of their own. What the conditions of a run share: a factor, the budget without
    its type A (the median over the conditions), and the thermometer's bias.
    """
    with RunReader(folder) as reader:
        results = results_of(reader)
        info = results.run.info
        terms = with_settings(info.terms, info.metadata)
    left_out: list[tuple[str, str]] = []
    kept: list[tuple[str, Measured]] = []
    for one in results.conditions():
        label = f"{folder.name}/{one.info.condition}"
        reason = _reason(one)
        if reason:
            left_out.append((f"{label} ({condition_words(one.info.setpoint)})", reason))
        else:
            kept.append((label, one))
    systematic = [_systematic(one) for _, one in kept]
    thermometer = sqrt(sum(one.standard**2 for one in terms if one.acts is Acts.TEMPERATURE))
    common = (
        Common("calibration and alignment", median(systematic) if systematic else 0.0),
        Common("thermometer", thermometer, TEMPERATURE),
    )
    source = Source(folder.name, common)
    return Sourced(tuple(_point(label, one, source) for label, one in kept), tuple(left_out))


def _reason(one: Measured) -> str:
    """Return why a condition is left out, "" where it is not."""
    result, held = one.result, one.info.setpoint
    if not result.ok:
        return result.status.value
    if NAME in flags_in(result.flags):
        return "a reference condition: one setpoint many times over"
    if result.doubts:
        return ", ".join(flag for flag in result.doubts if flag in DOUBTS)
    unknown = [axis.name for axis in held.axes if axis.name not in _KNOWN and not axis.at_default(held)]
    if unknown:
        return f"{', '.join(unknown)}: the laws know none"
    if not (result.mu_resultant > 0.0 and all(isfinite(value) for value in _measured(one))):
        return "no measured load, slip or temperature"
    return ""


def _measured(one: Measured) -> tuple[float, float, float]:
    means = one.result.measured
    return means.temperature, means.normal, abs(means.sliding)


def _systematic(one: Measured) -> float:
    """Return what repeating does not average out, as a share of the coefficient."""
    result = one.result
    squares = sum(one.standard**2 for one in result.budget.contributions if one.name != REPEATABILITY)
    return sqrt(squares) / result.mu_resultant if isfinite(squares) else 0.0


def _point(label: str, one: Measured, source: Source) -> FitPoint:
    result, held = one.result, held_by(one.info.setpoint)
    repeated = result.n_valid > 1 and result.type_a > 0.0
    return FitPoint(
        label=label,
        group=held.compound,
        nominal=_nominal(held),
        measured=_measured(one),
        value=result.mu_resultant,
        source=source,
        type_a=result.type_a / result.mu_resultant if repeated else NAN,
        df=float(result.n_valid - 1) if repeated else 0.0,
    )


def _nominal(held: Held) -> tuple[float, float, float]:
    return held.temperature_c, held.load_n, abs(held.slip_velocity_m_s)
