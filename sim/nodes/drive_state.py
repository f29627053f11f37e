"""The CiA 402 power state machine as the drive runs it (CiA 402-2, figure 3): which word leads where."""

from __future__ import annotations

from drivers.cia402 import State

STATUS_BITS: dict[State, int] = {
    State.NOT_READY: 0x00,
    State.SWITCH_ON_DISABLED: 0x40,
    State.READY_TO_SWITCH_ON: 0x21,
    State.SWITCHED_ON: 0x23,
    State.OPERATION_ENABLED: 0x27,
    State.QUICK_STOP_ACTIVE: 0x07,
    State.FAULT_REACTION: 0x0F,
    State.FAULT: 0x08,
}
"""Bits 0-3, 5 and 6 of the statusword."""

ENERGISED = frozenset((State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE, State.FAULT_REACTION))
"""States in which the power stage drives the motor."""

FAULTY = frozenset((State.FAULT_REACTION, State.FAULT))


def commanded(state: State, controlword: int, stop_may_end: bool = False) -> State:
    """Return the state a controlword (0..0xFFFF) leads to next, ``state`` itself when it commands nothing there.

    ``stop_may_end``: quick stop option 5-8, from which operation may be enabled again (transition 16). Fault states
    are left by the rising edge of bit 7 only, which is not a matter of levels.
    """
    if state in FAULTY or state is State.NOT_READY:
        return state
    if not controlword & 0x02:  # disable voltage
        return State.SWITCH_ON_DISABLED
    if not controlword & 0x04:  # quick stop
        if state is State.OPERATION_ENABLED or state is State.QUICK_STOP_ACTIVE:
            return State.QUICK_STOP_ACTIVE
        return State.SWITCH_ON_DISABLED
    command = controlword & 0x0F
    if state is State.QUICK_STOP_ACTIVE:
        return State.OPERATION_ENABLED if stop_may_end and command == 0x0F else state
    if not command & 0x01:  # shutdown
        return State.READY_TO_SWITCH_ON
    if state is State.SWITCH_ON_DISABLED:
        return state
    if state is State.READY_TO_SWITCH_ON:
        return State.SWITCHED_ON
    return State.OPERATION_ENABLED if command == 0x0F else State.SWITCHED_ON
