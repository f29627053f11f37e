"""The mark beside a condition's number."""

from __future__ import annotations

import pytest

from tester.analysis.flags import DOUBTS
from tester.analysis.results import ConditionStatus, mark_of


@pytest.mark.parametrize("status", ConditionStatus)
def test_only_a_condition_that_is_ok_is_without_a_mark(status: ConditionStatus) -> None:
    assert mark_of(status, "extended") == ("" if status is ConditionStatus.OK else "!")


@pytest.mark.parametrize("flag", DOUBTS)
def test_a_doubt_is_marked(flag: str) -> None:
    assert mark_of("ok", f"extended; {flag}") == "?"
