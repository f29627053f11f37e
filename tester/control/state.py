"""What control remembers between scans: mode, latched trip, timers of the interlocks, states of the loops."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from typing import Final

from tester.control.heat_loop import HeatLoop
from tester.control.load_loop import LoadLoop
from tester.interlocks.inputs import StopProgress
from tester.interlocks.row import NOTHING_COMPARED, Compared, Reaction
from tester.process import Setpoints


class Mode(Enum):
    """Operating mode of the rig (docs/safety.md)."""

    IDLE = "idle"
    ARMED = "armed"
    """Every level was found clear; passed through on the way to RUN."""
    RUN = "run"
    HOLD = "hold"
    """Lifted, slip taken out, heat held, drives enabled: until the operator releases it."""
    STOPPING = "stopping"
    """Controlled stop: heat off, lift, both drives ramp down together."""
    COOLDOWN = "cooldown"
    """Unloaded creep, heat off, until the jacket is cool: a hot hub would bake one spot of a standing wheel."""
    FAST_STOP = "fast stop"
    """Lift, quick stop of both drives, heat off, contactor off: all in one scan."""
    EMERGENCY = "emergency stop mirrored"
    """The hardware's emergency stop is open: software has set all its commands to zero."""
    LATCHED = "latched"
    """Nothing moves until the cause is gone, the operator has acknowledged and the rig is armed again."""


@dataclass(frozen=True, slots=True)
class Trip:
    """First cause of a stop ("first-up")."""

    at_s: float
    name: str
    text: str
    reaction: Reaction
    compared: Compared = NOTHING_COMPARED


ACKNOWLEDGED: Final = "acknowledged"
"""Kind of the event that ends a trip; its text is who has acknowledged."""


@dataclass(frozen=True, slots=True)
class Event:
    """Something for the journal: a mode change, a command, a trip, an acknowledgement."""

    at_s: float
    kind: str
    text: str


@dataclass(slots=True)
class ControlState:
    """Everything ``step`` carries from one scan to the next; plain data, copyable."""

    setpoints: Setpoints
    load: LoadLoop
    heat: HeatLoop
    mode: Mode = Mode.IDLE
    mode_since_s: float = 0.0
    trip: Trip | None = None
    held: int = 0
    """Levels that hold in this scan, a bit for each row of the interlock table in its order."""
    tripped: int = 0
    """Rows that have tripped (or warned, while their level stands) since the last acknowledgement."""
    pending_s: list[float] = field(default_factory=list[float])
    """Since when each interlock's level has held (inf = it does not hold), in the table's order."""
    events: list[Event] = field(default_factory=list[Event])
    """Raised since the last scan, in order; the engine takes them out before the outputs leave."""
    last_s: float = float("-inf")
    turning_since_s: float = float("inf")
    """Since when the wheel has been confirmed turning."""
    stop: StopProgress = field(default_factory=StopProgress)
    stop_requested: str = ""
    cooled: bool = False
    """The cool-down of this run is over (or not wanted), whether the jacket got cool or not."""
    ack_until_s: float = float("-inf")
    """An acknowledgement was given: it counts if every cause is gone by then."""
    ack_by: str = ""
    """Who gave it."""
    hub_ceiling: list[tuple[float, float]] = field(default_factory=list[tuple[float, float]])
    """(time, hub setpoint) within ``runaway_window``, falling ones only: the first is the highest."""

    def enter(self, mode: Mode, now_s: float, why: str) -> None:
        """Change the mode and journal it."""
        self.events.append(Event(now_s, "mode", f"{self.mode.value} -> {mode.value}: {why}"))
        self.mode = mode
        self.mode_since_s = now_s
