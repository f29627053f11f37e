"""Drawn lies, and the heats with them (``python -m tests.campaigns.liars``)."""

from __future__ import annotations

import math

import pytest

from tester.kinds.wheel_on_belt.control.loops import hub_needed_c
from tests.campaigns.faults.magnitudes import Written
from tests.campaigns.liars import __main__ as liars
from tests.campaigns.liars.kiln import HONEST, SHORTED, STICKS, Kiln, Lie, Twin

LIKE = Twin("3#", 23.0, dict.fromkeys(liars.UNLIKE, 1.0), 1.0, 0)
"""A twin as the rig file states it."""


def test_lies_fill_their_ranges() -> None:
    lies = [liars.lie_of(number) for number in range(liars.CASES)]
    drifts = [one.k_min for one in lies if one.k_min]
    gains = [one.percent for one in lies if not one.k_min]
    assert len(drifts) == len(gains)
    assert min(drifts) < -9.5 and max(drifts) > 9.5 and min(gains) < 81.0 and max(gains) > 119.0
    assert sum(0.05 <= abs(one) <= 1.0 for one in drifts) > 0.3 * len(drifts)
    assert {one.relay for one in lies} == {"", SHORTED, STICKS}
    assert {one.common for one in lies} == {False, True}


def test_an_honest_heat_gets_hot_below_its_ceiling() -> None:
    rig = liars.rig()
    heat = Kiln(rig, LIKE, liars.hottest_c()).heat(HONEST, liars.HEAT_S)
    assert heat.trip == "" and heat.hot_s < liars.HOT_S
    assert heat.hub_c < hub_needed_c(rig, liars.hottest_c()) + 1.0
    assert heat.ratio == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize(
    ("lie", "trip"),
    [
        (Lie(k_min=-2.0), "hub hotter than shown"), (Lie(k_min=-2.0, common=True), "hub hotter than shown"),
        (Lie(relay=SHORTED, relay_s=800.0), "heater stuck"), (Lie(k_min=9.0), "heat not given"),
    ],
)  # fmt: skip
def test_a_lie_ends_a_heat_before_the_hub_comes_to_harm(lie: Lie, trip: str) -> None:
    heat = Kiln(liars.rig(), LIKE, liars.hottest_c(), liars.known(LIKE)).heat(lie, liars.HEAT_S)
    assert heat.trip == trip and heat.hub_c < 155.0


def test_a_lie_that_the_table_of_hardware_lists_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = Written("hub sensor gain", 85.0, 90.0, "%", "", "", "")
    monkeypatch.setattr(liars, "written", lambda: (listed,))
    assert liars.listed(Lie(percent=88.0)) and not liars.listed(Lie(percent=91.0))
    assert not liars.listed(Lie(percent=88.0, common=True))


def test_a_computed_bound_agrees_with_its_row_only(monkeypatch: pytest.MonkeyPatch) -> None:
    row = Written("hub sensor gain", 85.0, 90.0, "%", "", "", "", liars.NO_HISTORY)
    monkeypatch.setattr(liars, "written", lambda: (row,))
    assert liars.Bound("hub sensor gain", liars.NO_HISTORY, 85.0, 90.0, 160.0).agrees
    assert not liars.Bound("hub sensor gain", liars.NO_HISTORY, 84.0, 90.0, 160.0).agrees
    assert not liars.Bound("hub sensor gain", "", 85.0, 90.0, 160.0).agrees
    assert liars.Bound("hub sensor gain", "", math.inf, -math.inf, 0.0).agrees
    assert not liars.listed(Lie(percent=88.0))
