"""The drive's power state machine: every state and every controlword (CiA 402-2, figure 3)."""

from __future__ import annotations

import pytest

from drivers import cia402
from drivers.cia402 import State
from sim.nodes.drive_power import FAULTY, commanded

S = State


@pytest.mark.parametrize(
    ("state", "controlword", "expected"),
    [
        (S.SWITCH_ON_DISABLED, 0x06, S.READY_TO_SWITCH_ON),  # 2
        (S.READY_TO_SWITCH_ON, 0x07, S.SWITCHED_ON),  # 3
        (S.SWITCHED_ON, 0x0F, S.OPERATION_ENABLED),  # 4
        (S.OPERATION_ENABLED, 0x07, S.SWITCHED_ON),  # 5
        (S.SWITCHED_ON, 0x06, S.READY_TO_SWITCH_ON),  # 6
        (S.READY_TO_SWITCH_ON, 0x00, S.SWITCH_ON_DISABLED),  # 7
        (S.READY_TO_SWITCH_ON, 0x02, S.SWITCH_ON_DISABLED),  # 7
        (S.OPERATION_ENABLED, 0x06, S.READY_TO_SWITCH_ON),  # 8
        (S.OPERATION_ENABLED, 0x00, S.SWITCH_ON_DISABLED),  # 9
        (S.SWITCHED_ON, 0x00, S.SWITCH_ON_DISABLED),  # 10
        (S.SWITCHED_ON, 0x02, S.SWITCH_ON_DISABLED),  # 10
        (S.OPERATION_ENABLED, 0x02, S.QUICK_STOP_ACTIVE),  # 11
        (S.QUICK_STOP_ACTIVE, 0x00, S.SWITCH_ON_DISABLED),  # 12
        (S.SWITCH_ON_DISABLED, 0x0F, S.SWITCH_ON_DISABLED),
        (S.SWITCH_ON_DISABLED, 0x07, S.SWITCH_ON_DISABLED),
        (S.QUICK_STOP_ACTIVE, 0x0F, S.QUICK_STOP_ACTIVE),
        (S.QUICK_STOP_ACTIVE, 0x06, S.QUICK_STOP_ACTIVE),
        (S.READY_TO_SWITCH_ON, 0x0F, S.SWITCHED_ON),
        (S.OPERATION_ENABLED, 0x10F, S.OPERATION_ENABLED),
    ],
)
def test_transitions_of_the_standard(state: State, controlword: int, expected: State) -> None:
    assert commanded(state, controlword) is expected


def test_transition_16_needs_a_holding_quick_stop() -> None:
    assert commanded(S.QUICK_STOP_ACTIVE, 0x0F, stop_may_end=True) is S.OPERATION_ENABLED


def test_no_controlword_leads_out_of_a_fault_by_its_level() -> None:
    for state in (*FAULTY, S.NOT_READY):
        assert all(commanded(state, word) is state for word in range(0x10000))


def test_operation_is_enabled_from_switched_on_only() -> None:
    for word in range(0x10000):
        for state in (S.SWITCH_ON_DISABLED, S.READY_TO_SWITCH_ON, S.QUICK_STOP_ACTIVE):
            assert commanded(state, word) is not S.OPERATION_ENABLED


def test_withdrawn_voltage_disables_from_every_working_state() -> None:
    for state in set(State) - FAULTY - {S.NOT_READY}:
        for word in range(0x10000):
            if not word & 0x02:
                assert commanded(state, word) is S.SWITCH_ON_DISABLED


@pytest.mark.parametrize("state", list(State))
def test_the_client_reads_the_state_from_the_bits_shown(state: State) -> None:
    for others in (0x0000, 0x0610, 0x3690, 0xFF90):
        assert cia402.decode(cia402.STATUS_BITS[state] | others) is state
