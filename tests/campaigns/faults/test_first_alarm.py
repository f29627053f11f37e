"""The first alarm names whatever was pulled out of a running machine."""

from __future__ import annotations

import pytest

from tests.campaigns.faults.first_alarm import PULLED, conduct, unnamed

FEW = ("cell cable or power off", "heat line out", "CAN adapter out", "CAN plug out", "plug of the belt drive out")


def test_the_first_alarm_names_what_was_pulled_out_while_the_wheel_slides() -> None:
    found = conduct([one for one in PULLED if one.what in FEW], ("measure",))
    assert len(found) == len(FEW)
    assert unnamed(found) == []


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(5))
def test_the_first_alarm_names_it_at_every_step_with_contact(seed: int) -> None:
    found = conduct(PULLED, ("soak", "roll", "wait", "measure"), seed)
    assert len(found) == 4 * len(PULLED)
    assert unnamed(found) == []
