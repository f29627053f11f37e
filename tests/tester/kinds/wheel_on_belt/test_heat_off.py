"""The jacket's heat when the PC is silent: without a lease the rig file names what switches it off."""

from __future__ import annotations

import pytest

from tester.base.source import InvalidSource, load_tree
from tester.inputs.rig.packaged import hardware_text
from tester.inputs.rig.rig_files import load
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served.served import left_alone

LINE = "    heat_off: fallback "


def real(**changed: str) -> RigConfig:
    """Return a new rig file for a real machine, with values of the jacket changed; "" takes the key out."""
    text = hardware_text(RigConfig)
    assert LINE in text
    if "heat_off" in changed:
        key = f"    heat_off: {changed['heat_off']} " if changed["heat_off"] else "    # "
        text = text.replace(LINE, key)
    if "profile" in changed:
        text = text.replace("profile: eurotherm_3200", f"profile: {changed['profile']}")
    return load(RigConfig, load_tree(text))


def refused(**changed: str) -> str:
    """Return why such a file is refused."""
    with pytest.raises(InvalidSource) as caught:
        real(**changed)
    (problem,) = caught.value.problems
    return problem.message


def test_a_controller_without_a_lease_needs_a_statement_of_its_heat_cut_off() -> None:
    said = refused(heat_off="")
    assert said.startswith("Eurotherm 3200 temperature controller has no lease: it heats on when the PC is silent")
    assert "fallback: " in said
    assert "relay: " in said


def test_a_controller_with_a_lease_needs_none() -> None:
    assert "stops heating by itself (2 s without a command)" in left_alone(
        real(heat_off="", profile="simulated_jacket")
    )


def test_a_fallback_is_believed_only_of_a_profile_that_has_one() -> None:
    assert "Omron E5CC temperature controller has no setpoint of its own" in refused(profile="omron_e5cc")
    assert "by the rig file a relay takes its supply" in left_alone(real(profile="omron_e5cc", heat_off="relay"))


def test_another_word_is_refused_with_those_there_are() -> None:
    assert refused(heat_off="hope") == "hope (expected fallback or relay)"


def test_the_jackets_own_reaction_is_reported() -> None:
    assert "falls back to a setpoint of no heat (5 s without a command)" in left_alone(real())
