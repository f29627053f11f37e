"""The rubber's surface and its thermometer."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs, Row
from tester.kinds.wheel_on_belt.interlocks.temperatures import BLIND_S, JUMP_K, STALE_DELAY_S
from tester.machine.row import ACK, CONTROLLED, REPAIR, Compared, Interlock
from tester.machine.watches import at_most, condition
from tester.machine.wires import answered_s

_INF: Final = inf

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
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_wanted(v: Inputs) -> bool:
    """Tell whether anything depends on the surface temperature: a contact, or a heat."""
    return v.pressing or -_INF < v.demand.surface_c < _INF


SURFACE_JUMP: Final[Row] = Interlock(
    name="surface sensor jump",
    cause="thermometer moved, covered or disturbed",
    watch=at_most("two readings apart by > {}", lambda v: v.surface.jump_k, JUMP_K),
    parameters=(BLIND_S,),
    applies=_surface_wanted,
    reaction=CONTROLLED,
    reset=ACK,
)

def _measures(v: Inputs) -> bool:
    """Tell whether the thermometer sees the tread go by: of one spot of a standing wheel the model knows nothing."""
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
    hardest="5 s", because="25 readings that say what the model denies",
)  # fmt: skip


def _same_s(v: Inputs) -> float:
    return v.readings.now_s - v.readings.surface_changed_s


def _moved_k(v: Inputs) -> float:
    """Return how far the model has moved since the thermometer last changed, K."""
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
    reset=REPAIR,
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
    reaction=CONTROLLED,
    reset=REPAIR,
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
    unseen=True,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

ROWS: Final[tuple[Row, ...]] = (
    SURFACE_HOT, SURFACE_JUMP, THERMOMETER_FROZEN, SURFACE_OFF_MODEL, THERMOMETER_SILENT, SURFACE_NOT_VALID,
)  # fmt: skip
