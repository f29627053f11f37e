"""A kind's answers to a service: the view of a run, the facts from past runs, and manual mode.

A service reads a run between two ticks and thereby changes nothing. ``tester.run.kind_lookup`` finds a rig's kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from tester.machine.manual import NAME, ManualExecutor
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup

if TYPE_CHECKING:
    from tester.base.quantities import Quantities
    from tester.base.screen import MachineView
    from tester.inputs.rig import Rig
    from tester.machine.hand import Hand
    from tester.machine.panel import RunPanel
    from tester.machine.rig_ports import Ports
    from tester.machine.run import Run
    from tester.machine.run_parts import History, KindRun, Left
    from tester.store.recorder import Recorder
    from tester.store.run_reader import RunReader


@dataclass(frozen=True, slots=True)
class ByHand:
    """Manual mode, ready to be ticked; ``mounted``: the assumed specimen, in words."""

    run: Run
    executor: ManualExecutor
    mounted: str


@dataclass(frozen=True, slots=True)
class NotReused:
    """A specimen that a finished run left on the rig and that is not used again: the next run begins with its own."""

    known: bool

    def usable(self, rig: Rig) -> bool:
        """Return False: the specimen is treated as changed."""
        return False


class ServedKind:
    """A kind's answers to a service. The default of ``left`` is for a kind that reuses no specimen."""

    machine: MachineView
    """The tables that clients need."""
    quantities: Quantities
    """The table of channels."""
    runs: KindRun
    """Builds the run that a person then moves by hand."""
    panel: type[RunPanel]
    """The class of what clients see of a run; it is called with the run's engine."""

    def alone(self, rig: Rig) -> str:
        """Return what the rig's devices do by themselves once the process that owns the rig is gone, in words."""
        raise NotImplementedError

    def left(self, reader: RunReader, name: str) -> Left:
        """Return what a stored run of that name left on its rig. Raises StoreError."""
        return NotReused(any(True for _ in reader.pieces()))

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: Any, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Build manual mode, bounded only by the rig; ``left``: the specimen on it, None if new.

        ``attendant``, ``history``: as in the kind's ``KindRun``.
        """
        plan = self.runs.plan(NAME, (), (), 1)
        run = self.runs.build(RunSetup(rig, plan, ports, attendant, record, Prompts(), history=history))
        hand, mounted = self.hand(run, left)
        executor = run.engine.executor = ManualExecutor(hand)
        return ByHand(run, executor, mounted)

    def hand(self, run: Run, left: Left | None) -> tuple[Hand, str]:
        """Mount the specimen that manual mode assumes; return the hand that moves the axes, and the specimen in
        words.
        """
        raise NotImplementedError
