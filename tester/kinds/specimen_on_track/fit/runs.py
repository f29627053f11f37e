"""The conditions of a run, as fits and master curves take them: measured speed, temperature and load, and interface."""

from __future__ import annotations

from math import isfinite
from pathlib import Path
from statistics import median
from typing import Final

from tester.analysis.measurand import REPEATABILITY
from tester.analysis.terms import Acts, with_settings
from tester.fit.law import Common, Source, Sourced, Variable
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.results.fit_points import point_of, sorted_out, standard_of, systematic_of
from tester.results.run_results import Measured, RunResults, results_of
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
    kept, left_out = sorted_out(name, results, _reason)
    apart = {REPEATABILITY, *(one.name for one in terms if one.acts is Acts.TEMPERATURE)}
    systematic = [systematic_of(one, apart) for _, one in kept]
    common = (
        Common("calibration and alignment", median(systematic) if systematic else 0.0),
        Common("specimen to specimen", standard_of(terms, Acts.PIECE)),
        Common("thermometer", standard_of(terms, Acts.TEMPERATURE), TEMPERATURE),
    )
    source = Source(name, common)
    points = (point_of(label, one, source, _nominal(one), _measured(one)) for label, one in kept)
    return Sourced(tuple(points), left_out)


def _reason(one: Measured) -> str:
    """Return why a condition that has a value is left out, "" where it is not."""
    value, measured = one.result.mu_resultant, _measured(one)
    if value > 0.0 and all(map(isfinite, measured)) and measured[0] > 0.0:
        return ""
    return "no measured speed, temperature or load"


def _measured(one: Measured) -> tuple[float, float, float, float]:
    means = one.result.measured
    return abs(means.sliding), means.temperature, means.normal, _interface(one)


def _interface(one: Measured) -> float:
    return float(INTERFACES.index(held_by(one.info.setpoint).interface))


def _nominal(one: Measured) -> tuple[float, float, float, float]:
    held = held_by(one.info.setpoint)
    return held.track_m_s, held.temperature_c, held.load_n, _interface(one)
