"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from typing import Final

from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.recipe.plan import Step
from tester.inputs.rig import Rig
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.heat_ratio import NO_HISTORY
from tester.kinds.wheel_on_belt.procedures.steps import title
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served import manual
from tester.kinds.wheel_on_belt.served.alone import left_alone
from tester.kinds.wheel_on_belt.served.left_on_rig import HeatHistory, WheelLeft, left_by
from tester.kinds.wheel_on_belt.served.screen import MACHINE, WheelPanel
from tester.machine.engine import Engine
from tester.machine.ports import Ports
from tester.machine.served import ByHand, History, Left, ServedKind
from tester.store.reader import RunReader
from tester.store.recorder import Recorder


class WheelOnBelt:
    """The kind's answers to a service."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES

    def title(self, step: Step) -> str:
        """Return a line that says what a step does."""
        return title(step)

    def panel(self, engine: Engine) -> WheelPanel:
        """Look at a run."""
        return WheelPanel(engine)

    def alone(self, rig: Rig) -> str:
        """Return what drives and heating do by themselves."""
        return left_alone(RigConfig.of(rig))

    def left(self, reader: RunReader, name: str) -> WheelLeft:
        """Return the wheel that a run left on its rig."""
        return left_by(reader, name)

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: Attendant, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Put a person in the place of a recipe."""
        heat = history.ratio if isinstance(history, HeatHistory) else NO_HISTORY
        mounted = left if isinstance(left, WheelLeft) else None
        return manual.by_hand(RigConfig.of(rig), ports, attendant, record, mounted, heat)


SERVED: Final[ServedKind] = WheelOnBelt()
