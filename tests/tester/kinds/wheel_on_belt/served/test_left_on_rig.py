"""The machine's state from past runs: wheel, zero, heat; and the wheel that manual mode assumes."""

from __future__ import annotations

import pytest

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY, KnownRatio
from tester.kinds.wheel_on_belt.served.left_on_rig import WheelLeft, age_words, heat_check, wheel_check, zero_check
from tester.kinds.wheel_on_belt.served.manual import taken_for
from tester.store.records import PieceInfo

NOW = "2026-03-01T12:00:00.000Z"
LEFT = WheelLeft("run", PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 89.4, 812.0), "2026-03-01T09:30:00.000Z")


def test_without_a_run_nothing_is_claimed() -> None:
    assert wheel_check(None).ok is None and zero_check(None, NOW).ok is None


def test_wheel_and_zero_of_the_last_run_are_shown_with_wear_and_age() -> None:
    assert wheel_check(LEFT).text.startswith("last 1#, 89.40 mm, 0.60 mm worn off in 812 m")
    assert zero_check(LEFT, NOW).text.startswith("2 h old")


def test_without_a_run_a_new_wheel_is_named() -> None:
    assert taken_for(None, 90.0).startswith("the wheel is taken to have 90.00 mm, a new one")


@pytest.mark.parametrize(("seconds", "words"), [(0.0, "0 min"), (7100.0, "118 min"), (7300.0, "2 h"), (2e5, "2 d")])
def test_an_age_is_shown_in_a_suitable_unit(seconds: float, words: str) -> None:
    assert age_words(seconds) == words


@pytest.mark.parametrize(
    ("heat", "ok", "words"),
    [
        (NO_HISTORY, None, "no history yet; a row tells from 30 %"),
        (KnownRatio(3, 1.0), True, "known from 3 heatings, ratio 1.00, 0.00 apart; a row tells from 9 %"),
        (KnownRatio(3, 1.25), None, "known from 3 heatings, ratio 1.25, 0.00 apart; a row tells from 30 %: measure"
                                    " observer.thermal, or check the sensors"),
    ],
)  # fmt: skip
def test_the_state_of_the_heat_balance_is_shown(heat: KnownRatio, ok: bool | None, words: str) -> None:
    found = heat_check(heat, load_rig("sim"))
    assert (found.name, found.ok, found.text) == ("heat balance", ok, words)
