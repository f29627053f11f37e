"""The processor time of a campaign, in units of a loop."""

from __future__ import annotations

import pytest

from tests.campaigns.faults import effort
from tests.campaigns.faults.effort import LOOP_S, Effort


@pytest.mark.parametrize("slower", [1.0, 3.0])
def test_a_machine_that_is_slower_in_both_shows_the_same_time(slower: float, monkeypatch: pytest.MonkeyPatch) -> None:
    spent = iter([100.0, 100.0, 100.0 + slower, 100.0 + slower + 20.0 * slower])
    monkeypatch.setattr(effort, "cpu_s", lambda: next(spent))
    monkeypatch.setattr(effort, "_loop_s", lambda: LOOP_S * slower)
    assert Effort().reference_s == pytest.approx(20.0)


def test_the_loop_counts_for_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    spent = iter([0.0, 0.0, 5.0, 5.0])
    monkeypatch.setattr(effort, "cpu_s", lambda: next(spent))
    monkeypatch.setattr(effort, "_loop_s", lambda: LOOP_S)
    assert Effort().used_s == pytest.approx(0.0)
