"""Safety inputs and the contactor of a simulated drive."""

from __future__ import annotations

from math import inf

from sim.nodes.safety_io import (
    CONTACTOR,
    DROP_OUT_S,
    GUARD,
    PULL_IN_S,
    REQUEST,
    SAFETY_CHAIN,
    SafetyIo,
)


def closed() -> SafetyIo:
    io = SafetyIo()
    io.set_outputs(REQUEST, 0.0)
    io.fire(PULL_IN_S)
    return io


def test_chain_is_healthy_and_guard_closed_at_the_start() -> None:
    assert SafetyIo().inputs == SAFETY_CHAIN | GUARD


def test_the_contactor_pulls_in_after_its_time() -> None:
    io = SafetyIo()
    io.set_outputs(REQUEST, 1.0)
    assert io.due_s == 1.0 + PULL_IN_S
    assert not io.fire(1.0)
    assert io.fire(1.0 + PULL_IN_S)
    assert io.inputs & CONTACTOR


def test_a_request_withdrawn_in_time_leaves_it_open() -> None:
    io = SafetyIo()
    io.set_outputs(REQUEST, 0.0)
    io.set_outputs(0, PULL_IN_S / 2)
    assert io.due_s == inf


def test_an_open_chain_lets_it_drop_out() -> None:
    io = closed()
    io.set_chain(False, 1.0)
    assert io.due_s == 1.0 + DROP_OUT_S
    io.fire(1.0 + DROP_OUT_S)
    assert io.inputs == GUARD


def test_it_does_not_pull_in_on_an_open_chain() -> None:
    io = SafetyIo()
    io.set_chain(False, 0.0)
    io.set_outputs(REQUEST, 0.0)
    assert io.due_s == inf


def test_an_open_guard_is_only_reported() -> None:
    io = closed()
    io.set_guard(False)
    assert io.inputs == SAFETY_CHAIN | CONTACTOR
    assert io.due_s == inf


def test_the_same_request_again_changes_nothing() -> None:
    io = SafetyIo()
    assert io.set_outputs(REQUEST, 0.0)
    assert not io.set_outputs(REQUEST, 0.01)
    assert io.due_s == PULL_IN_S
