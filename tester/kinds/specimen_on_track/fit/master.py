"""The conditions of a specimen on a track as a master curve takes them, unless friction warms the contact.

A row whose contact friction warms beyond its band of temperature is not at the temperature that is on record
(``heat.rise`` of the rig times the power of friction). A run with such a row is refused as a whole: which rows are
wrong by a little less is not known.
"""

from __future__ import annotations

from math import hypot
from pathlib import Path
from typing import Final

from tester.base.source import load_tree
from tester.fit.law import FitPoint
from tester.kinds.specimen_on_track.axes import INTERFACES, held_by
from tester.kinds.specimen_on_track.fit.runs import INTERFACE, LOAD, SPEED, TEMPERATURE, points_of
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.master.part import MasterPart
from tester.master.points import MasterPoint, MasterRun, MasterSource
from tester.results.run_results import RunResults, results_of
from tester.rig.load import checked
from tester.store.reader import RunReader


class TrackMasters:
    """Conditions of a specimen on a track."""

    def run(self, folder: Path) -> MasterRun:
        """Return the conditions of a run; raises StoreError where it cannot be read, InvalidSource for its rig file."""
        with RunReader(folder) as reader:
            results = results_of(reader)
        found = points_of(folder.name, results)
        rig = checked(TrackConfig, load_tree(results.run.info.rig_text, "rig.yaml"))
        return MasterRun(tuple(_point(one) for one in found.points), found.left_out, _heated(results, rig.heat.rise))

    def packaged(self, name: str) -> MasterRun:
        """Raise KeyError: no conditions of a track ship with the program."""
        raise KeyError(name)


def _heated(results: RunResults, rise_k_w: float) -> str:
    """Return which rows friction warms beyond their band, "" where none is."""
    worst, rows = (0.0, 0.0, ""), 0
    for one in results.conditions():
        means = one.result.measured
        power_w = one.result.mu_resultant * means.normal * abs(means.sliding)
        warmed_k, band_k = rise_k_w * power_w, one.info.temperature_band_k
        if warmed_k > band_k:
            rows += 1
            held = held_by(one.info.setpoint)
            worst = max(worst, (warmed_k, band_k, f"{1e3 * held.track_m_s:g} mm/s and {held.temperature_c:g} degC"))
    if not rows:
        return ""
    warmed_k, band_k, where = worst
    return (
        f"friction warms the contact in {rows} rows beyond their band of temperature: by {warmed_k:.1f} K at {where},"
        f" band {band_k:g} K (heat.rise of the rig times the power of friction)"
    )


def _point(one: FitPoint) -> MasterPoint:
    thermometer = next(common.standard for common in one.source.common if common.variable == TEMPERATURE)
    gain = hypot(*(common.standard for common in one.source.common if common.variable is None))
    held = {"interface": INTERFACES[round(one.nominal[INTERFACE])], "load": f"{one.nominal[LOAD]:g} N"}
    return MasterPoint(
        one.label, one.group, one.measured[SPEED], one.measured[TEMPERATURE], one.nominal[TEMPERATURE], one.value,
        MasterSource(one.source.name, gain, thermometer), held,
    )  # fmt: skip


MASTERS: Final[MasterPart] = TrackMasters()
