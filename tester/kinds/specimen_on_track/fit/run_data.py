"""The conditions of a run for fits and master curves: measured speed, temperature and load, in groups."""

from __future__ import annotations

from functools import partial
from math import isfinite
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import Sourced, Variable
from tester.base.config_reader import read
from tester.base.source import Tree, load_tree
from tester.inputs.rig.packaged import complete
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.fit.track_group import TrackGroup
from tester.kinds.specimen_on_track.rig import HeatConfig, TrackConfig
from tester.results import fit_points
from tester.results.run_results import RunResults, results_of
from tester.results.table_rows import Measured
from tester.store.records import RunInfo
from tester.store.run_reader import RunReader

SPEED, TEMPERATURE, LOAD = range(3)
"""Indexes of the variables."""
VARIABLES: Final = (
    Variable("speed", "mm/s", 1e3),
    Variable("temperature", "degC", ratio=False),
    Variable("load", "N"),
)
BEYOND_BAND: Final = "friction warms the contact beyond its band of temperature"


def run_points(folder: Path) -> Sourced:
    """Return the conditions of a run with a reliable value; raises StoreError for an unreadable run."""
    with RunReader(folder) as reader:
        return points_of(folder.name, results_of(reader))


def points_of(name: str, results: RunResults) -> Sourced:
    """Return the conditions in the results of a run: speed in m/s, temperature in degC, load in N.

    Those of one compound, interface and surface are a group (``track_group``).
    It omits conditions without a value, conditions with a flagged value, and those in which friction warms the
    contact beyond its temperature band.
    """
    rise_k_w = rise_of(results.run.info)
    abrasive = results.run.info.metadata.get("abrasive", "")

    def group(condition: Measured) -> str:
        held = held_by(condition.info.setpoint)
        return TrackGroup(condition.info.setpoint.compound, held.interface, held.surface or abrasive).text

    reader = fit_points.ConditionReader(
        TEMPERATURE,
        _nominal,
        _measured,
        lambda condition: _unmeasured(condition) or beyond_band(condition, rise_k_w),
        own_heat_k=partial(warmed_k, rise_k_w=rise_k_w),
        group=group,
    )
    return fit_points.points_of(name, results, reader)


def rise_of(info: RunInfo) -> float:
    """Return the rig's assumed ``heat.rise``, K/W, from a run's record; raises InvalidSource.

    It reads only this section of the rig file, because the file's law of friction may no longer be installed.
    """
    tree = load_tree(info.rig_text, "rig.yaml")
    complete(TrackConfig, tree)
    section = tree.data.get("heat") if isinstance(tree.data, dict) else None
    return read(HeatConfig, Tree(tree.name, tree.text, section)).rise


def warmed_k(condition: Measured, rise_k_w: float) -> float:
    """Return the steady warming of a condition's contact by friction, K."""
    means = condition.result.measured
    return rise_k_w * condition.result.mu_resultant * means.normal * abs(means.sliding)


def beyond_band(condition: Measured, rise_k_w: float) -> str:
    """Return the reason against a condition whose contact friction warms beyond its band, "" where it does not."""
    return BEYOND_BAND if warmed_k(condition, rise_k_w) > condition.info.temperature_band_k else ""


def _unmeasured(condition: Measured) -> str:
    measured = _measured(condition)
    if condition.result.mu_resultant > 0.0 and all(map(isfinite, measured)) and measured[SPEED] > 0.0:
        return ""
    return "no measured speed, temperature or load"


def _measured(condition: Measured) -> tuple[float, float, float]:
    means = condition.result.measured
    return abs(means.sliding), means.temperature, means.normal


def _nominal(condition: Measured) -> tuple[float, float, float]:
    held = held_by(condition.info.setpoint)
    return held.track_m_s, held.temperature_c, held.load_n
