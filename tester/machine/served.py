"""A kind's answers to a service: the view of a run, the facts from past runs, and manual mode.

A service reads a run between two ticks and thereby changes nothing. This module holds types only;
``tester.run.kind_lookup`` finds a rig's kind.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from tester.base.quantities import Quantities
    from tester.base.screen import Check, MachineView
    from tester.inputs.rig import Rig
    from tester.machine.engine import Engine
    from tester.machine.manual import ManualExecutor
    from tester.machine.panel import RunPanel
    from tester.machine.rig_ports import Ports
    from tester.machine.run import Run
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

    def panel(self, engine: Engine) -> RunPanel:
        """Return what clients see of a run."""
        raise NotImplementedError

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
        raise NotImplementedError
