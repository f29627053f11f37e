"""A kind's answers to a service: the view of a run, the facts from past runs, and manual mode.

A service reads a run between two ticks and thereby changes nothing. ``tester.run.kind_lookup`` finds a rig's kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from tester.machine.manual import NAME, ManualExecutor
from tester.machine.prompts import Prompts
from tester.machine.run_parts import RunSetup

if TYPE_CHECKING:
    from tester.base.quantities import Quantities
    from tester.base.screen import Check, MachineView
    from tester.inputs.rig import Rig
    from tester.machine.motions import ZeroOfCell
    from tester.machine.panel import RunPanel
    from tester.machine.rig_ports import Ports
    from tester.machine.run import Run
    from tester.machine.run_parts import KindRun
    from tester.store.recorder import Recorder
    from tester.store.run_reader import RunReader


class Left(Protocol):
    """The specimen that a run left on its rig."""

    @property
    def known(self) -> bool:
        """Whether the run mounted something."""
        ...

    def usable(self, rig: Rig) -> bool:
        """Return whether the specimen may still be used on a rig. If not, it is treated as changed."""
        ...


class History(Protocol):
    """Facts about a rig from the runs in a folder: plain data, which can be hashed and pickled."""

    def checks(self, rig: Rig, left: Left | None, now_utc: str) -> tuple[Check, ...]:
        """Return the kind's part of the pre-flight list before the rig is connected. ``left``: what the newest run
        left.
        """
        ...


class Hand:
    """Moves a kind's axes for a person. Methods return "", or the reason for refusing; ``ctx`` is the kind's own."""

    def __init__(self) -> None:
        """Begin with nothing requested."""
        self.taring: ZeroOfCell | None = None
        """The zero of the load cell that is being taken."""
        self.tare_text = ""
        """The newest zero of the load cell in words, "" before the first."""

    @property
    def busy(self) -> str:
        """Why no step is possible at present; "" if a step is possible."""
        return "the load cell is being tared" if self.taring is not None else ""

    def follow(self, ctx: Any) -> None:
        """Write the demand, and advance a tare under way; called in every scan."""
        self.demand(ctx)
        taring = self.taring
        if taring is not None and taring.step(ctx):
            self.taring = None
            if taring.failed:
                self.tare_text = f"not taken: {taring.failed}"
            else:
                self.tare_text = f"zero from {taring.count} readings: {self.zero(ctx)}"
            ctx.journal.event(ctx.now, "tare", self.tare_text)

    def demand(self, ctx: Any) -> None:
        """Write the demand that results from the steps so far."""
        raise NotImplementedError

    def step(self, ctx: Any, axis: str, sign: float) -> str:
        """Take one step of an axis from the kind's table, up (+1) or down (-1)."""
        raise NotImplementedError

    def tare(self, ctx: Any) -> str:
        """Begin to zero the load cell."""
        raise NotImplementedError

    def zero(self, ctx: Any) -> str:
        """Return the zero of the load cell in words, once it has been taken."""
        raise NotImplementedError


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
