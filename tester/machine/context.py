"""The context of every activity in every scan: what a step of the plan may read and write."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeAlias, TypeVar

from tester.base.deriving import mypyc_attr
from tester.inputs.rig import Rig
from tester.machine.hardness import HardnessBelief, keep_hardness
from tester.machine.image import BaseDemand, BaseReadings
from tester.machine.prompts import Prompt, Prompts
from tester.store.recorder import Recorder
from tester.store.records import PieceInfo

if TYPE_CHECKING:
    from tester.inputs.recipe.plain_recipe import Mount  # the recipe's schema, which a run does not need


@dataclass(slots=True)
class Progress:
    """Where the run is, for people: plain values that are overwritten during the run."""

    step: int = 0
    steps: int = 0
    title: str = "connecting"
    phase: str = ""
    condition: int = 0
    """Number of the present condition, 0 before the first."""
    repeat: int = 0
    repeats: int = 0
    revolutions: float = 0.0
    revolutions_wanted: float = 0.0
    burst: int = 0


@dataclass(slots=True)
class MountedSpecimen:
    """The specimen on the machine; ``number`` counts the mounted pieces from 1, 0 if there is none."""

    number: int = 0
    specimen: int = 0
    compound: str = ""
    sliding_m: float = 0.0


RigT_co = TypeVar("RigT_co", bound=Rig, covariant=True)
ReadingsT_co = TypeVar("ReadingsT_co", bound=BaseReadings, covariant=True)
DemandT_co = TypeVar("DemandT_co", bound=BaseDemand, covariant=True)


@mypyc_attr(allow_interpreted_subclasses=True)
class BaseContext(Generic[RigT_co, ReadingsT_co, DemandT_co]):
    """The context of one run: the only object that activities read and write. A kind adds its specimen, gates and
    devices.

    The engine calls the methods at fixed places of a scan (``tester.machine``).
    """

    gate_bits: ClassVar[Mapping[str, int]] = {}
    """Bits of the gates in ``gate``, the channel of that name, by the gates' keys on the screen, in its order."""

    def __init__(
        self,
        rig: RigT_co,
        readings: ReadingsT_co,
        demand: DemandT_co,
        prompts: Prompts,
        journal: Recorder,
    ) -> None:
        """``journal``: the run's record. Events, prompts and trips are queued in order before the outputs leave."""
        self.rig = rig
        self.readings = readings
        self.demand = demand
        self.prompts = prompts
        self.journal = journal
        self.now = 0.0
        self.dt = 0.0
        self.moving = False
        """Set by an activity while something that is measured is moving: the next scans run at the sliding rate."""
        self.sample: tuple[float, ...] = ()
        """The row recorded in the previous scan: a value for each recorded channel."""
        self.setpoints: Any = None
        """The scan's setpoints, for the record; the kind defines the class."""
        self.repeat_key = 0
        self.burst = 0
        self.gate = 0
        """Mask of the closed gates; 0 if this scan counts."""
        self.progress = Progress()
        self.mounted = MountedSpecimen()
        self.hardness = HardnessBelief()
        """Of the compounds whose hardness the run asks for at mounting."""
        self.counted_on: list[str] = []
        """Lines about hardware that the run counts on, for its record; a real rig's run prints them."""

    def before_reading(self) -> None:
        """Write to the image what the devices need before they fill it."""

    def after_reading(self) -> None:
        """Update the state of the specimen with this scan; ``dt`` is the scan's length, s."""

    def closed_gates(self) -> int:
        """Return the mask of the gates that are closed in this scan in RUN."""
        return 0

    def after_control(self) -> None:
        """Read what control has just made of the demand."""

    def calm(self) -> tuple[float, ...]:
        """Return the temperatures of a machine on which only heat flows, degC; () while anything else may happen.

        Every axis is then unloaded, and at rest or at its constant speed. By default every scan is made: a kind takes
        part whose results do not depend on readings in such a time (``tester.machine.leaps``), and whose readings can
        be moved (``later``).
        """
        return ()

    def touching(self) -> bool:
        """Return whether contact is demanded or measured; every scan is then recorded."""
        return False

    def mount(self, step: Mount, prompt: Prompt | None = None) -> None:
        """Note the new specimen that a person has just put on, and record it.

        ``prompt``: the answered question, where it asked for the hardness.
        """
        self.mounted = MountedSpecimen(step.piece, step.specimen, step.compound)
        self.journal.piece_mounted(
            PieceInfo(step.piece, step.specimen, step.replicate, step.compound, self.now, nan, nan, updated_s=self.now)
        )
        if step.hardness and prompt is not None:
            keep_hardness(self, prompt, step.piece, step.compound)

    def piece(self) -> tuple[int, float, float]:
        """Return the specimen's number (0 if none), diameter in mm (NaN if it has none) and sliding distance in m."""
        return self.mounted.number, nan, self.mounted.sliding_m

    def record_piece(self, recorder: Recorder, now_s: float) -> None:
        """Record the state of the specimen at ``now_s``, if there is one."""
        number, diameter_mm, sliding_m = self.piece()
        if number:
            recorder.piece_state(number, diameter_mm, sliding_m, now_s)

    def known(self) -> list[str]:
        """Return what earlier runs have measured of this rig, a line each, for the journal at arming."""
        return []


AnyContext: TypeAlias = BaseContext[Rig, BaseReadings, BaseDemand]
