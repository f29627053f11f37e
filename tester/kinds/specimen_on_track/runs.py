"""This machine, for a run (``tester.machine.run_parts``)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from tester.base.screen import Check
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.axes import NAME
from tester.kinds.specimen_on_track.build import build_run
from tester.kinds.specimen_on_track.context import TrackAttendant
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.ports import Ports
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import KindRun, Part
from tester.machine.served import History
from tester.store.recorder import Recorder
from tester.store.records import Calibration
from tester.store.resume import ResumePoint


@dataclass(frozen=True, slots=True)
class NoTrackHistory:
    """Nothing is known of earlier runs: every run begins with a specimen of its own and a zero of its own."""

    def checks(self, rig: Rig, left: object, now_utc: str) -> tuple[Check, ...]:
        """Return the lines of the pre-flight list that are this kind's."""
        return (Check("zero of the load cell", None, "taken anew before every repeat"),)


class TrackRuns:
    """Says how a run of this machine is built, and what goes with it."""

    plant: str = NAME

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return the whole plan: there is one chamber."""
        return (Part(1, plan),)

    def build(
        self,
        rig: Rig,
        plan: Plan,
        ports: Ports,
        attendant: TrackAttendant,
        recorder: Recorder,
        prompts: Prompts,
        point: ResumePoint | None = None,
        history: History | None = None,
    ) -> Run:
        """Return a run that is ready to be ticked."""
        return build_run(TrackConfig.of(rig), plan, ports, attendant, recorder, prompts, point)

    def mount(self, attendant: TrackAttendant, compound: str) -> None:
        """Put a new specimen on; "" is SBR."""
        attendant.install(1, 1, compound or "SBR", new_specimen=True)

    def history(self, runs: Path, rig: Rig) -> NoTrackHistory:
        """Return that nothing is known."""
        return NoTrackHistory()

    def calibration(self, rig: Rig) -> Iterator[Calibration]:
        """Yield the weights."""
        for number, weight_n in enumerate(TrackConfig.of(rig).weights, start=1):
            yield Calibration("weights", f"set {number}", repr(weight_n), "N")

    def store_state(self, run: Run, recorder: Recorder, now_s: float) -> None:
        """Store how far the specimen has slid."""
        on = run.engine.ctx.on
        if on.number:
            recorder.piece_state(on.number, float("nan"), on.sliding_m, now_s)


RUNS: Final[KindRun] = TrackRuns()
