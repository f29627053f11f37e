"""Control's state between scans: mode, latched trip, timers of the interlocks, the stop under way."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import Final, Generic, TypeVar

from tester.base.words import duration
from tester.machine.image import BaseSetpoints
from tester.machine.row import NOTHING_COMPARED, Compared, Reaction


class Mode(Enum):
    """Operating mode of the rig (docs/safety.md)."""

    IDLE = "idle"
    ARMED = "armed"
    """Every level is clear; an intermediate mode before RUN."""
    RUN = "run"
    HOLD = "hold"
    """Contact open, heat held, drives enabled: until the operator releases it."""
    STOPPING = "stopping"
    """Controlled stop: heat off, contact opened, drives ramp down together."""
    COOLDOWN = "cooldown"
    """Heat off, unloaded creep until the machine is cool, for a machine that would be damaged by stopping hot."""
    FAST_STOP = "fast stop"
    """Contact opened, quick stop of every drive, heat off: all in one scan."""
    EMERGENCY = "emergency stop mirrored"
    """The hardware's emergency stop is open: software has set all its commands to zero."""
    LATCHED = "latched"
    """Nothing moves until the cause is gone, the operator has acknowledged and the rig is armed again."""


@dataclass(frozen=True, slots=True)
class Trip:
    """The trip that stopped the run first ("first-up")."""

    at_s: float
    name: str
    text: str
    reaction: Reaction
    compared: Compared = NOTHING_COMPARED


HELD: Final = "held"
"""Kind of the event at the end of a hold; the event's text is the duration."""
ACKNOWLEDGED: Final = "acknowledged"
"""Kind of the event that ends a trip; the event's text names the person who acknowledged."""


@dataclass(frozen=True, slots=True)
class ControlEvent:
    """An event for the journal: a mode change, a command, a trip, an acknowledgement."""

    at_s: float
    kind: str
    text: str


@dataclass(slots=True)
class StopProgress:
    """The stop under way."""

    began_s: float = inf
    """Time at which the rig left RUN, HOLD or COOLDOWN; infinity while no stop is under way."""
    fast_s: float = inf
    """Time at which the quick stop began."""
    creeps: bool = False
    """Whether the cool-down keeps something turning on purpose."""


SetpointsT_co = TypeVar("SetpointsT_co", bound=BaseSetpoints, covariant=True)


class ControlState(Generic[SetpointsT_co]):
    """The state that ``Control.step`` keeps from one scan to the next: plain data, copyable. A kind adds its loops."""

    def __init__(self, setpoints: SetpointsT_co) -> None:
        """Begin in idle; ``setpoints``: the devices' setpoints."""
        self.setpoints = setpoints
        self.mode = Mode.IDLE
        self.mode_since_s = 0.0
        self.trip: Trip | None = None
        self.held = 0
        """Levels that hold in this scan, a bit for each row of the interlock table in its order."""
        self.tripped = 0
        """Rows that have tripped (or warned, while their level holds) since the last acknowledgement."""
        self.pending_s: list[float] = []
        """Time since when each interlock's level has held (inf = it does not hold), in the table's order."""
        self.events: list[ControlEvent] = []
        """Events since the last scan, in order; the engine removes them before the outputs leave."""
        self.last_s = -inf
        self.last_late_s = 0.0
        """Lateness of the last scan beyond its period, s."""
        self.last_period_s = 0.0
        """Period before the last scan, s."""
        self.stop = StopProgress()
        self.stop_requested = ""
        self.unwanted_s = inf
        """Time since when no drive needs power: none is enabled, and no stop moves one; inf while one needs it."""
        self.cooled = False
        """Whether the cool-down of this run is over (or not wanted), even if not everything became cool."""
        self.ack_until_s = -inf
        """Deadline of a pending acknowledgement: it counts if every cause is gone by then."""
        self.ack_by = ""
        """Name of the person who acknowledged."""

    def enter(self, mode: Mode, now_s: float, why: str) -> None:
        """Change the mode and journal it; at the end of a hold, journal its duration."""
        if self.mode is Mode.HOLD:
            self.events.append(ControlEvent(now_s, HELD, f"HOLD lasted {duration(now_s - self.mode_since_s)}"))
        self.events.append(ControlEvent(now_s, "mode", f"{self.mode.value} -> {mode.value}: {why}"))
        self.mode = mode
        self.mode_since_s = now_s
