"""Stops that fail, motion where everything must rest, and the bounds of holds, acknowledgements and the cell's zero."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import SPEEDS_OLD_S, STANDING_SHARE, Row, TrackInputs, standing
from tester.kinds.specimen_on_track.interlocks.motion import DROPPED_DELAY_S
from tester.machine.drive_rows import ACK_WAIT_S, keeps_power, not_stopping, quick_stop_failed, stop_not_ended
from tester.machine.row import ENDING, POWER_OFF, Interlock
from tester.machine.watches import condition

STOP_MARGIN_S: Final = Parameter(
    "stop_margin_s", "s", "600 ms", "the track may stop this much later than its ramp [A]; it is also seen late",
    hardest="800 ms",
    because="a track that does not stop loses its power after two of these; a rig is to be safe 3 s after its trip",
)  # fmt: skip


def _ramp_s(v: TrackInputs) -> float:
    return v.stop_start.speed_m_s / v.limits.deceleration_m_s2 + v.parameters[STOP_MARGIN_S]


NOT_STOPPING: Final = not_stopping(
    _ramp_s,
    standing,
    cause="the track moves longer than its ramp allows",
    level="speed >= standing_share at v / deceleration + stop_margin",
    parameters=(STOP_MARGIN_S, STANDING_SHARE, SPEEDS_OLD_S),
)


def _quick_s(v: TrackInputs) -> float:
    return v.stop_start.fast_speed_m_s / v.limits.quick_stop_m_s2 + v.parameters[STOP_MARGIN_S]


QUICK_STOP_FAILED: Final = quick_stop_failed(
    _quick_s,
    standing,
    cause="the track moves longer than its quick stop allows",
    level="speed >= standing_share at v / quick-stop deceleration + stop_margin",
    margin=STOP_MARGIN_S,
)

OFF_DELAY_S: Final = Parameter(
    "off_delay_s", "s", "500 ms", "with its drive commanded off the track moves for this long [A]", NOT_NEGATIVE,
    hardest="1 s",
    because="the track was at rest: a track that moves obeys nothing, and a person is about to come near",
)  # fmt: skip


NOT_SWITCHED_OFF: Final[Row] = Interlock(
    name="not switched off",
    cause="the track moves although the drives are commanded off",
    watch=condition(
        "in a run, drives not wanted, power still on and speed >= standing_share",
        lambda v: not (v.resting or v.demand.enabled or v.readings.drives_disabled or standing(v)),
    ),
    parameters=(STANDING_SHARE,),
    applies=lambda v: not v.stopped_s >= 0.0,
    delay=OFF_DELAY_S,
)

STOP_TIMEOUT_S: Final = Parameter(
    "stop_timeout_s", "s", "6 s", "a stop that has not ended by then takes the power off and latches [A]",
    hardest="10 s",
    because="every part of a stop has been escalated 3 s after it began; nothing gets better by waiting longer",
)  # fmt: skip


STOP_NOT_ENDED: Final = stop_not_ended(
    "a stop has not ended: the track is not known to stand, or the chamber to be off",
    "stop_timeout after it began, and once more after the power was taken",
    STOP_TIMEOUT_S,
)


def _moving(v: TrackInputs) -> bool:
    r = v.readings
    if keeps_power(v):
        return True
    if v.resting or v.demand.enabled:
        return not standing(v)
    since = r.now_s - v.parameters[SPEEDS_OLD_S]
    return not (r.drives_disabled and r.track_at_s >= since and r.lift_at_s >= since)


MOVING_AT_REST: Final[Row] = Interlock(
    name="moving at rest",
    cause="the track moves, or a drive has power, although everything should be at rest",
    watch=condition("speed >= standing_share or unknown; in a run: power that is not wanted", _moving),
    parameters=(STANDING_SHARE, SPEEDS_OLD_S),
    # A stop that still waits for its chamber has disabled the voltage already.
    applies=lambda v: v.resting or v.unpowered or keeps_power(v),
    delay=DROPPED_DELAY_S,
    when=ENDING,
    at_rest=lambda v: not v.readings.drives_disabled,
    reaction=POWER_OFF,
)

ROWS: Final[tuple[Row, ...]] = (NOT_SWITCHED_OFF, QUICK_STOP_FAILED, NOT_STOPPING, STOP_NOT_ENDED, MOVING_AT_REST)


HOLD_AT_MOST_S: Final = Parameter(
    "hold_at_most_s", "s", "60 min", "a hold ends in a controlled stop after this [A]",
    hardest="120 min", because="no operator attends a rig with its drives on for longer than that",
)  # fmt: skip
ZERO_STOP_N: Final = Parameter(
    "zero_stop_n", "N", "10 N", "a zero of the cell further off than this is not taken: the run ends [A]",
    hardest="20 N", because="a tare of 20 N may hide a contact as firm as any of these rigs has",
)  # fmt: skip

OPERATION: Final[tuple[Parameter, ...]] = (HOLD_AT_MOST_S, ACK_WAIT_S, ZERO_STOP_N)
ABOUT: Final = "holds, acknowledgements, the cell's zero"
"""The parameters of the section ``interlocks`` that belong to no row, and their purpose."""
