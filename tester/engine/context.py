"""What a step of the plan may see and do: the context every activity is handed in every scan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from tester.control.load_loop import LoadLoop
from tester.engine.gates import Gates
from tester.engine.prompts import Prompts
from tester.engine.wheel_life import WheelLife
from tester.interlocks.heat_balance import HeatBalance
from tester.process import Demand, Readings
from tester.rig import RigConfig
from tester.store.recorder import Recorder


class Attendant(Protocol):
    """The hands at the rig: what a person does there. A simulated rig is told; at a real one nothing happens."""

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Mount a new wheel of ``compound``."""
        ...

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Put the wheel of an interrupted run back, as worn as it was (mm, m)."""
        ...

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Mark the start of a repeat (keys of the simulator's random streams)."""
        ...


class Nobody:
    """The attendant of a real rig: people answer prompts, software does nothing."""

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Do nothing: the prompt has been answered."""

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Do nothing: the wheel is still on."""

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Do nothing."""


class Tare(Protocol):
    """The load cell's zero."""

    @property
    def tare(self) -> tuple[float, float, float, float]:
        """Offsets in use: Fx, Fy, Fz in N, Mz in N m."""
        ...

    def set_tare(self, values: tuple[float, float, float, float]) -> None:
        """Use these offsets from now on."""
        ...


@dataclass(slots=True)
class Progress:
    """Where the run is, for people: plain values, overwritten as it goes."""

    step: int = 0
    steps: int = 0
    title: str = "connecting"
    phase: str = ""
    condition: int = 0
    conditions: int = 0
    repeat: int = 0
    repeats: int = 0
    revolutions: float = 0.0
    revolutions_wanted: float = 0.0
    burst: int = 0
    part: int = 1
    """Which of the run's parts this is, and how many there are (tester.campaign)."""
    parts: int = 1


def nothing_to_tell(now: float) -> None:
    """Take note of nothing: a bench without control."""


@dataclass(slots=True)
class Context:
    """One per run; activities read and write it, nothing else."""

    rig: RigConfig
    readings: Readings
    demand: Demand
    gates: Gates
    prompts: Prompts
    journal: Recorder
    """The run's record: events, prompts, tares and trips are queued in order before the scan's outputs leave."""
    attendant: Attendant
    cell: Tare
    wheel: WheelLife
    contact: LoadLoop
    """The press loop: whether it is in contact, and where the wheel was touched."""
    ambient_c: float
    """Air temperature at the rig, degC."""
    wheel_changed: Callable[[float], None] = nothing_to_tell
    """Tells control that another wheel is on the rig, at ambient temperature (s)."""
    heat: HeatBalance | None = None
    """Control's balance of the heater's energy; None on a bench without control."""
    heat_known: str = ""
    """What earlier runs make known of that balance, in words."""
    now: float = 0.0
    dt: float = 0.0
    moving: bool = False
    """Set by an activity while slip, load or yaw is on its way: the next scans come at the sliding rate."""
    sample: tuple[float, ...] = ()
    """The row recorded in the scan before (columns of SAMPLE_COLUMNS)."""
    repeat_key: int = 0
    burst: int = 0
    gate: int = 0
    progress: Progress = field(default_factory=Progress)
