"""The trend of a temperature, and whether it may reach a limit soon."""

from __future__ import annotations

from math import nan

import pytest

from tester.machine.trend import FADES, SURE, TemperatureTrend


def trend(*readings_c: float) -> TemperatureTrend:
    """Return the trend after these readings."""
    made = TemperatureTrend()
    for reading_c in readings_c:
        made.follow(reading_c)
    return made


def test_a_limit_is_far_that_is_many_changes_away() -> None:
    moved = trend(20.0, 20.5)
    assert moved.far(0.5 * SURE + 0.01) and not moved.far(0.5 * SURE - 0.01)


def test_the_greatest_change_fades() -> None:
    assert trend(20.0, 20.5, 20.5, 20.5).moved_k == pytest.approx(0.5 * FADES**2)
    assert trend(20.0, 20.5, 21.5).moved_k == 1.0


def test_an_unknown_distance_is_not_far() -> None:
    assert not trend().far(trend().last_c - 20.0)
    assert not trend(20.0).far(nan)
