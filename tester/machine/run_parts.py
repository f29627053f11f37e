"""What a kind brings to a run: how it is built, what is stored beside its scan, what earlier runs make known.

Types only. ``tester.run`` carries runs out and asks a kind through ``KindRun``; which kind a rig is, it asks
``tester.run.kinds``.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from tester.base.screen import Check
    from tester.inputs.recipe.plan import Plan
    from tester.inputs.rig import Rig
    from tester.machine.ports import Ports
    from tester.machine.prompts import Prompts
    from tester.machine.run import Run
    from tester.machine.served import History, Left
    from tester.store.recorder import Recorder
    from tester.store.records import Calibration
    from tester.store.resume import ResumePoint


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a plan: ``number`` counts from 1; the plan is the whole one's with this part's steps only.

    Steps, conditions, rows and specimens keep their numbers.
    """

    number: int
    plan: Plan
    last_mounted: int = 0
    """The highest number of what is mounted that is taken before this part mounts something that the plan did not
    foresee."""


@dataclass(frozen=True, slots=True)
class NoHistory:
    """The ``History`` of a kind of which earlier runs make nothing known."""

    lines: tuple[Check, ...] = ()
    """Of the list before a start."""

    def checks(self, rig: Rig, left: Left | None, now_utc: str) -> tuple[Check, ...]:
        """Return these lines, whatever is on the rig."""
        return self.lines


class KindRun(Protocol):
    """A kind, for those who carry out a run.

    An ``attendant`` is the hands at the rig: what a kind's procedures ask of a person, which a simulated rig does
    itself. Its methods are the kind's own.
    """

    @property
    def plant(self) -> str:
        """Name of the kind's twin, as ``sim.machines.find`` takes it, whose rig is its own attendant; "" where it has
        none."""
        ...

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return the parts of a plan, in its order, that may be carried out side by side, each on a simulated rig of
        its own; at least one."""
        ...

    def build(
        self,
        rig: Rig,
        plan: Plan,
        ports: Ports,
        attendant: Any,
        recorder: Recorder,
        prompts: Prompts,
        point: ResumePoint | None = None,
        history: History | None = None,
    ) -> Run:
        """Return a run that is ready to be ticked.

        ``plan``: what is left to do; ``point``: where an interrupted run goes on; ``history``: what earlier runs make
        known, None for nothing.
        """
        ...

    def mount(self, attendant: Any, compound: str) -> None:
        """Put a new specimen on a rig that nobody runs a recipe on: the twin in a process of its own.

        ``compound``: "" is the kind's own choice.
        """
        ...

    def history(self, runs: Path, rig: Rig) -> History:
        """Return what the runs in a folder make known of a rig; reads them, so not between two ticks."""
        ...

    def calibration(self, rig: Rig) -> Iterable[Calibration]:
        """Return the figures of the kind's own that turn what devices say into quantities; those of devices, nodes
        and drives are known without it."""
        ...

    def store_state(self, run: Run, recorder: Recorder, now_s: float) -> None:
        """Store what an interruption would lose of the state of the specimen; about once a second of wall time, while
        the rig is connected, beside the scan. ``now_s``: rig time."""
        ...
