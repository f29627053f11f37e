"""The height of the arm: a sensor that is silent or frozen, and an arm that is where no specimen holds it."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import Row, TrackInputs
from tester.kinds.specimen_on_track.interlocks.witness import (
    STALE_HEIGHT_S,
    THICKNESS_MM,
    WEAR_MM,
    height_s,
    height_span,
)
from tester.machine.row import ACK, LOADED, Interlock
from tester.machine.watches import at_most, within

STALE_HEIGHT_DELAY_S: Final = Parameter(
    "stale_height_delay_s", "s", "50 ms", "one reply may be lost [A]", NOT_NEGATIVE,
    hardest="200 ms", because="at 2 m/s a bare holder grinds along 0.4 m",
)  # fmt: skip
FROZEN_HEIGHT_S: Final = Parameter(
    "frozen_height_s", "s", "1 s", "identical counts of the height with the arm down and the track going [A]",
    hardest="2 s", because="40 readings with noise are never alike",
)  # fmt: skip
HEIGHT_DELAY_S: Final = Parameter(
    "height_delay_s", "s", "100 ms", "... for this long [A]: two polls", NOT_NEGATIVE,
    hardest="500 ms", because="at 2 m/s a bare holder grinds along 1 m",
)  # fmt: skip


def _rests(v: TrackInputs) -> bool:
    """Return whether the sensor should show an arm that rests on its specimen."""
    r = v.readings
    return v.limits.height and v.confirmed and r.lowered and v.demand.lowered and not r.height_silent


ARM_OFF: Final[Row] = Interlock(
    name="arm off its height",
    cause="specimen lost or worn, its holder grinds; or the height sensor is wrong",
    watch=within("height < -(wear + thickness), or > thickness, arm lowered", height_span, "mm"),
    parameters=(WEAR_MM, THICKNESS_MM),
    applies=_rests,
    delay=HEIGHT_DELAY_S,
    when=LOADED,
)

HEIGHT_SILENT: Final[Row] = Interlock(
    name="height sensor silent",
    cause="the sensor of the arm's height does not answer",
    watch=at_most("age > {} with the arm down", height_s, STALE_HEIGHT_S),
    applies=lambda v: v.limits.height,
    delay=STALE_HEIGHT_DELAY_S,
    when=LOADED,
    reset=ACK,
)

HEIGHT_FROZEN: Final[Row] = Interlock(
    name="height sensor frozen",
    cause="it repeats its last reading",
    watch=at_most(
        "counts unchanged for {} while the track is to go",
        lambda v: v.readings.now_s - v.readings.height_changed_s,
        FROZEN_HEIGHT_S,
    ),
    applies=lambda v: v.limits.height and v.demand.track_m_s != 0.0,
    when=LOADED,
)

ROWS: Final[tuple[Row, ...]] = (ARM_OFF, HEIGHT_SILENT, HEIGHT_FROZEN)
