"""Builds the runs of a specimen on a track (``tester.machine.run_parts``)."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf
from pathlib import Path
from typing import Final

from tester.base.screen import Check
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import quantities_on
from tester.kinds.specimen_on_track.axes import NAME, held_by
from tester.kinds.specimen_on_track.context import TrackAttendant, TrackContext
from tester.kinds.specimen_on_track.control import TrackControl
from tester.kinds.specimen_on_track.devices import TrackDevices
from tester.kinds.specimen_on_track.procedures.arming import TrackArming
from tester.kinds.specimen_on_track.procedures.steps import TrackProcedures
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.result_keeping import StoredResults
from tester.machine.run import Run, run_of
from tester.machine.run_parts import KindRun, NoHistory, RunSetup
from tester.store.records import Calibration


class TrackRuns(KindRun):
    """Builds runs of this machine. A plan is one part: there is one chamber."""

    plant: str = NAME

    def build(self, setup: RunSetup) -> Run:
        """Return a run that is ready to be ticked."""
        own = TrackConfig.of(setup.rig)
        devices = TrackDevices(own, setup.ports)
        speeds = [held_by(step.setpoint).track_m_s for step in setup.plan.conditions()]
        # A linear track is brought to its place at half its greatest speed, whatever the recipe asks for.
        most_m_s = (
            max([0.5 * own.limits.track_speed_m_s if own.linear else 0.0, *speeds], default=0.0) if speeds else inf
        )
        control = TrackControl(own, most_m_s)
        quantities = quantities_on(own)
        ctx = TrackContext(own, setup.prompts, setup.recorder, setup.attendant, devices, quantities)
        procedures = TrackProcedures(StoredResults[TrackContext](setup.recorder, point=setup.point))
        arming = TrackArming(devices, own)
        return run_of(setup.plan, devices, control, ctx, arming, procedures, quantities, own.arming.listen_s)

    def mount(self, attendant: TrackAttendant, compound: str) -> None:
        """Mount a new specimen; "" is SBR."""
        attendant.install(1, compound or "SBR")

    def history(self, runs: Path, rig: Rig) -> NoHistory:
        """Return a note that every run begins with its own specimen and zero."""
        return NoHistory((Check("zero of the load cell", None, "taken anew before every repeat"),))

    def calibration(self, rig: Rig) -> Iterator[Calibration]:
        """Yield the weights, for the record of calibration."""
        for number, weight_n in enumerate(TrackConfig.of(rig).weights, start=1):
            yield Calibration("weights", f"set {number}", repr(weight_n), "N")


RUNS: Final = TrackRuns()
