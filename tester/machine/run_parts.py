"""A kind's part of a run: how to build it, what to store beside its scan, what to learn from earlier runs.

``tester.run`` runs recipes through ``KindRun``; ``tester.run.kind_lookup`` finds a rig's kind.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from tester.inputs.recipe.plan import Plan

if TYPE_CHECKING:
    from tester.base.screen import Check
    from tester.inputs.rig import Rig
    from tester.machine.prompts import Prompts
    from tester.machine.rig_ports import Ports
    from tester.machine.run import Run
    from tester.store.recorder import Recorder
    from tester.store.records import Calibration
    from tester.store.resumable import ResumePoint


@dataclass(frozen=True, slots=True)
class Part:
    """A part of a plan. ``number`` counts from 1; ``plan`` is the whole plan reduced to this part's steps.

    Steps, conditions, rows and specimens keep their numbers.
    """

    number: int
    plan: Plan
    last_mounted: int = 0
    """The highest specimen number used before this part mounts a specimen that the plan did not foresee."""


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
class RunSetup:
    """What a run is built from."""

    rig: Rig
    plan: Plan
    """The work to do."""
    ports: Ports
    attendant: Any
    """It receives the kind's requests to a person; a simulated rig carries them out itself. The kind defines its
    methods."""
    recorder: Recorder
    prompts: Prompts
    point: ResumePoint | None = None
    """Where an interrupted run resumes."""
    history: History | None = None
    """Facts from earlier runs; None if there are none."""


@dataclass(frozen=True, slots=True)
class NoHistory:
    """The ``History`` of a kind that uses nothing from earlier runs."""

    lines: tuple[Check, ...] = ()
    """Lines of the pre-flight list."""

    def checks(self, rig: Rig, left: Left | None, now_utc: str) -> tuple[Check, ...]:
        """Return ``lines``; the rig and its state do not matter."""
        return self.lines


class NoAttendant:
    """The attendant of a real rig. It does nothing, because people do the work before they answer the prompt."""

    def __getattr__(self, name: str) -> Callable[..., None]:
        """Return a call that does nothing, for any public name."""
        if name.startswith("_"):
            raise AttributeError(name)
        return _nothing


def _nothing(*_: object, **__: object) -> None:
    """Do nothing."""


class KindRun:
    """A kind's part in running recipes. A kind implements ``build`` and ``mount``."""

    plan: type[Plan] = Plan
    """The class of the kind's plans."""
    plant: str = ""
    """Name of the kind's simulated twin for ``sim.machines.find``, whose rig is its own attendant; "" if it has
    none.
    """

    def split(self, plan: Plan) -> tuple[Part, ...]:
        """Return the parts of a plan, in order, that may run side by side, each on its own simulated rig. There is at
        least one; by default it is the whole plan.
        """
        return (Part(1, plan),)

    def build(self, setup: RunSetup) -> Run:
        """Return a run, ready to be ticked."""
        raise NotImplementedError

    def mount(self, attendant: Any, compound: str) -> None:
        """Mount a new specimen while no run is under way, on a twin in a process of its own.

        ``compound``: "" leaves the choice to the kind.
        """
        raise NotImplementedError

    def history(self, runs: Path, rig: Rig) -> History:
        """Return the facts about a rig from the runs in a folder. It reads files, so it is not called between two
        ticks.
        """
        return NoHistory()

    def calibration(self, rig: Rig) -> Iterable[Calibration]:
        """Return the kind's own figures that convert device readings into quantities, besides those of devices, nodes
        and drives.
        """
        return ()

    def store_state(self, run: Run, recorder: Recorder, now_s: float) -> None:
        """Store the state of the specimen that an interruption would lose; called about once a second of wall time
        while connected.

        ``now_s``: rig time.
        """
        run.engine.ctx.record_piece(recorder, now_s)
