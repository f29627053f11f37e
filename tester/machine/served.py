"""What a kind answers a service: what it shows of a run, what past runs make known, and a person's hands.

A service looks at a run between two ticks and changes nothing by it. Types only; ``tester.run.kinds`` knows which kind
a rig is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from tester.base.quantities import Quantities
    from tester.base.screen import Check, Gate, MachineView, SoakView
    from tester.inputs.recipe.plan import Step
    from tester.inputs.rig import Rig
    from tester.machine.engine import Engine
    from tester.machine.manual import ManualExecutor
    from tester.machine.ports import Ports
    from tester.machine.run import Run
    from tester.store.reader import RunReader
    from tester.store.recorder import Recorder


@dataclass(frozen=True, slots=True)
class News:
    """How a device's data are: when the newest came (rig s, -inf: never), whether valid, from what age on stale, s."""

    at_s: float
    valid: bool
    stale_s: float


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is wanted of a value, in the unit that people read, and half the width of its gate; None: nothing."""

    setpoint: float | None
    band: float | None = None


class MachinePanel(Protocol):
    """One run of the kind, to look at."""

    def news(self) -> Mapping[str, News]:
        """Return the news of every device that the table of channels names."""
        ...

    def wanted(self) -> Mapping[str, Wanted]:
        """Return what is wanted of the values, by their keys; those of which nothing is wanted may be missing."""
        ...

    def gates(self) -> tuple[Gate, ...]:
        """Return the gates as of the last scan."""
        ...

    def soak(self, now: float) -> SoakView | None:
        """Return the soak under way at ``now`` (rig s), None where there is none."""
        ...

    def checks(self) -> tuple[Check, ...]:
        """Return what the connected rig says of its readiness."""
        ...

    def mounted(self) -> tuple[int, str]:
        """Return number and compound of the specimen on the rig, (0, "") for none."""
        ...


class Left(Protocol):
    """What a run left on its rig."""

    @property
    def known(self) -> bool:
        """The run mounted something."""
        ...

    def usable(self, rig: Rig) -> bool:
        """Tell whether it may still be worked with on a rig; else it is taken for changed."""
        ...


class History(Protocol):
    """What the runs in a folder make known of a rig: plain data, which can be hashed and pickled."""

    def checks(self, rig: Rig, left: Left | None, now_utc: str) -> tuple[Check, ...]:
        """Return the kind's part of the pre-flight list before the rig is connected. ``left``: by the newest run."""
        ...


@dataclass(frozen=True, slots=True)
class ByHand:
    """Manual mode, ready to be ticked; ``mounted``: what is taken to be on the rig, in words."""

    run: Run
    executor: ManualExecutor
    mounted: str


class ServedKind(Protocol):
    """A kind, for a service."""

    @property
    def machine(self) -> MachineView:
        """The tables that clients need."""
        ...

    @property
    def quantities(self) -> Quantities:
        """The table of channels."""
        ...

    def title(self, step: Step) -> str:
        """Return a line that says what a step of a plan does."""
        ...

    def panel(self, engine: Engine) -> MachinePanel:
        """Look at a run."""
        ...

    def alone(self, rig: Rig) -> str:
        """Return what the rig's devices do by themselves when the process that owns the rig is gone, in words."""
        ...

    def left(self, reader: RunReader, name: str) -> Left:
        """Return what a stored run of that name left on its rig. Raises StoreError."""
        ...

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: Any, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Put a person in the place of a recipe, bounded by the rig alone; ``left``: what is on it, None = new.

        ``attendant``, ``history``: as the kind's ``KindRun`` has them.
        """
        ...
