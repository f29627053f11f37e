"""The conditions of a run, as a fit takes them: measured temperature, load and slip, with what its repeats scatter."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from statistics import median

from tester.analysis.measurand import REPEATABILITY
from tester.analysis.terms import Acts, with_settings
from tester.fit.law import Common, Source, Sourced
from tester.kinds.wheel_on_belt.axes import held_by
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE
from tester.results.fit_points import point_of, sorted_out, standard_of, systematic_of
from tester.results.run_results import Measured, results_of
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
    kept, left_out = sorted_out(folder.name, results, _reason)
    systematic = [systematic_of(one, {REPEATABILITY}) for _, one in kept]
    common = (
        Common("calibration and alignment", median(systematic) if systematic else 0.0),
        Common("thermometer", standard_of(terms, Acts.TEMPERATURE), TEMPERATURE),
    )
    source = Source(folder.name, common)
    points = (point_of(label, one, source, _nominal(one), _measured(one)) for label, one in kept)
    return Sourced(tuple(points), left_out)


def _reason(one: Measured) -> str:
    """Return why a condition that has a value is left out, "" where it is not."""
    result, held = one.result, one.info.setpoint
    unknown = [axis.name for axis in held.axes if axis.name not in _KNOWN and not axis.at_default(held)]
    if unknown:
        return f"{', '.join(unknown)}: the laws know none"
    if not (result.mu_resultant > 0.0 and all(isfinite(value) for value in _measured(one))):
        return "no measured load, slip or temperature"
    return ""


def _measured(one: Measured) -> tuple[float, float, float]:
    means = one.result.measured
    return means.temperature, means.normal, abs(means.sliding)


def _nominal(one: Measured) -> tuple[float, float, float]:
    held = held_by(one.info.setpoint)
    return held.temperature_c, held.load_n, abs(held.slip_velocity_m_s)
