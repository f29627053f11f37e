"""Every row of the interlock table is the first cause of something: a few in the default run, all in the campaign."""

from __future__ import annotations

import pytest

from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tests.campaigns.faults.first_up import FIRST, NEVER_FIRST, SLIDE, conduct, left_out

FEW = ("belt torn", "hub sensor jump", "surface sensor jump", "line noisy", "not stopping", "quick stop failed",
       "not lifted", "overload", "drive data stale")  # fmt: skip


def test_every_row_has_a_fault_that_trips_it_first_or_a_reason_why_none_can():
    assert left_out() == []
    assert NEVER_FIRST.keys() <= {row.name for row in TABLE.rows}
    assert all(NEVER_FIRST.values()) and not NEVER_FIRST.keys() & {row.interlock for row in FIRST}


def test_a_few_rows_are_the_first_cause_of_their_faults():
    rows = [row for row in FIRST if row.interlock in FEW and row.where == SLIDE]
    found = conduct(rows)
    assert len(found) == len(FEW)
    assert {row.interlock: cause for row, cause in found.items()} == {name: name for name in FEW}


@pytest.mark.campaign
def test_every_row_is_the_first_cause_of_its_faults():
    assert [(row.interlock, cause) for row, cause in conduct().items() if cause != row.interlock] == []
