"""The conditions of a run, as fits and master curves take them: measured speed, temperature and load, and interface."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import Sourced, Variable
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.kinds.specimen_on_track.fit.friction_heat import beyond_band, rise_of, warmed_k
from tester.results.fit_points import Scatter, declared_scatter, point_of, sorted_out, source_of
from tester.results.run_results import Measured, RunResults, results_of
from tester.store.run_reader import RunReader

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

    Left out: conditions without a value, those with one that is to be taken with care, and those in which friction
    warms the contact beyond its band of temperature. Specimens of replicates are conditions of their own.
    """
    info = results.run.info
    rise_k_w = rise_of(info)

    def reason(one: Measured) -> str:
        return _reason(one) or beyond_band(one, rise_k_w)

    def scatter(compound: str) -> Scatter:
        return declared_scatter(compound, info.metadata, {})

    kept, left_out = sorted_out(name, results, reason)
    source = source_of(name, info, kept, temperature=TEMPERATURE, worn="specimen", scatter=scatter)
    points = (
        replace(
            point_of(
                label, one, source, _nominal(one), _measured(one), scatter(one.info.compound).standard, info
            ),
            own_heat_k=warmed_k(one, rise_k_w),
        )
        for label, one in kept
    )
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
