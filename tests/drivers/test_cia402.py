"""The CiA 402 state machine, over every statusword and every pair of state and goal."""

from __future__ import annotations

import pytest

from drivers.cia402 import Goal, State, controlword, decode

# CiA 402-2, table "state coding", as printed there: bits 6, 5, 3, 2, 1, 0; x is any.
PRINTED = {
    State.NOT_READY: "0x0000",
    State.SWITCH_ON_DISABLED: "1x0000",
    State.READY_TO_SWITCH_ON: "010001",
    State.SWITCHED_ON: "010011",
    State.OPERATION_ENABLED: "010111",
    State.QUICK_STOP_ACTIVE: "000111",
    State.FAULT_REACTION: "0x1111",
    State.FAULT: "0x1000",
}


def printed_state(word: int) -> State:
    bits = "".join(str(word >> bit & 1) for bit in (6, 5, 3, 2, 1, 0))
    for state, pattern in PRINTED.items():
        if all(want in ("x", bit) for want, bit in zip(pattern, bits, strict=True)):
            return state
    return State.NOT_READY


def test_every_statusword_decodes_as_in_the_printed_table() -> None:
    wrong = [word for word in range(0x10000) if decode(word) is not printed_state(word)]
    assert wrong == []


@pytest.mark.parametrize(("word", "state"), [
    (0x0000, State.NOT_READY), (0x0250, State.SWITCH_ON_DISABLED), (0x0231, State.READY_TO_SWITCH_ON),
    (0x0233, State.SWITCHED_ON), (0x1637, State.OPERATION_ENABLED), (0x0217, State.QUICK_STOP_ACTIVE),
    (0x021F, State.FAULT_REACTION), (0x0218, State.FAULT),
])
def test_words_of_a_real_drive_decode(word: int, state: State) -> None:
    assert decode(word) is state


@pytest.mark.parametrize("word", [0x01, 0x03, 0x22, 0x61, 0x67, 0x4F, 0x48])
def test_a_pattern_without_a_state_is_not_ready(word: int) -> None:
    assert decode(word) is State.NOT_READY


@pytest.mark.parametrize("goal", list(Goal))
@pytest.mark.parametrize("state", list(State))
def test_no_controlword_resets_a_fault_or_halts(state: State, goal: Goal) -> None:
    assert controlword(state, goal) & ~0x0F == 0


def follow(state: State, word: int) -> State:
    """Return the next state of an ideal drive (CiA 402-2, figure of the state machine; 0x605A = 2)."""
    low = word & 0x0F
    if state in (State.NOT_READY, State.FAULT_REACTION, State.FAULT):
        return state
    if state is State.QUICK_STOP_ACTIVE:
        return State.SWITCH_ON_DISABLED
    if low & 0b0010 == 0:                                            # disable voltage
        return State.SWITCH_ON_DISABLED
    if low & 0b0110 == 0b0010:                                       # quick stop
        return State.QUICK_STOP_ACTIVE if state is State.OPERATION_ENABLED else State.SWITCH_ON_DISABLED
    if low & 0b0111 == 0b0110:                                       # shutdown
        return State.READY_TO_SWITCH_ON
    if state is State.SWITCH_ON_DISABLED:
        return state
    if low == 0b0111:                                                # switch on, disable operation
        return State.SWITCHED_ON
    return State.OPERATION_ENABLED if state is not State.READY_TO_SWITCH_ON else State.READY_TO_SWITCH_ON


def path(state: State, goal: Goal, steps: int = 5) -> list[State]:
    states = [state]
    for _ in range(steps):
        state = follow(state, controlword(state, goal))
        states.append(state)
    return states


LIVE = [State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.SWITCHED_ON, State.OPERATION_ENABLED,
        State.QUICK_STOP_ACTIVE]


@pytest.mark.parametrize("state", LIVE)
def test_enabled_is_reached_from_every_live_state(state: State) -> None:
    assert path(state, Goal.ENABLED)[-1] is State.OPERATION_ENABLED


@pytest.mark.parametrize("goal", [Goal.DISABLED, Goal.QUICK_STOP, Goal.FREE])
@pytest.mark.parametrize("state", LIVE)
def test_power_is_off_at_the_end_of_every_stop(state: State, goal: Goal) -> None:
    assert path(state, goal)[-1] is State.SWITCH_ON_DISABLED


@pytest.mark.parametrize("goal", list(Goal))
@pytest.mark.parametrize("state", [State.FAULT, State.FAULT_REACTION])
def test_a_fault_is_never_left(state: State, goal: Goal) -> None:
    assert set(path(state, goal)) == {state}


def test_enabling_goes_through_every_state_in_order() -> None:
    assert path(State.SWITCH_ON_DISABLED, Goal.ENABLED, steps=3) == [
        State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.SWITCHED_ON, State.OPERATION_ENABLED]


def test_disabling_an_enabled_drive_ramps_down_before_the_power_goes() -> None:
    assert controlword(State.OPERATION_ENABLED, Goal.DISABLED) == 0x07


def test_enabling_does_not_cut_a_quick_stop_short() -> None:
    assert controlword(State.QUICK_STOP_ACTIVE, Goal.ENABLED) == 0x02


@pytest.mark.parametrize("state", list(State))
def test_quick_stop_is_the_same_word_in_every_state(state: State) -> None:
    assert controlword(state, Goal.QUICK_STOP) == 0x02


@pytest.mark.parametrize("state", list(State))
def test_free_takes_the_voltage_off_in_every_state(state: State) -> None:
    assert controlword(state, Goal.FREE) == 0x00
