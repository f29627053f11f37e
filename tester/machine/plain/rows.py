"""The interlock rows of every plain machine, and their inputs. A kind puts its own rows before them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final, Generic, TypeAlias, TypeVar

from tester.base.deriving import derivable
from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.drive_rows import (
    ACK_WAIT_S,
    DRIVE_DATA_STALE,
    drive_dropped_out,
    keeps_power,
    not_stopping,
    quick_stop_failed,
    stop_not_ended,
)
from tester.machine.inputs import ScanInputs
from tester.machine.interlock_table import InterlockTable
from tester.machine.plain.image import PlainDemand, PlainReadings
from tester.machine.row import ACK, ENDING, LOADED, POWER_OFF, Interlock
from tester.machine.state import ControlState
from tester.machine.watches import at_most, condition
from tester.machine.wires import DEVICE_REFUSED, INPUTS_STALE, LINE_NOISY, WARNINGS
from tester.machine.wires import ROWS as WIRE_ROWS

ReadingsT = TypeVar("ReadingsT", bound=PlainReadings)


@dataclass(frozen=True, slots=True)
class PlainLimits:
    """Limits of the conditions beside their parameters, from the rig file's other sections."""

    heartbeat_s: float
    """The rig file's ``can.drive_heartbeat``."""
    ramp_s: float
    quick_stop_s: float
    """Longest times of a drive from its greatest speed to standstill: by its ramp, and by its quick stop."""


@derivable
class PlainInputs(ScanInputs, Generic[ReadingsT]):
    """One scan, as the rows of a plain machine see it. ``loaded`` stays True: contact cannot be excluded."""

    rig: PlainRig = field(kw_only=True)
    readings: ReadingsT = field(kw_only=True)
    demand: PlainDemand = field(default_factory=PlainDemand)
    limits: PlainLimits = field(init=False)

    def __post_init__(self) -> None:
        """Read the limits from the rig file."""
        axes = self.rig.axes.values()
        self.limits = PlainLimits(
            self.rig.can.drive_heartbeat_s,
            max(one.max_speed / one.deceleration for one in axes),
            max(one.max_speed / one.quick_stop_deceleration for one in axes),
        )

    def look(self, state: ControlState[Any], demand: PlainDemand, readings: ReadingsT, scan_s: float) -> None:
        """Update the inputs from this scan's demand and readings."""
        self.readings, self.demand = readings, demand
        self.note_times(state, readings.now_s, scan_s)
        self.attended = demand.attended
        self.note_drives(state.mode, demand, readings)


AnyInputs = PlainInputs[PlainReadings]
Row: TypeAlias = Interlock[AnyInputs]

DROPPED_DELAY_S: Final = Parameter(
    "dropped_delay_s", "s", "50 ms", "a drive leaves operation by itself, or has power at rest [A]", NOT_NEGATIVE,
    hardest="100 ms", because="one scan of 20 Hz may see a drive on its way; two may not",
)  # fmt: skip


DRIVE_DROPPED_OUT: Final = drive_dropped_out(DROPPED_DELAY_S)

OVERSPEED_SHARE: Final = Parameter(
    "overspeed_share", "1", "5 %", "above its greatest speed by this share [A]", NOT_NEGATIVE,
    hardest="10 %", because="a drive that follows its ramp does not overshoot by a tenth",
)  # fmt: skip
OVERSPEED_DELAY_S: Final = Parameter(
    "overspeed_delay_s", "s", "50 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="100 ms", because="a runaway drive gains with every scan that waits",
)  # fmt: skip


def _fastest(v: AnyInputs) -> float:
    """Return the greatest speed as a share of its axis's limit; NaN if a speed is unknown."""
    shares = [
        abs(v.readings.drives.get(name, float("nan"))) / axis.max_speed
        for name, axis in v.rig.axes.items()
    ]
    return max(shares, key=lambda share: (share != share, share))


OVERSPEED: Final[Row] = Interlock(
    name="overspeed",
    cause="a drive is faster than its axis may be",
    watch=at_most(
        "speed > max_speed + overspeed_share", _fastest, lambda v: 1.0 + v.parameters[OVERSPEED_SHARE], "1"
    ),
    parameters=(OVERSPEED_SHARE,),
    applies=lambda v: not v.readings.drives_disabled,
    delay=OVERSPEED_DELAY_S,
)

