"""Loss of a belt's grip by travel under load."""

from __future__ import annotations

import pytest

from sim.physics.parameters import CounterfaceParameters

BLUNT = CounterfaceParameters(loss=0.1)


def test_a_belt_loses_its_share_over_its_travel_and_the_same_share_again() -> None:
    assert BLUNT.grip_kept(2000.0, 25.0) == pytest.approx(0.9)
    assert BLUNT.grip_kept(4000.0, 25.0) == pytest.approx(0.81)
    assert BLUNT.grip_kept(500.0, 25.0) ** 4 == pytest.approx(0.9)


def test_hot_rubber_clogs_it() -> None:
    assert BLUNT.grip_kept(2000.0, 60.0) == pytest.approx(0.9)
    assert BLUNT.grip_kept(2000.0, 85.0) == pytest.approx(0.9**1.5)


def test_a_belt_keeps_its_grip_unless_it_is_asked_to_lose_some() -> None:
    assert CounterfaceParameters().grip_kept(1e6, 85.0) == 1.0


@pytest.mark.parametrize("wrong", [{"loss": 1.0}, {"loss": -0.1}, {"loss_travel": 0.0}])
def test_a_number_that_is_no_share_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="CounterfaceParameters"):
        CounterfaceParameters(**wrong)
