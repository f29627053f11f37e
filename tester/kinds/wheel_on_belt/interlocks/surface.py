"""The rubber's surface and its thermometer."""

from __future__ import annotations

from math import inf
from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, Parameter
from tester.kinds.wheel_on_belt.interlocks.inputs import Inputs
from tester.kinds.wheel_on_belt.interlocks.temperatures import BLIND_S, JUMP_K, STALE_DELAY_S
from tester.machine.row import ACK, CONTROLLED, REPAIR, Compared, Interlock
from tester.machine.wires import answered_s

_INF: Final = inf

SURFACE_DELAY_S: Final = Parameter(
    "surface_delay_s", "s", "500 ms", "rubber above limits.surface [A]", NOT_NEGATIVE,
    hardest="2 s", because="35 K are left from limits.surface to harm, and a burst is over after some seconds [A]",
)  # fmt: skip


def _surface_hot(v: Inputs) -> bool:
    r = v.readings
    return r.surface_valid and not (r.surface_c <= v.limits.surface_c)


SURFACE_HOT: Final = Interlock(
    name="surface hot",
    cause="rubber surface above its limit",
    level="surface > limits.surface",
    condition=_surface_hot,
    compared=lambda v: Compared(v.readings.surface_c, v.limits.surface_c, "degC"),
    delay=SURFACE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_wanted(v: Inputs) -> bool:
    """Tell whether anything depends on the surface temperature: a contact, or a heat."""
    return v.pressing or -_INF < v.demand.surface_c < _INF


def _surface_jumps(v: Inputs) -> bool:
    return not (v.surface.jump_k <= v.parameters[JUMP_K]) and _surface_wanted(v)


SURFACE_JUMP: Final = Interlock(
    name="surface sensor jump",
    cause="thermometer moved, covered or disturbed",
    level="two readings apart by > jump",
    condition=_surface_jumps,
    compared=lambda v: Compared(v.surface.jump_k, v.parameters[JUMP_K], "K"),
    parameters=(JUMP_K, BLIND_S),
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


def _surface_frozen(v: Inputs) -> bool:
    if not _measures(v):
        return False
    r, p = v.readings, v.parameters
    most = p[FROZEN_MODEL_K]
    return not (r.now_s - r.surface_changed_s <= p[FROZEN_SURFACE_S]) or not (
        -most <= v.model_c - v.surface.model_c <= most
    )


def _repeated(v: Inputs) -> Compared:
    r, p = v.readings, v.parameters
    same_s = r.now_s - r.surface_changed_s
    if not (same_s <= p[FROZEN_SURFACE_S]):
        return Compared(same_s, p[FROZEN_SURFACE_S], "s")
    return Compared(abs(v.model_c - v.surface.model_c), p[FROZEN_MODEL_K], "K")


THERMOMETER_FROZEN: Final = Interlock(
    name="thermometer frozen",
    cause="the thermometer repeats itself",
    level="unchanged for frozen_surface, or while the model moved by frozen_model, turning",
    condition=_surface_frozen,
    compared=_repeated,
    parameters=(FROZEN_SURFACE_S, FROZEN_MODEL_K),
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


def _surface_off_model(v: Inputs) -> bool:
    if not _measures(v):
        return False
    most = v.parameters[MODEL_K]
    return not (-most <= v.readings.surface_c - v.model_c <= most)


SURFACE_OFF_MODEL: Final = Interlock(
    name="surface off model",
    cause="thermometer misaligned, dirty or wrong emissivity",
    level="surface off the thermal observer by > model, turning",
    condition=_surface_off_model,
    compared=lambda v: Compared(abs(v.readings.surface_c - v.model_c), v.parameters[MODEL_K], "K"),
    parameters=(MODEL_K,),
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


def _surface_old(v: Inputs) -> bool:
    return not (_surface_answered_s(v) <= v.parameters[STALE_IR_S])


def _surface_missed(v: Inputs) -> bool:
    return _surface_old(v) and _surface_wanted(v)


THERMOMETER_SILENT: Final = Interlock(
    name="thermometer silent",
    cause="cable, supply or address; the surface temperature is not known",
    level="age > stale_ir, or several requests without an answer, and wanted",
    condition=_surface_missed,
    compared=lambda v: Compared(_surface_answered_s(v), v.parameters[STALE_IR_S], "s"),
    unseen=_surface_old,
    parameters=(STALE_IR_S,),
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)


def _surface_invalid(v: Inputs) -> bool:
    r = v.readings
    return not r.surface_valid and not r.surface_silent


def _surface_unusable(v: Inputs) -> bool:
    return _surface_invalid(v) and _surface_wanted(v)


SURFACE_NOT_VALID: Final = Interlock(
    name="surface not valid",
    cause="the thermometer is out of its range, or reports an error",
    level="reading not valid, and wanted",
    condition=_surface_unusable,
    unseen=_surface_invalid,
    delay=STALE_DELAY_S,
    reaction=CONTROLLED,
    reset=ACK,
)

ROWS: Final[tuple[Interlock, ...]] = (
    SURFACE_HOT, SURFACE_JUMP, THERMOMETER_FROZEN, SURFACE_OFF_MODEL, THERMOMETER_SILENT, SURFACE_NOT_VALID,
)  # fmt: skip