STALE_SENSOR_S: Final = Parameter(
    "stale_sensor_s", "s", "200 ms", "age of what a sensor measures; what it calls invalid is too old at once",
    hardest="500 ms", because="a row that looks at a sensor is blind that long",
)  # fmt: skip

SENSOR_SILENT: Final[Row] = Interlock(
    name="sensor silent",
    cause="a sensor does not answer, or reports an invalid reading",
    watch=at_most("age > {}, or invalid", lambda v: v.readings.now_s - v.readings.sensors_at_s, STALE_SENSOR_S),
    when=LOADED,
    unseen=True,
    reset=ACK,
)

STOP_MARGIN_S: Final = Parameter(
    "stop_margin_s", "s", "500 ms", "drives may stand this much later than their ramps say [A]",
    hardest="1 s", because="a drive that does not stop loses its power after two of these",
)  # fmt: skip


def _standing(v: AnyInputs) -> bool:
    return v.readings.standing


NOT_STOPPING: Final = not_stopping(
    lambda v: v.limits.ramp_s + v.parameters[STOP_MARGIN_S],
    _standing,
    cause="a drive turns longer than its ramp allows",
    level="turning at max_speed / deceleration + stop_margin after the stop",
    parameters=(STOP_MARGIN_S,),
)
QUICK_STOP_FAILED: Final = quick_stop_failed(
    lambda v: v.limits.quick_stop_s + v.parameters[STOP_MARGIN_S],
    _standing,
    cause="a drive turns longer than its quick stop allows",
    level="turning at max_speed / quick-stop deceleration + stop_margin after it began",
    margin=STOP_MARGIN_S,
)

STOP_TIMEOUT_S: Final = Parameter(
    "stop_timeout_s", "s", "10 s", "a stop that has not ended by then takes the power off and latches [A]",
    hardest="15 s", because="every part of a stop has been escalated by then; nothing gets better by waiting longer",
)  # fmt: skip


STOP_NOT_ENDED: Final = stop_not_ended(
    "a stop has not come to standstill", "stop_timeout after it began", STOP_TIMEOUT_S
)

REST_AFTER_S: Final = Parameter(
    "rest_after_s", "s", "500 ms", "data of a drive at rest that are older say nothing [A]",
    hardest="1 s", because="the scan at rest comes ten times a second",
)  # fmt: skip


def _moving_at_rest(v: AnyInputs) -> bool:
    r = v.readings
    known = r.now_s - r.drives_at_s <= v.parameters[REST_AFTER_S]
    if keeps_power(v):
        return True
    if v.resting or v.demand.enabled:
        return not (known and r.standing)
    return not (known and r.drives_disabled)


MOVING_AT_REST: Final[Row] = Interlock(
    name="moving at rest",
    cause="a drive turns, or has power, although everything is to rest",
    watch=condition("not known to stand; in a run: power that is not wanted", _moving_at_rest),
    applies=lambda v: v.resting or v.unpowered,
    parameters=(REST_AFTER_S,),
    delay=DROPPED_DELAY_S,
    when=ENDING,
    at_rest=lambda v: not v.readings.drives_disabled,
    reaction=POWER_OFF,
)

HOLD_AT_MOST_S: Final = Parameter(
    "hold_at_most_s", "s", "60 min", "a hold ends in a controlled stop after this [A]",
    hardest="120 min", because="no operator attends a powered machine for longer than that",
)  # fmt: skip
OPERATION: Final = (HOLD_AT_MOST_S, ACK_WAIT_S)
ABOUT: Final = "holds and acknowledgements"
"""Purpose of the parameters that belong to no row."""

ROWS: Final[tuple[Interlock[Any], ...]] = (
    INPUTS_STALE, DEVICE_REFUSED, LINE_NOISY, DRIVE_DATA_STALE, DRIVE_DROPPED_OUT, OVERSPEED, NOT_STOPPING,
    QUICK_STOP_FAILED, STOP_NOT_ENDED, MOVING_AT_REST,
)  # fmt: skip


def plain_table(*own: Interlock[Any]) -> InterlockTable:
    """Return the interlock table of a kind with rows of its own.

    The row of a silent sensor comes before the rows that watch its values: a trip then names the silence.
    """
    return InterlockTable((*WIRE_ROWS, SENSOR_SILENT, *own, *ROWS, *WARNINGS), OPERATION)
