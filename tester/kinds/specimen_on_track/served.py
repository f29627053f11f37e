"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from typing import Final

from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.recipe.plan import Plan
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.axes import NAME
from tester.kinds.specimen_on_track.context import TrackAttendant
from tester.kinds.specimen_on_track.manual import TrackHand
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.runs import RUNS
from tester.kinds.specimen_on_track.screen import MACHINE, TrackPanel
from tester.machine.engine import Engine
from tester.machine.manual import NAME as MANUAL
from tester.machine.manual import ManualExecutor
from tester.machine.panel import drives_alone
from tester.machine.prompts import Prompts
from tester.machine.rig_ports import Ports
from tester.machine.served import ByHand, History, Left, ServedKind
from tester.store.recorder import Recorder


class SpecimenOnTrack(ServedKind):
    """The kind's answers to a service."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES

    def panel(self, engine: Engine) -> TrackPanel:
        """Return the view of a run for clients."""
        return TrackPanel(engine)

    def alone(self, rig: Rig) -> str:
        """Return the reactions of drives and chamber without a program, in words."""
        own = TrackConfig.of(rig)
        also = ("The chamber stands by itself (30 s without a setpoint).",) if own.chamber else ()
        return drives_alone(own, "The arm stays where it is, with its weights.", *also)

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: TrackAttendant, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Let a person command the run instead of a recipe; a simulated rig gets a new specimen."""
        own = TrackConfig.of(rig)
        run = RUNS.build(own, Plan(MANUAL, (), (), 1, kind=NAME), ports, attendant, record, Prompts())
        executor = ManualExecutor(TrackHand(own))
        run.engine.executor = executor
        run.engine.ctx.devices.by_hand_mm = own.arm.raised_mm
        attendant.install(1, 1, next(iter(own.sim.rubbers), ""), new_specimen=True)
        return ByHand(run, executor, "whatever is on the arm")


SERVED: Final = SpecimenOnTrack()
