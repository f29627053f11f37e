from __future__ import annotations

import pytest

from tester.service.alarms import AlarmList, Cause

TRIP = Cause("overload", 1, "461 N", "the rig stands", value=461.0, limit=450.0, unit="N")
LATE = Cause("no fresh data", 2, "3 s old")
HINT = Cause("zero drift", 3, "6 N")


@pytest.fixture
def told() -> list[tuple[str, str, str]]:
    return []


@pytest.fixture
def alarms(told: list[tuple[str, str, str]]) -> AlarmList:
    return AlarmList(lambda: "now", lambda *one: told.append(one))


def states(alarms: AlarmList) -> list[tuple[str, str]]:
    return [(alarm.name, alarm.state) for alarm in alarms.listed()]


def test_an_alarm_stays_until_its_cause_is_gone_and_it_is_acknowledged(alarms: AlarmList) -> None:
    alarms.raise_(LATE, 1.0)
    assert states(alarms) == [("no fresh data", "active")]
    alarms.clear("no fresh data")
    assert states(alarms) == [("no fresh data", "returned")]
    assert alarms.acknowledge(0, "me") == 1
    assert states(alarms) == []


def test_an_acknowledged_alarm_leaves_with_its_cause(alarms: AlarmList) -> None:
    alarms.raise_(TRIP, 1.0)
    alarms.acknowledge(1, "me")
    assert states(alarms) == [("overload", "acknowledged")]
    alarms.clear("overload")
    assert states(alarms) == []


def test_a_returned_alarm_that_comes_again_is_a_new_one(alarms: AlarmList) -> None:
    alarms.raise_(LATE, 1.0)
    alarms.clear("no fresh data")
    alarms.raise_(LATE, 2.0)
    assert [(alarm.number, alarm.state) for alarm in alarms.listed()] == [(2, "active")]


def test_an_unacknowledged_hint_leaves_with_its_cause(alarms: AlarmList) -> None:
    alarms.raise_(HINT, 1.0)
    alarms.clear("zero drift")
    assert len(alarms) == 0


def test_the_first_trip_is_marked_and_listed_above_later_ones(alarms: AlarmList) -> None:
    alarms.raise_(LATE, 0.5)
    alarms.raise_(TRIP, 1.0)
    alarms.raise_(Cause("drive fault", 1, "wheel"), 1.0)
    assert [(alarm.name, alarm.first_up) for alarm in alarms.listed()] == [
        ("overload", True),
        ("drive fault", False),
        ("no fresh data", False),
    ]


def test_an_active_alarm_takes_new_figures_silently(alarms: AlarmList, told: list[tuple[str, str, str]]) -> None:
    alarms.raise_(LATE, 1.0)
    alarms.raise_(Cause("no fresh data", 2, "4 s old"), 2.0)
    assert alarms.listed()[0].text == "4 s old"
    assert len(told) == 1


def test_acknowledging_one_leaves_the_others(alarms: AlarmList) -> None:
    alarms.raise_(TRIP, 1.0)
    alarms.raise_(LATE, 1.0)
    assert alarms.acknowledge(2, "me") == 1
    assert states(alarms) == [("overload", "active"), ("no fresh data", "acknowledged")]
    assert alarms.acknowledge(2, "me") == 0
