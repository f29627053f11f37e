"""Common inputs of interlock conditions: the timing of the scan, and the present activity.

A kind's inputs inherit from this and add its readings, demand, setpoints and whatever several conditions need. Unknown
values stay NaN, infinite or at the value that trips.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, nan
from typing import Any, Final

from tester.base.deriving import mypyc_attr
from tester.inputs.rig import Rig
from tester.inputs.rig.further_sensors import further_channels
from tester.inputs.rig.parameter import Values
from tester.machine.image import BaseDemand, BaseReadings
from tester.machine.state import ControlState, Mode, StopProgress

# Bound once: a look-up on the enum class costs several times as much in every scan (CPython 3.11).
_HOLD: Final = Mode.HOLD
_RUN: Final = Mode.RUN
_COOLDOWN: Final = Mode.COOLDOWN
_IDLE: Final = Mode.IDLE
_ARMED: Final = Mode.ARMED
_LATCHED: Final = Mode.LATCHED


@mypyc_attr(allow_interpreted_subclasses=True)
@dataclass(slots=True)
class ScanInputs:
    """One scan, as the interlock table sees it."""

    parameters: Values = field(init=False)
    stop: StopProgress = field(init=False)
    scan_s: float = 0.0
    """Period of the scan, s."""
    last_s: float = -inf
    """Time of the previous scan."""
    late_s: float = inf
    """Lateness of this scan beyond its period, s."""
    late_before_s: float = 0.0
    """Lateness of the previous scan beyond its period, s."""
    slower_before_s: float = 0.0
    """By how much the previous scan's period was longer than this one's, s; 0 if it was not."""
    mode_since_s: float = 0.0
    """Time since when the rig has been in its mode."""
    loaded: bool = True
    """Contact is wanted or cannot be excluded. The kind writes it in every scan."""
    stopped_s: float = -inf
    """How long a stop has been under way; -inf while none is."""
    lifting_s: float = -inf
    """How long a stop or a hold has been lifting; -inf while neither is."""
    resting: bool = True
    """Everything should be at rest: idle, armed or latched."""
    voltage_off: bool = False
    """The last scan disabled every drive's voltage: a drive that reports power does not obey, or repeats old data."""
    unpowered: bool = False
    """A run that does not want the drives has seen them without power: nothing may move until all are in operation
    again. The kind writes it in every scan.
    """
    confirmed: bool = False
    """Every drive has been in operation since the drives were last demanded, and something commands them. The kind
    writes it in every scan.
    """
    wanted_since_s: float = inf
    """Time since when something commands the drives; inf while nothing does. The kind writes it in every scan."""
    attended: bool = False
    """A person was asked to come near; the person's effect on sensors is no fault."""

    seen: tuple[object, ...] | None = None
    """What ``seldom`` returned when the rows with ``when=SELDOM`` were last evaluated ..."""
    seen_held: int = 0
    """... and the bits of those that held."""

    further_places: dict[str, int] = field(default_factory=dict[str, int])
    """Index in ``readings.channels`` of each channel of a further sensor, by its name."""

    def seldom(self) -> tuple[object, ...] | None:
        """Return all that the rows with ``when=SELDOM`` read, besides what a rig file fixes: while it stays the same,
        their verdicts stay. None, unless a kind defines it: they are evaluated in every scan.
        """
        return None

    def note_further(self, rig: Rig) -> None:
        """Store the indices of the rig's further channels."""
        self.further_places = {channel.name: place for place, channel in enumerate(further_channels(rig))}

    def further(self, channels: list[float], name: str) -> float:
        """Return a further sensor's present value from ``readings.channels``; NaN, which trips, while the value is
        unknown.
        """
        place = self.further_places.get(name, len(channels))
        return channels[place] if place < len(channels) else nan

    def note_times(self, state: ControlState[Any], now_s: float, scan_s: float) -> None:
        """Update the times of this scan, of the mode and of the stop."""
        self.scan_s = scan_s
        self.last_s = last_s = state.last_s
        self.late_s = now_s - last_s - scan_s
        self.late_before_s = state.last_late_s
        slower_s = state.last_period_s - scan_s
        self.slower_before_s = slower_s if slower_s > 0.0 else 0.0
        self.mode_since_s = state.mode_since_s
        mode = state.mode
        self.stopped_s = self.lifting_s = now_s - state.stop.began_s
        if mode is _HOLD:
            self.lifting_s = now_s - state.mode_since_s
        self.resting = mode is _IDLE or mode is _LATCHED or mode is _ARMED
        self.voltage_off = state.setpoints.voltage_off

    def note_drives(self, mode: Mode, demand: BaseDemand, readings: BaseReadings) -> bool:
        """Update what follows from the drives; return whether all of them have just come into operation."""
        working, before = mode is _RUN or mode is _HOLD, self.confirmed
        commanded = (working or mode is _COOLDOWN) and demand.enabled
        self.confirmed = commanded and (before or readings.drives_enabled)
        if not commanded:
            self.wanted_since_s = inf
        elif self.wanted_since_s == inf:
            self.wanted_since_s = readings.now_s
        if self.confirmed or not working:
            self.unpowered = False
        elif not demand.enabled and readings.drives_disabled:
            self.unpowered = True
        return self.confirmed and not before
