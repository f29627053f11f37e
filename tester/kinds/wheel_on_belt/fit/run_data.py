"""The conditions of a run for a fit: measured temperature, load and slip, with their scatter."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import Sourced
from tester.analysis.fit.fit_part import Subject
from tester.analysis.kelvin import CONDITION_SCATTER
from tester.base.axes import SURFACE, surface_of
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.results.fit_points import ConditionReader, Scatter, points_of
from tester.results.run_results import results_of
from tester.results.table_rows import Measured
from tester.store.run_reader import RunReader

_KNOWN = frozenset({"temperature", "load", "slip_velocity", "wheel_speed", SURFACE})
"""Axes that a law covers: wheel speed counts only through the slip, each belt is fitted by itself. All other axes must
be at their defaults."""
_ON: Final = " on "

_PUBLISHED: Final = "residuals of the best separable law for the data of doi 10.3390/polym16050596"
BETWEEN_CONDITIONS: Final[Mapping[str, Scatter]] = {
    "1#": Scatter(0.032, f"3.2 %, {_PUBLISHED}"),
    "2#": Scatter(0.042, f"4.2 %, {_PUBLISHED}"),
    "3#": Scatter(0.059, f"5.9 %, {_PUBLISHED}"),
    "": Scatter(CONDITION_SCATTER, f"{100.0 * CONDITION_SCATTER:g} %, the middle of that paper's compounds [A]"),
}
"""Standard deviation of a compound's conditions from any smooth law, as a share; "": of any other compound."""


def run_points(folder: Path) -> Sourced:
    """Return the conditions of a run that a law can be fitted to; raises StoreError for an unreadable run.

    It omits conditions without a value, with a flagged value, or with an angle (no law has one).
    """
    with RunReader(folder) as reader:
        return points_of(folder.name, results_of(reader), _READER)


def subject_of(group: str) -> Subject:
    """Return compound and belt of a group of conditions; the belt is "" where the grids name none."""
    compound, _, belt = group.partition(_ON)
    return Subject(compound, surface=belt)


def _group(condition: Measured) -> str:
    belt = surface_of(condition.info.setpoint)
    return condition.info.compound + (f"{_ON}{belt}" if belt else "")


def _refused(condition: Measured) -> str:
    setpoint = condition.info.setpoint
    unknown = [axis.name for axis in setpoint.axes if axis.name not in _KNOWN and not axis.at_default(setpoint)]
    if unknown:
        return f"{', '.join(unknown)}: the laws know none"
    if not (condition.result.mu_resultant > 0.0 and all(map(isfinite, _measured(condition)))):
        return "no measured load, slip or temperature"
    return ""


def _measured(condition: Measured) -> tuple[float, float, float]:
    means = condition.result.measured
    return means.temperature, means.normal, abs(means.sliding)


def _nominal(condition: Measured) -> tuple[float, float, float]:
    held = held_by(condition.info.setpoint)
    return held.temperature_c, held.load_n, abs(held.slip_velocity_m_s)


_READER: Final = ConditionReader(TEMPERATURE, _nominal, _measured, _refused, BETWEEN_CONDITIONS, _group)
