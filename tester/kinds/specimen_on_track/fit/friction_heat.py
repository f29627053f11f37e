"""By how much friction warms a contact above the temperature that is on record."""

from __future__ import annotations

from tester.base.config_reader import read
from tester.base.source import Tree, load_tree
from tester.inputs.rig.packaged import complete
from tester.kinds.specimen_on_track.rig import HeatConfig, TrackConfig
from tester.results.run_results import Measured
from tester.store.records import RunInfo

BEYOND_BAND = "friction warms the contact beyond its band of temperature"


def rise_of(info: RunInfo) -> float:
    """Return the rig's belief ``heat.rise``, K/W, as a run's record has it; raises InvalidSource.

    Of the rig file only this section is read: its law of friction need not be installed any more.
    """
    tree = load_tree(info.rig_text, "rig.yaml")
    complete(TrackConfig, tree)
    section = tree.data.get("heat") if isinstance(tree.data, dict) else None
    return read(HeatConfig, Tree(tree.name, tree.text, section)).rise


def warmed_k(one: Measured, rise_k_w: float) -> float:
    """Return by how much the power of friction warms the contact of a condition in the end, K."""
    means = one.result.measured
    return rise_k_w * one.result.mu_resultant * means.normal * abs(means.sliding)


def beyond_band(one: Measured, rise_k_w: float) -> str:
    """Return that friction warms the contact of a condition beyond its band, "" where it does not."""
    return BEYOND_BAND if warmed_k(one, rise_k_w) > one.info.temperature_band_k else ""
