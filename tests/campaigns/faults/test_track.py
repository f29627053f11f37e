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


def test_a_fault_with_a_magnitude_is_one_of_the_rigs_that_have_it() -> None:
    assert track.fits("slow track", "track overspeeds 3 mm/s") and track.fits("disc", "load cell offset -150 N")
    assert not track.fits("slow track", "pyrometer offset 5 K") and not track.fits("disc", "track overspeed 3 mm/s")


def test_a_track_within_its_share_of_the_speed_is_not_astray(moment: Moment) -> None:
    near, far = conduct("slide", [(moment, (f"track overspeeds {mm_s} mm/s",)) for mm_s in (0.24, 0.28)]).verdicts
    assert near.failures == far.failures == []
    assert far.tripped_by == "track speed" and far.ended_after_s < 1.3 < near.ended_after_s
