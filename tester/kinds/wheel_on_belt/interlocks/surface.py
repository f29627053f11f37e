"""The rubber's surface, its thermometer, and the wheel's wear."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Direction, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs, Row
from tester.machine.row import ACK, CONTROLLED, SELDOM, Compared, Interlock
from tester.machine.watches import at_least, at_most, condition
from tester.machine.wires import answered_s

_INF: Final = inf

JUMP_K: Final = Parameter(
    "jump_k", "K", "5 K", "from one reading to the next, surface or hub",
    hardest="10 K",
    because="full output moves the hub by 0.1 K from reading to reading: more than 10 K is no temperature",
)  # fmt: skip
BLIND_S: Final = Parameter(
    "blind_s", "s", "1 s", "after a change of wheel readings are not compared for this long [A]",
    hardest="5 s", because="25 readings: what was on its way has long come",
)  # fmt: skip
STALE_DELAY_S: Final = Parameter(
    "stale_delay_s", "s", "200 ms", "for both [A]", NOT_NEGATIVE,
    hardest="1 s", because="with an age of 1 s ten readings are missing by then",
)  # fmt: skip

SURFACE_DELAY_S: Final = Parameter(
    "surface_delay_s", "s", "500 ms", "rubber above limits.surface [A]", NOT_NEGATIVE,
    hardest="2 s", because="35 K are left from limits.surface to harm, and a burst is over after some seconds [A]",
)  # fmt: skip

SURFACE_HOT: Final[Row] = Interlock(
    name="surface hot",
    cause="rubber surface above its limit",
    watch=at_most("surface > {}", lambda v: v.readings.surface_c, "limits.surface_c"),
    applies=lambda v: v.readings.surface_valid,
    delay=SURFACE_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_wanted(v: Inputs) -> bool:
    """Return whether anything depends on the surface temperature: contact, or heating."""
    return v.pressing or -_INF < v.demand.surface_c < _INF


SURFACE_JUMP: Final[Row] = Interlock(
    name="surface sensor jump",
    cause="thermometer moved, covered or disturbed",
    watch=at_most("two readings apart by > {}", lambda v: v.surface.jump_k, JUMP_K),
    parameters=(BLIND_S,),
    applies=_surface_wanted,
    when=SELDOM,
    reaction=CONTROLLED,
    reset=ACK,
)

def _measures(v: Inputs) -> bool:
    """Return whether the tread moves past the thermometer: the model has no value for one spot of a standing wheel."""
    return v.readings.surface_valid and v.turning


FROZEN_SURFACE_S: Final = Parameter(
    "frozen_surface_s", "s", "60 s", "identical raw counts of the thermometer while turning ...",
    hardest="2 min",
    because="a burst and its wait take a minute or two: a frozen thermometer must not last through them",
)  # fmt: skip
FROZEN_MODEL_K: Final = Parameter(
    "frozen_model_k", "K", "1 K", "... or while the model has moved by this",
    hardest="2 K", because="ten times what the thermometer resolves and a recipe's usual band of temperature",
)  # fmt: skip
FROZEN_DELAY_S: Final = Parameter(
    "frozen_delay_s", "s", "2 s",
    "either of both for this long: the thermometer is polled, the model is not [A]", NOT_NEGATIVE,
    hardest="5 s", because="25 readings that contradict the model",
)  # fmt: skip


def _same_s(v: Inputs) -> float:
    return v.readings.now_s - v.readings.surface_changed_s


def _moved_k(v: Inputs) -> float:
    """Return the model's change since the thermometer's reading last changed, K."""
    return abs(v.model_c - v.surface.model_c)


def _surface_frozen(v: Inputs) -> bool:
    return not (_same_s(v) <= v.parameters[FROZEN_SURFACE_S]) or not (_moved_k(v) <= v.parameters[FROZEN_MODEL_K])


def _repeated(v: Inputs) -> Compared:
    same_s, p = _same_s(v), v.parameters
    if not (same_s <= p[FROZEN_SURFACE_S]):
        return Compared(same_s, p[FROZEN_SURFACE_S], "s")
    return Compared(_moved_k(v), p[FROZEN_MODEL_K], "K")


THERMOMETER_FROZEN: Final[Row] = Interlock(
    name="thermometer frozen",
    cause="the thermometer repeats itself",
    watch=condition(
        "unchanged for frozen_surface, or while the model moved by frozen_model, turning", _surface_frozen, _repeated
    ),
    parameters=(FROZEN_SURFACE_S, FROZEN_MODEL_K),
    applies=_measures,
    delay=FROZEN_DELAY_S,
    reaction=CONTROLLED,
)

MODEL_K: Final = Parameter(
    "model_k", "K", "8 K", "surface temperature off the thermal model ...",
    hardest="15 K",
    because="a thermometer that reads 15 K low at limits.surface lets the rubber reach 110 degC, 20 K from harm",
)  # fmt: skip
MODEL_DELAY_S: Final = Parameter(
    "model_delay_s", "s", "30 s", "... for this long", NOT_NEGATIVE,
    hardest="60 s", because="full output heats the hub by 29 K in a minute",
)  # fmt: skip

SURFACE_OFF_MODEL: Final[Row] = Interlock(
    name="surface off model",
    cause="thermometer misaligned, dirty or wrong emissivity",
    watch=at_most(
        "surface off the thermal observer by > {}, turning", lambda v: abs(v.readings.surface_c - v.model_c), MODEL_K
    ),
    applies=_measures,
    delay=MODEL_DELAY_S,
    when=SELDOM,
    reaction=CONTROLLED,
)

STALE_IR_S: Final = Parameter(
    "stale_ir_s", "s", "1 s", "age of the surface temperature",
    hardest="3 s", because="fifteen readings are missing by then: the thermometer is gone",
)  # fmt: skip


def _surface_answered_s(v: Inputs) -> float:
    r = v.readings
    return answered_s(r.surface_silent, r.now_s, r.surface_at_s)


THERMOMETER_SILENT: Final[Row] = Interlock(
    name="thermometer silent",
    cause="cable, supply or address; the surface temperature is not known",
    watch=at_most("age > {}, or several requests without an answer, and wanted", _surface_answered_s, STALE_IR_S),
    applies=_surface_wanted,
    unseen=True,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

SURFACE_NOT_VALID: Final[Row] = Interlock(
    name="surface not valid",
    cause="the thermometer is out of its range, or reports an error",
    watch=condition(
        "reading not valid, and wanted", lambda v: not v.readings.surface_valid and not v.readings.surface_silent
    ),
    applies=_surface_wanted,
    when=SELDOM,
    unseen=True,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

LEAST_DIAMETER_MM: Final = Parameter(
    "least_diameter_mm", "mm", "78 mm", "a wheel worn below this: 2 mm of rubber are left [A]",
    direction=Direction.HIGHER, hardest="76 mm",
    because="the rubber is 8 mm on a hub of 74 mm: 1 mm is left, the depth of a contact of 100 N",
)  # fmt: skip

WHEEL_WORN: Final[Row] = Interlock(
    name="wheel worn",
    cause="wheel diameter below its least",
    watch=at_least("cold diameter < {}", lambda v: v.readings.cold_mm, LEAST_DIAMETER_MM),
    reaction=CONTROLLED,
    reset="new wheel, acknowledged",
)

ROWS: Final[tuple[Row, ...]] = (
    SURFACE_HOT, SURFACE_JUMP, THERMOMETER_FROZEN, SURFACE_OFF_MODEL, THERMOMETER_SILENT, SURFACE_NOT_VALID,
)  # fmt: skip
