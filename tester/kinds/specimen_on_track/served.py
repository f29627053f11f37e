"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from typing import Final

from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.context import TrackContext
from tester.kinds.specimen_on_track.manual import TrackHand
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.runs import RUNS
from tester.kinds.specimen_on_track.screen import MACHINE, TrackPanel
from tester.machine.panel import RunPanel, drives_alone
from tester.machine.run import Run
from tester.machine.run_parts import KindRun, Left
from tester.machine.served import ServedKind


class SpecimenOnTrack(ServedKind):
    """The kind's answers to a service."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES
    runs: KindRun = RUNS
    panel: type[RunPanel] = TrackPanel

    def alone(self, rig: Rig) -> str:
        """Return the reactions of drives and chamber without a program, in words."""
        own = TrackConfig.of(rig)
        also = ("The chamber goes to standby by itself (30 s without a setpoint).",) if own.chamber else ()
        return drives_alone(own, "The arm stays where it is, with its weights.", *also)

    def hand(self, run: Run, left: Left | None) -> tuple[TrackHand, str]:
        """Take whatever is on the arm; a simulated rig gets a new specimen."""
        ctx: TrackContext = run.engine.ctx
        ctx.devices.by_hand_mm = ctx.rig.arm.raised_mm
        ctx.attendant.install(1, next(iter(ctx.rig.sim.rubbers), ""))
        return TrackHand(ctx.rig), "whatever is on the arm"


SERVED: Final = SpecimenOnTrack()
