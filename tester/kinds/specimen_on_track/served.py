"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.recipe.plan import Step
from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track import manual
from tester.kinds.specimen_on_track.context import TrackAttendant
from tester.kinds.specimen_on_track.procedures.steps import title
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.kinds.specimen_on_track.screen import MACHINE, TrackPanel
from tester.machine.engine import Engine
from tester.machine.ports import Ports
from tester.machine.served import ByHand, History, Left, ServedKind
from tester.store.reader import RunReader
from tester.store.recorder import Recorder


@dataclass(frozen=True, slots=True)
class SpecimenLeft:
    """What a run left on the arm; nobody goes on with it."""

    known: bool

    def usable(self, rig: Rig) -> bool:
        """Tell that a run begins with a specimen of its own."""
        return False


class SpecimenOnTrack:
    """Answers what a service asks of the kind."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES

    def title(self, step: Step) -> str:
        """Return a line that says what a step does."""
        return title(step)

    def panel(self, engine: Engine) -> TrackPanel:
        """Look at a run."""
        return TrackPanel(engine)

    def alone(self, rig: Rig) -> str:
        """Return what drives and chamber do by themselves."""
        own = TrackConfig.of(rig)
        if own.simulated:
            return "The simulated rig was part of the service and is gone with it."
        waits = min(
            wait
            for axis in own.drives().values()
            for wait in (axis.consumer_heartbeat_s, axis.rpdo_deadline_s)
            if wait > 0.0
        )
        text = f"Without heartbeat and setpoints each drive makes a quick stop by itself ({1e3 * waits:.0f} ms)."
        text += " The arm stays where it is, with its weights."
        return text + (" The chamber stands by itself (30 s without a setpoint)." if own.chamber else "")

    def left(self, reader: RunReader, name: str) -> SpecimenLeft:
        """Return what a run left on its rig."""
        return SpecimenLeft(bool(reader.pieces()))

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: TrackAttendant, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Put a person in the place of a recipe."""
        return manual.by_hand(TrackConfig.of(rig), ports, attendant, record)


SERVED: Final[ServedKind] = SpecimenOnTrack()
