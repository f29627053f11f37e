"""The tangential force: a cell that is silent, frozen or beyond its range, and forces that cannot be friction."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import Row, TrackInputs
from tester.kinds.specimen_on_track.interlocks.witness import (
    DEAF_N,
    HALF,
    LOST_SHARE,
    is_low,
    least_low_n,
    shows_contact,
)
from tester.machine.row import ACK, CONTROLLED, LOADED, Interlock
from tester.machine.watches import at_least, at_most, condition
from tester.machine.wires import answered_s

STALE_CELL_S: Final = Parameter(
    "stale_cell_s", "s", "100 ms", "age of the force: two readings at the slow scan [A]",
    hardest="500 ms",
    because="friction that grows by 100 N/s, ten times what a track at 10 mm/s makes of rubber, gains 50 N in 500 ms",
)  # fmt: skip
STALE_CELL_DELAY_S: Final = Parameter(
    "stale_cell_delay_s", "s", "50 ms", "one reply may be lost [A]", NOT_NEGATIVE,
    hardest="200 ms", because="with the age before it the force is unknown for 0.7 s at most",
)  # fmt: skip


def _cell_s(v: TrackInputs) -> float:
    return answered_s(v.readings.cell_silent, v.readings.now_s, v.readings.cell_at_s)


CELL_SILENT: Final[Row] = Interlock(
    name="load cell silent",
    cause="load cell, its transmitter or its line does not answer",
    watch=at_most("age > {} with the arm down", _cell_s, STALE_CELL_S),
    delay=STALE_CELL_DELAY_S,
    when=LOADED,
    reset=ACK,
)

INVALID_DELAY_S: Final = Parameter(
    "invalid_cell_delay_s", "s", "50 ms", "a reading that its own status denies, or beyond the range [A]", NOT_NEGATIVE,
    hardest="200 ms", because="a broken bridge is at the end of its range at once; nothing better comes of waiting",
)  # fmt: skip

CELL_INVALID: Final[Row] = Interlock(
    name="load cell saturated",
    cause="load cell open, overloaded, or denied by its transmitter's status",
    watch=condition("reading not valid", lambda v: not v.readings.cell_valid),
    applies=lambda v: not v.readings.cell_silent and not v.attended,
    delay=INVALID_DELAY_S,
)

OVERLOAD_DELAY_S: Final = Parameter(
    "overload_delay_s", "s", "20 ms", "above limits.force for this long [A]", NOT_NEGATIVE,
    hardest="50 ms",
    because="a specimen that catches at 2 m/s draws the arm's spring, 200 N/mm, by 200 N in half a millisecond",
)  # fmt: skip


def _force_n(v: TrackInputs) -> float:
    return abs(v.readings.force_n)


OVERLOAD: Final[Row] = Interlock(
    name="overload",
    cause="force beyond what the cell may take: the specimen catches",
    watch=at_most("|force| > {}", _force_n, "limits.force_n"),
    applies=lambda v: not v.attended and v.readings.cell_valid,
    delay=OVERLOAD_DELAY_S,
)

FROZEN_CELL_S: Final = Parameter(
    "frozen_cell_s", "s", "1 s", "identical counts of the cell with the arm down and the track going [A]",
    hardest="2 s",
    because="20 readings of a cell with noise of many counts are never alike; at 10 mm/s 2 s are 20 mm of travel",
)  # fmt: skip

CELL_FROZEN: Final[Row] = Interlock(
    name="load cell frozen",
    cause="the transmitter repeats its last reading",
    watch=at_most(
        "counts unchanged for {} while the track is to go",
        lambda v: v.readings.now_s - v.readings.cell_changed_s,
        FROZEN_CELL_S,
    ),
    applies=lambda v: v.demand.track_m_s != 0.0,
    when=LOADED,
)

RAISED_N: Final = Parameter(
    "raised_n", "N", "4 N", "force with the arm raised, after the tare [A]: zero drift is 0.4 N over 80 K",
    hardest="10 N", because="half of 20 N: a specimen that touches at the raised arm, or a cell whose zero has gone",
)  # fmt: skip
RAISED_DELAY_S: Final = Parameter(
    "raised_delay_s", "s", "500 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="2 s", because="a contact that opens has let go in some tenths of a second",
)  # fmt: skip


def _weighs_nothing(v: TrackInputs) -> bool:
    """Return whether the cell should show no force: arm raised, cell tared and valid."""
    r = v.readings
    return v.confirmed and r.raised and v.demand.tared and not v.demand.lowered and r.cell_valid


FORCE_RAISED: Final[Row] = Interlock(
    name="force with the arm raised",
    cause="the specimen touches though the arm is raised, or the cell's zero has gone",
    watch=at_most("|force| > {}, arm raised, cell tared", _force_n, RAISED_N),
    applies=_weighs_nothing,
    delay=RAISED_DELAY_S,
    reaction=CONTROLLED,
)

CONTACT_WAY_MM: Final = Parameter(
    "contact_way_mm", "mm", "0.8 mm", "... after this way one way: the arm's spring is drawn by then [A] ...",
    hardest="5 mm", because="100 N each way draw a spring of 200 N/mm by 1 mm",
)  # fmt: skip
LOST_DELAY_S: Final = Parameter(
    "lost_delay_s", "s", "200 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="2 s", because="at 2 m/s a bare holder grinds along 4 m of the track in 2 s",
)  # fmt: skip


def _least_n(v: TrackInputs) -> float:
    """Return the least friction that counts as contact, N."""
    p, load_n, least_mu = v.parameters, v.readings.load_n, v.demand.least_mu
    share = p[LOST_SHARE]
    if is_low(least_mu, share):
        # The recipe lowers the level only where another reading shows contact, and never to what a deaf cell may show.
        return least_low_n(p[DEAF_N], least_mu, load_n) if shows_contact(v) else share * load_n
    return max(share, HALF * least_mu) * load_n


def _slides(v: TrackInputs) -> bool:
    way_m = 1e-3 * v.parameters[CONTACT_WAY_MM]
    return v.confirmed and v.demand.track_m_s != 0.0 and v.demand.sliding_m > way_m


CONTACT_LOST: Final[Row] = Interlock(
    name="contact lost",
    cause="no friction where the specimen is to slide: it is worn away or out of its holder, or the cell is deaf",
    watch=at_least(
        "friction < lost_share of the load after contact_way; < deaf where least_friction is less and height shows"
        " contact",
        lambda v: v.readings.friction_n,
        _least_n,
        "N",
    ),
    parameters=(LOST_SHARE, DEAF_N, CONTACT_WAY_MM),
    applies=_slides,
    delay=LOST_DELAY_S,
    when=LOADED,
)

FRICTION_SHARE: Final = Parameter(
    "friction_share", "1", "4", "force above this times the weights ... [A]: rubber at rest has 2.7",
    hardest="6", because="with 20 N six times is 120 N, and the cell of these rigs ends at 200 N",
)  # fmt: skip
FRICTION_LEAST_N: Final = Parameter(
    "friction_least_n", "N", "5 N", "... and this beside it [A] ...", NOT_NEGATIVE,
    hardest="20 N", because="the zero of the cell is known to some newtons before the tare, afterwards to a tenth",
)  # fmt: skip
FRICTION_DELAY_S: Final = Parameter(
    "friction_delay_s", "s", "100 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="500 ms", because="a block that digs itself in tears within a few millimetres",
)  # fmt: skip


def _most_n(v: TrackInputs) -> float:
    return v.parameters[FRICTION_SHARE] * v.readings.load_n + v.parameters[FRICTION_LEAST_N]


BEYOND_LOAD: Final[Row] = Interlock(
    name="friction beyond load",
    cause="more force than rubber can have under these weights: it digs in, or other weights hang on the arm",
    watch=at_most("|force| > friction_share x weights + friction_least", _force_n, _most_n, "N"),
    parameters=(FRICTION_SHARE, FRICTION_LEAST_N),
    applies=lambda v: v.demand.tared and v.readings.lowered,
    delay=FRICTION_DELAY_S,
    when=LOADED,
)


ROWS: Final[tuple[Row, ...]] = (
    CELL_SILENT, CELL_INVALID, CELL_FROZEN, OVERLOAD, BEYOND_LOAD, CONTACT_LOST, FORCE_RAISED,
)  # fmt: skip
