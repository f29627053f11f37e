"""The conditions of a specimen on a track for a master curve, unless friction warms the contact.

Friction may warm a row's contact beyond its temperature band (the rig's ``heat.rise`` times the power of friction):
the recorded temperature is then wrong. A run with one such row is refused as a whole, because smaller errors of its
other rows are unknown.
"""

from __future__ import annotations

from math import hypot
from pathlib import Path
from typing import Final

from tester.analysis.fit.fit_law import FitPoint
from tester.analysis.master_curve.points import MasterPart, MasterPoint, MasterRun, MasterSource
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.fit.run_data import (
    BEYOND_BAND,
    LOAD,
    SPEED,
    TEMPERATURE,
    beyond_band,
    points_of,
    rise_of,
    warmed_k,
)
from tester.kinds.specimen_on_track.fit.track_group import group_of
from tester.results.run_results import RunResults, results_of
from tester.store.run_reader import RunReader


def _run(folder: Path) -> MasterRun:
    """Return the conditions of a run; raises StoreError for an unreadable run, InvalidSource for its rig file."""
    with RunReader(folder) as reader:
        results = results_of(reader)
    sourced = points_of(folder.name, results)
    return MasterRun(tuple(_point(point) for point in sourced.points), sourced.left_out, _heated(results))


def _heated(results: RunResults) -> str:
    """Return a text that lists the rows that friction warms beyond their band; "" for none."""
    rise_k_w = rise_of(results.run.info)
    rows = [condition for condition in results.conditions() if beyond_band(condition, rise_k_w)]
    if not rows:
        return ""
    worst = max(rows, key=lambda row: warmed_k(row, rise_k_w))
    held = held_by(worst.info.setpoint)
    return (
        f"{BEYOND_BAND} in {len(rows)} rows: by {warmed_k(worst, rise_k_w):.1f} K at {1e3 * held.track_m_s:g} mm/s and"
        f" {held.temperature_c:g} degC, band {worst.info.temperature_band_k:g} K (heat.rise of the rig times the power"
        " of friction)"
    )


def _point(point: FitPoint) -> MasterPoint:
    common = point.source.common
    thermometer = next(c.standard for c in common if c.variable == TEMPERATURE)
    gain = hypot(*(c.standard for c in common if c.variable is None and c.piece in (0, point.piece)))
    group = group_of(point.group)
    surface = {"surface": group.surface} if group.surface else {}
    held = {**surface, "interface": group.interface, "load": f"{point.nominal[LOAD]:g} N"}
    return MasterPoint(
        point.label, group.compound, point.measured[SPEED], point.measured[TEMPERATURE], point.nominal[TEMPERATURE],
        point.value, MasterSource(point.source.name, gain, thermometer), held,
    )  # fmt: skip


MASTERS: Final = MasterPart(_run)
