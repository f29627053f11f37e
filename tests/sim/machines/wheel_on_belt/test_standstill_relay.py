"""The relay acts once wheel or belt is at rest and the other turns, and holds until both are at rest."""

from __future__ import annotations

import pytest

from sim.machines.wheel_on_belt.standstill_relay import StandstillRelay


def seen(relay: StandstillRelay, *speeds: tuple[float, float], begin_s: float = 0.0) -> bool:
    """Show a relay speeds of wheel and belt, 10 ms each; return whether the torque is off."""
    for number, (wheel_m_s, belt_m_s) in enumerate(speeds):
        relay.look(wheel_m_s, belt_m_s, begin_s + 0.01 * number)
    return relay.off


@pytest.mark.parametrize("speeds", [(0.5, 0.0), (0.0, -0.5), (0.16, 0.0)])
def test_one_part_at_rest_and_the_other_turning_take_the_torque_off(speeds: tuple[float, float]) -> None:
    assert seen(StandstillRelay(), *[speeds] * 4)


@pytest.mark.parametrize("speeds", [(0.5, 0.5), (0.105, 0.0), (0.0, 0.0), (0.8, 0.02)])
def test_normal_motion_does_not_trip_it(speeds: tuple[float, float]) -> None:
    assert not seen(StandstillRelay(), *[speeds] * 50)


def test_torque_comes_back_once_both_stand() -> None:
    relay = StandstillRelay()
    assert seen(relay, *[(0.5, 0.0)] * 4, (0.05, 0.0))
    assert not seen(relay, (0.0, 0.0), begin_s=1.0)


def test_a_broken_relay_switches_nothing() -> None:
    relay = StandstillRelay()
    relay.works = False
    assert not seen(relay, *[(0.5, 0.0)] * 50)
