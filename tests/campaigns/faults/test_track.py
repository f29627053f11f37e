"""The campaign's second kind of machine, in small: some faults while it slides, and that every row has one."""

from __future__ import annotations

import pytest

from tests.campaigns.faults import track
from tests.campaigns.faults.campaign import conduct
from tests.campaigns.faults.moments import Moment, rehearse

SOME = (
    "track drive off the bus", "track overspeeds", "track stalls", "lift drive torque off", "load cell silent",
    "load cell open", "chamber silent", "safety chain opened", "process killed", "operator stop", "CAN frames repeated",
)  # fmt: skip


def test_every_row_has_a_fault_or_a_reason_why_none() -> None:
    assert track.left_out() == [] and {row.interlock for row in track.FIRST} <= set(track.ROWS)


@pytest.fixture(scope="module")
def moment() -> Moment:
    """The middle of a slide on the slow track."""
    return next(one for one in rehearse("slow track")[0] if one.step.endswith("slide") and one.phase == "middle")


def test_some_faults_while_it_slides_leave_it_safe_in_time(moment: Moment) -> None:
    tally = conduct("slide", [(moment, (fault,)) for fault in SOME])
    assert [f"{verdict.case}: {verdict.failures}" for verdict in tally.failed] == []
    tripped = {verdict.case.faults[0]: verdict.tripped_by for verdict in tally.verdicts}
    assert tripped["load cell open"] == "load cell saturated" and tripped["track stalls"] == "track speed"
    assert tripped["CAN frames repeated"] == "" and tripped["operator stop"] == ""
