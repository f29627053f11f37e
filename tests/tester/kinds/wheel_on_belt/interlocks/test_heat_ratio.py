"""A rig's own heatings tighten the heat balance, and nothing of them loosens it."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.interlocks.heat_ratio import (
    FIRST,
    LEAST_SHARE,
    NEWEST,
    NO_HISTORY,
    KnownRatio,
    known_ratio,
)

WIDEST, KNOWN = 0.3, 0.12


def share(*ratios: float) -> float:
    return known_ratio(ratios, WIDEST, KNOWN).share(WIDEST, KNOWN)


def test_without_a_history_the_widest_share_stands() -> None:
    assert NO_HISTORY.share(WIDEST, KNOWN) == WIDEST
    assert share(1.0, 1.0) == WIDEST


def test_three_heatings_tighten_to_the_known_share_beyond_their_ratio() -> None:
    assert share(1.02, 1.0, 1.04) == pytest.approx(1.02 * 1.12 - 1.0)


@pytest.mark.parametrize("ratio", [1.2, 1.29])
def test_a_history_never_widens(ratio: float) -> None:
    assert share(*[ratio] * FIRST) == WIDEST


@pytest.mark.parametrize("ratio", [0.71, 0.8, 0.9])
def test_a_ratio_below_one_leaves_the_least_share(ratio: float) -> None:
    assert share(*[ratio] * FIRST) == LEAST_SHARE


def test_a_ratio_beyond_what_beliefs_explain_is_no_evidence() -> None:
    assert share(1.5, 0.5, 1.0, 1.0) == WIDEST
    assert known_ratio((1.5, 1.0, 1.0, 0.5, 1.0), WIDEST, KNOWN).count == 3


def test_heatings_that_do_not_agree_make_no_history() -> None:
    assert share(0.9, 1.1, 0.9, 1.1) == WIDEST


def test_the_first_that_agree_begin_the_history() -> None:
    assert known_ratio((0.8, 1.1, 1.0, 1.0, 1.02), WIDEST, KNOWN).ratio == 1.0


def test_a_supply_that_drifts_does_not_take_the_share_along() -> None:
    drifting = [1.0 + 0.01 * run for run in range(3 * NEWEST)]
    shares = [share(*drifting[:runs]) for runs in range(FIRST, len(drifting))]
    assert max(shares) <= 1.01 * 1.12 - 1.0 + 1e-9


def test_a_ratio_that_falls_tightens() -> None:
    assert share(*[1.08] * FIRST, *[1.0] * NEWEST) == pytest.approx(KNOWN)


def test_what_is_known_is_said_with_what_the_row_tells_from() -> None:
    assert NO_HISTORY.told(WIDEST, KNOWN) == "no history yet; a row tells from 30 %"
    assert KnownRatio(4, 1.02, 0.03).told(WIDEST, KNOWN) == (
        "known from 4 heatings, ratio 1.02, 0.03 apart; a row tells from 14 %"
    )


def test_a_history_that_tightens_nothing_asks_for_a_measurement() -> None:
    assert KnownRatio(4, 1.25).told(WIDEST, KNOWN).endswith("from 30 %: measure observer.thermal, or check the sensors")
