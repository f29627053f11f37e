"""Load and friction: the load cell's readings, their credibility, and the greatest force of the contact."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import AT_LEAST_ONE, NOT_NEGATIVE, SHARE, Direction, Parameter
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N, depth_mm
from tester.kinds.wheel_on_belt.interlocks.inputs import SPEEDS_OLD_S, Inputs, Row
from tester.machine.row import ACK, LOADED, Compared, Interlock
from tester.machine.watches import at_least, at_most, condition
from tester.machine.wires import answered_s

STALE_CELL_S: Final = Parameter(
    "stale_cell_s", "s", "50 ms", "age of the load",
    hardest="100 ms", because="loading at 2 mm/s brings 34 N in 0.1 s (172 N/mm at 400 N)",
)  # fmt: skip
STALE_CELL_DELAY_S: Final = Parameter(
    "stale_cell_delay_s", "s", "50 ms", "one reply may be lost [A]", NOT_NEGATIVE,
    hardest="100 ms", because="loading at 2 mm/s brings 34 N in 0.1 s (172 N/mm at 400 N)",
)  # fmt: skip

CELL_SKEW_S: Final = Parameter(
    "cell_skew_s", "s", "30 ms", "a cell of several transmitters: its parts are read this far apart at most [A]",
    hardest="50 ms", because="a part that is older than another by stale_cell is stale itself",
)  # fmt: skip


def _cell_answered_s(v: Inputs) -> float:
    r = v.readings
    return answered_s(r.cell_silent, r.now_s, r.cell_at_s)


def _cell_still_old(v: Inputs) -> bool:
    r = v.readings
    return not (r.cell_at_s >= r.now_s - v.parameters[SPEEDS_OLD_S])


CELL_SILENT: Final[Row] = Interlock(
    name="load cell silent",
    cause="cable, supply or address; the load is not known",
    watch=at_most(
        "age > {} (of a transmitter, or its parts more than cell_skew apart), or several requests without an answer",
        _cell_answered_s,
        STALE_CELL_S,
    ),
    unseen=_cell_still_old,
    parameters=(CELL_SKEW_S,),
    delay=STALE_CELL_DELAY_S,
    when=LOADED,
    reset=ACK,
)

CELL_SATURATED: Final[Row] = Interlock(
    name="load cell saturated",
    cause="a channel at 98 % of its range, or the transmitter reports an error",
    watch=condition("reading not valid", lambda v: not v.readings.cell_valid and not v.readings.cell_silent),
    unseen=True,
    delay=STALE_CELL_DELAY_S,
    when=LOADED,
    reset=ACK,
)

FROZEN_CELL_S: Final = Parameter(
    "frozen_cell_s", "s", "500 ms", "identical raw counts of the load cell, loaded and turning ...",
    hardest="1 s", because="at 0.3 m/s runout moves the load once a second: a second without a change is no reading",
)  # fmt: skip
# A sound cell may show no force yet this far beyond the assumed place of the contact:
#   at a wheel's first contact: first_contact_place and first_contact_sweep of the radius, 0.3 + 1.35 mm, before that
#   check itself finds another wheel, and 0.03 mm that the press moves meanwhile in a scan (0.55 mm/s, 20 Hz);
#   at a known contact: 1.0 mm at touch_speed while a reading gets stale and its row waits (50 + 50 ms), 0.46 mm of
#   shrinkage since a touch at the wheel's hottest (hub 150, surface 95 degC: 99.5 K of wear.growth and its
#   uncertainty) and 0.025 mm of runout. Wear since then is subtracted; both places include the depth of touch_load.
# A dead cell lets 200 N grow in 1.8 mm, and some 60 N where "press torque" contradicts it (axes.press.screw).
TOUCH_MARGIN_MM: Final = Parameter(
    "touch_margin_mm", "mm", "1.8 mm",
    "... or no force this far beyond it: a new wheel may be 1.65 mm off; 200 N unseen",
    hardest="2 mm",
    because="2 mm press a wheel with 230 N, rubber that is stiffer by 30 % with 325 N, before a dead cell trips",
)  # fmt: skip


def _cell_frozen(v: Inputs) -> bool:
    r = v.readings
    unloaded = r.force_z_n < UNLOADED_N
    if v.turning and not unloaded and not (r.now_s - r.cell_changed_s <= v.parameters[FROZEN_CELL_S]):
        return True
    return _no_force(v)


def _no_force(v: Inputs) -> bool:
    """Return whether the cell shows no force although the press is well beyond the contact."""
    r = v.readings
    unmoved = v.pressing and not (r.force_z_n >= UNLOADED_N)
    return unmoved and not (r.press_mm - v.contact_mm <= v.parameters[TOUCH_MARGIN_MM])


def _repeated(v: Inputs) -> Compared:
    r, p = v.readings, v.parameters
    if _no_force(v):
        return Compared(r.press_mm - v.contact_mm, p[TOUCH_MARGIN_MM], "mm")
    return Compared(r.now_s - r.cell_changed_s, p[FROZEN_CELL_S], "s")


CELL_FROZEN: Final[Row] = Interlock(
    name="load cell frozen",
    cause="the cell repeats itself",
    watch=condition(
        "identical raw counts for frozen_cell, loaded and turning; or no force touch_margin beyond the contact",
        _cell_frozen,
        _repeated,
    ),
    parameters=(FROZEN_CELL_S, TOUCH_MARGIN_MM),
    when=LOADED,
)


def _force_n(v: Inputs) -> float:
    return v.readings.force_z_n


OVERLOAD: Final[Row] = Interlock(
    name="overload",
    cause="normal force above the rig's limit",
    watch=at_most("Fz > {}", _force_n, "limits.load_n"),
    when=LOADED,
    reset=ACK,
)

OVERLOAD_FACTOR: Final = Parameter(
    "overload_factor", "1", "1.1", "load above this times its target ...", AT_LEAST_ONE,
    hardest="1.2", because="400 N x 1.2 + 10 N are 490 N, and harm begins at 500 N",
)  # fmt: skip
OVERLOAD_MARGIN_N: Final = Parameter(
    "overload_margin_n", "N", "10 N", "... plus this ...", NOT_NEGATIVE,
    hardest="20 N", because="with 400 N x 1.2 it is the whole way to 500 N",
)  # fmt: skip
OVERLOAD_DELAY_S: Final = Parameter(
    "overload_delay_s", "s", "50 ms", "... for this long; above limits.load at once", NOT_NEGATIVE,
    hardest="100 ms", because="loading at 2 mm/s brings 34 N in 0.1 s (172 N/mm at 400 N)",
)  # fmt: skip
PRESSED_N: Final = Parameter(
    "pressed_n", "N", "50 N", "an unwanted contact gets firmer by this at most [A]: runout and noise are 10 N",
    hardest="80 N", because="from 400 N it is 480 N, and harm begins at 500 N",
)  # fmt: skip


def _most_n(v: Inputs) -> float:
    p = v.parameters
    if not v.pressing:
        return v.least_n + p[PRESSED_N]
    wanted_n, highest_n = v.demand.load_n, v.contact.highest_n
    if not highest_n > wanted_n:
        highest_n = wanted_n
    return p[OVERLOAD_FACTOR] * highest_n + p[OVERLOAD_MARGIN_N]


OVERSHOOT: Final[Row] = Interlock(
    name="load overshoot",
    cause="normal force above its target",
    watch=at_most(
        "Fz > overload_factor x target + overload_margin; or pressed more while none is wanted", _force_n, _most_n, "N"
    ),
    parameters=(OVERLOAD_FACTOR, OVERLOAD_MARGIN_N, PRESSED_N),
    delay=OVERLOAD_DELAY_S,
    when=LOADED,
    reset=ACK,
)

DEPTH_FACTOR: Final = Parameter(
    "depth_factor", "1", "1.3", "the press is beyond the contact by this times the depth for the load shown ...",
    AT_LEAST_ONE, hardest="1.5",
    because="force grows with depth^1.3: at 1.5 times the depth 300 N shown are 508 N, and harm begins at 500 N",
)  # fmt: skip
DEPTH_MARGIN_MM: Final = Parameter(
    "depth_margin_mm", "mm", "0.2 mm", "... plus this [A]: rubber may be softer than loops.load.stiffness by 29 % ...",
    NOT_NEGATIVE, hardest="0.3 mm", because="0.3 mm are 52 N at 400 N",
)  # fmt: skip
DEPTH_DELAY_S: Final = Parameter(
    "depth_delay_s", "s", "50 ms", "... for this long: the cell reads too little [A]", NOT_NEGATIVE,
    hardest="100 ms", because="loading at 2 mm/s brings 34 N in 0.1 s (172 N/mm at 400 N)",
)  # fmt: skip


def _deepest_mm(v: Inputs) -> float:
    p, needed_mm = v.parameters, depth_mm(v.readings.force_z_n, v.limits.stiffness_n_per_mm)
    return p[DEPTH_FACTOR] * needed_mm + p[DEPTH_MARGIN_MM]


TOO_DEEP: Final[Row] = Interlock(
    name="contact too deep",
    cause="the cell reads too little: the press is further than its load needs",
    watch=at_most(
        "depth > depth_factor x that of Fz (loops.load.stiffness) + depth_margin",
        lambda v: v.readings.press_mm - v.contact_mm,
        _deepest_mm,
        "mm",
    ),
    parameters=(DEPTH_FACTOR, DEPTH_MARGIN_MM),
    applies=lambda v: v.pressing and v.contact.in_contact,
    delay=DEPTH_DELAY_S,
    when=LOADED,
)

CONTACT_SHARE: Final = Parameter(
    "contact_share", "1", "0.2", "contact is lost below this share of a target ...", SHARE,
    direction=Direction.HIGHER, hardest="0.1",
    because="a tenth of the least target watched is 5 N, which an unloaded cell may show",
)  # fmt: skip
CONTACT_LEAST_N: Final = Parameter(
    "contact_least_n", "N", "50 N", "... of at least this: a smaller one is too near to touching to tell [A]",
    hardest="100 N", because="the paper's smallest load is 100 N: above it no test would be watched",
)  # fmt: skip
CONTACT_DELAY_S: Final = Parameter(
    "contact_delay_s", "s", "200 ms", "... for this long [A]", NOT_NEGATIVE,
    hardest="1 s", because="a press that has lost its wheel comes 4 mm further in 1 s at its loading speed",
)  # fmt: skip


def _lowest_n(v: Inputs) -> float:
    wanted_n, lowest_n = v.demand.load_n, v.contact.lowest_n
    return lowest_n if lowest_n < wanted_n else wanted_n


def _load_watched(v: Inputs) -> bool:
    return v.pressing and v.contact.loaded and _lowest_n(v) >= v.parameters[CONTACT_LEAST_N]


CONTACT_LOST: Final[Row] = Interlock(
    name="contact lost",
    cause="normal force far below target",
    watch=at_least(
        "Fz < contact_share of a target of contact_least or more",
        _force_n,
        lambda v: v.parameters[CONTACT_SHARE] * _lowest_n(v),
        "N",
    ),
    parameters=(CONTACT_SHARE, CONTACT_LEAST_N),
    applies=_load_watched,
    delay=CONTACT_DELAY_S,
    when=LOADED,
    reset=ACK,
)

SLIP_POWER_DELAY_S: Final = Parameter(
    "slip_power_delay_s", "s", "50 ms", "above limits.slip_power; harm is 0.5 s beyond [A]", NOT_NEGATIVE,
    hardest="200 ms", because="harm is 0.5 s beyond, and a quick stop from 0.8 m/s takes 0.1 s",
)  # fmt: skip

SLIP_POWER: Final[Row] = Interlock(
    name="slip power",
    cause="friction power above the rig's limit",
    watch=at_most("friction x slip > {}", lambda v: v.friction_w, "limits.slip_power_w"),
    delay=SLIP_POWER_DELAY_S,
    when=LOADED,
    reset=ACK,
)

ROWS: Final[tuple[Row, ...]] = (
    CELL_SILENT, CELL_SATURATED, CELL_FROZEN, OVERLOAD, OVERSHOOT, TOO_DEEP, CONTACT_LOST, SLIP_POWER,
)  # fmt: skip
