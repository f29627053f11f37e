"""The CiA 402 power state machine, as pure functions of words (CiA 402-2, chapter 8).

A client only ever sees the statusword and only ever sends a controlword, one step per frame.
"""

from __future__ import annotations

from enum import IntEnum
from typing import Final


class State(IntEnum):
    """States of the power drive system."""

    NOT_READY = 0
    SWITCH_ON_DISABLED = 1
    READY_TO_SWITCH_ON = 2
    SWITCHED_ON = 3
    OPERATION_ENABLED = 4
    QUICK_STOP_ACTIVE = 5
    FAULT_REACTION = 6
    FAULT = 7


class Goal(IntEnum):
    """Power states that the caller can command.

    DISABLED: ramp down (0x605C), then power off. ENABLED: power on and follow the target. QUICK_STOP: ramp
    down at the rate of 0x6085, then power off. FREE: power off at once, the axis coasts.
    """

    DISABLED = 0
    ENABLED = 1
    QUICK_STOP = 2
    FREE = 3


# Statusword bits
VOLTAGE: Final = 0x0010
WARNING: Final = 0x0080
REMOTE: Final = 0x0200
TARGET_REACHED: Final = 0x0400
INTERNAL_LIMIT: Final = 0x0800
SPEED_ZERO: Final = 0x1000               # profile velocity
SET_POINT_ACKNOWLEDGED: Final = 0x1000   # profile position
HOMING_ATTAINED: Final = 0x1000          # homing
MAX_SLIPPAGE: Final = 0x2000             # profile velocity
FOLLOWING_ERROR: Final = 0x2000          # profile position
HOMING_ERROR: Final = 0x2000             # homing

# Controlword
DISABLE_VOLTAGE: Final = 0x0000
QUICK_STOP: Final = 0x0002
SHUTDOWN: Final = 0x0006
SWITCH_ON: Final = 0x0007                # from SWITCHED_ON downwards: disable operation
ENABLE_OPERATION: Final = 0x000F
RAMP: Final = 0x0070                     # velocity mode: enable ramp, unlock ramp, reference ramp
NEW_SET_POINT: Final = 0x0010            # profile position
HOMING_START: Final = 0x0010             # homing
CHANGE_IMMEDIATELY: Final = 0x0020       # profile position
FAULT_RESET: Final = 0x0080              # acts on its rising edge
HALT: Final = 0x0100

_MASKS: Final = (
    (0x4F, 0x00, State.NOT_READY),
    (0x4F, 0x40, State.SWITCH_ON_DISABLED),
    (0x6F, 0x21, State.READY_TO_SWITCH_ON),
    (0x6F, 0x23, State.SWITCHED_ON),
    (0x6F, 0x27, State.OPERATION_ENABLED),
    (0x6F, 0x07, State.QUICK_STOP_ACTIVE),
    (0x4F, 0x0F, State.FAULT_REACTION),
    (0x4F, 0x08, State.FAULT),
)
_STATE_BITS: Final = 0x6F
STATUS_BITS: Final = {state: value for _, value, state in _MASKS}
"""Bits 0-3, 5 and 6 of the statusword, as a drive sets them."""


def _state_of(word: int) -> State:
    for mask, value, state in _MASKS:
        if word & mask == value:
            return state
    return State.NOT_READY    # not in the standard: command nothing


_STATES: Final = tuple(_state_of(word) for word in range(_STATE_BITS + 1))


def decode(statusword: int) -> State:
    """Return the state of a statusword (0..0xFFFF); NOT_READY for a pattern that the standard does not define."""
    return _STATES[statusword & _STATE_BITS]


_UP: Final = {
    State.SWITCH_ON_DISABLED: SHUTDOWN,
    State.READY_TO_SWITCH_ON: SWITCH_ON,
    State.SWITCHED_ON: ENABLE_OPERATION,
    State.OPERATION_ENABLED: ENABLE_OPERATION,
    State.QUICK_STOP_ACTIVE: QUICK_STOP,      # finish a stop that has begun
}
_DOWN: Final = {
    State.OPERATION_ENABLED: SWITCH_ON,       # disable operation: ramps down (0x605C = 1)
    State.SWITCHED_ON: SHUTDOWN,
    State.QUICK_STOP_ACTIVE: QUICK_STOP,
}


def _word(state: State, goal: Goal) -> int:
    if goal is Goal.ENABLED:
        return _UP.get(state, DISABLE_VOLTAGE)
    if goal is Goal.DISABLED:
        return _DOWN.get(state, DISABLE_VOLTAGE)
    if goal is Goal.QUICK_STOP:
        return QUICK_STOP
    return DISABLE_VOLTAGE


_WORDS: Final = tuple(tuple(_word(state, goal) for goal in Goal) for state in State)


def controlword(state: State, goal: Goal) -> int:
    """Return the controlword that leads from a state one step towards a goal.

    The word never has bit 7, so no call leaves FAULT: the caller must reset a fault explicitly.
    """
    return _WORDS[state][goal]
