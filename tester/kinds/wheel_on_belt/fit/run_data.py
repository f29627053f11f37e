"""The conditions of a run, as a fit takes them: measured temperature, load and slip, with what they scatter."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import Sourced
from tester.analysis.kelvin import CONDITION_SCATTER
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE
from tester.kinds.wheel_on_belt.image.axes import held_by
from tester.results.fit_points import Scatter, declared_scatter, point_of, sorted_out, source_of
from tester.results.run_results import Measured, results_of
from tester.store.run_reader import RunReader

_KNOWN = frozenset({"temperature", "load", "slip_velocity", "wheel_speed"})
"""Axes that a law knows; of the wheel's speed only the slip counts. Any other has to be at its default."""

_PUBLISHED: Final = "what the best separable law leaves of the data of doi 10.3390/polym16050596"
BETWEEN_CONDITIONS: Final[Mapping[str, Scatter]] = {
    "1#": Scatter(0.032, f"3.2 %, {_PUBLISHED}"),
    "2#": Scatter(0.042, f"4.2 %, {_PUBLISHED}"),
    "3#": Scatter(0.059, f"5.9 %, {_PUBLISHED}"),
    "": Scatter(CONDITION_SCATTER, f"{100.0 * CONDITION_SCATTER:g} %, the middle of that paper's compounds [A]"),
}
"""Standard deviation by which conditions of a compound miss any smooth law, as a share; "": of any other compound."""


def run_points(folder: Path) -> Sourced:
    """Return the conditions of a run that a law can be fitted to; raises StoreError where it cannot be read.

    Left out: conditions without a value, with one that is to be taken with care, with an angle (the laws know none).
    Wheels of replicates are conditions of their own.
    """
    with RunReader(folder) as reader:
        results = results_of(reader)
    info = results.run.info
    kept, left_out = sorted_out(folder.name, results, _reason)

    def scatter(compound: str) -> Scatter:
        return declared_scatter(compound, info.metadata, BETWEEN_CONDITIONS)

    source = source_of(folder.name, info, kept, temperature=TEMPERATURE, worn="wheel", scatter=scatter)
    points = (
        point_of(label, one, source, _nominal(one), _measured(one), scatter(one.info.compound).standard, info)
        for label, one in kept
    )
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
