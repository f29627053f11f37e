"""What a step of the plan may see and do: the context every activity is handed in every scan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import Protocol

from tester.analysis.wear_check import WearCheck
from tester.control.load_loop import LoadLoop
from tester.engine.gates import Gates
from tester.engine.prompts import Prompts
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


@dataclass(frozen=True, slots=True)
class CheckReference:
    """The first check of a wheel's diameter in its kind: when, where the press stood, the rubber's temperature."""

    at_s: float
    press_mm: float
    rubber_c: float
    loss_mm: float
    """What was reckoned to be lost by then, mm."""


@dataclass(slots=True)
class WheelLife:
    """The wheel on the rig: which one, and what it has lost.

    The loss between measurements is estimated by the wear law dR = k F v dt / (2 pi R w) with the rig file's k
    (physics: load, wear, transients).
    """

    specimen: int = 0
    replicate: int = 0
    wheel: int = 0
    compound: str = ""
    installed_mm: float = float("nan")
    width_mm: float = 30.0
    loss_mm: float = 0.0
    """Estimated loss of diameter since installation, mm."""
    sliding_m: float = 0.0
    rate_mm3_per_n_m: float = 0.0
    """Wear rate that checks of this wheel have shown; 0: none has, the rig file's is reckoned with."""
    exposure_n_m: float = 0.0
    """Normal force times distance slid since installation: what wear is proportional to."""
    condition: int = 0
    """The last condition that was measured with it; 0: none yet."""
    reference: CheckReference | None = None
    """The first roll check since the wheel was put on, which later ones are held against."""
    by_hand: CheckReference | None = None
    """The same of a person's measurements."""
    last_check: WearCheck | None = None

    @property
    def diameter_mm(self) -> float:
        """Current diameter in mm."""
        return self.installed_mm - self.loss_mm

    def slide(self, force_n: float, slip_m_s: float, dt: float, rate_mm3_per_n_m: float) -> None:
        """Account for ``dt`` seconds of sliding at a normal force in N and a slip speed in m/s."""
        distance = slip_m_s * dt
        self.sliding_m += distance
        self.exposure_n_m += force_n * distance
        rate_mm3_per_n_m = self.rate_mm3_per_n_m or rate_mm3_per_n_m
        self.loss_mm += 2.0 * rate_mm3_per_n_m * force_n * distance / (pi * self.diameter_mm * self.width_mm)


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
