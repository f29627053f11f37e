"""The language of fault scripts."""

from __future__ import annotations

from math import inf

import pytest

from sim.faults import FaultTextError
from sim.machines.wheel_on_belt.faults import CATALOGUE, LANGUAGE


def test_a_fault_at_a_time_for_a_while():
    found = LANGUAGE.parse("t=130 s: belt drive heartbeat lost for 3 s")
    assert (found.when.at_s, found.kind.phrase, found.lasts_s) == (130.0, "belt drive heartbeat lost", 3.0)


def test_times_have_units():
    assert LANGUAGE.parse("t=2 min: operator stop").when.at_s == 120.0
    assert LANGUAGE.parse("t=500 ms: operator stop").when.at_s == 0.5


def test_a_fault_at_a_scan_lasts_to_the_end():
    found = LANGUAGE.parse("at scan 1200: operator stop")
    assert found.when.scan == 1200
    assert found.lasts_s == inf


def test_a_fault_at_a_step_and_some_time_after_it():
    found = LANGUAGE.parse("step heat + 20 s: thermometer offset -15 K for 1 min")
    assert (found.when.step, found.when.after_s, found.value, found.lasts_s) == ("heat", 20.0, -15.0, 60.0)


@pytest.mark.parametrize(
    ("when", "name", "after_s"), [("3", "condition 3", 0.0), ("12/2 + 5 s", "condition 12/2", 5.0)],
)
def test_a_fault_at_a_condition_or_a_repeat_of_one(when: str, name: str, after_s: float):
    found = LANGUAGE.parse(f"condition {when}: friction 115 %")
    assert (found.when.step, found.when.after_s, found.value) == (name, after_s, 115.0)


def test_a_value_that_is_a_time_becomes_seconds():
    assert LANGUAGE.parse("t=1 s: scan stalled 250 ms").value == 0.25


def test_a_value_without_a_unit():
    assert LANGUAGE.parse("t=1 s: jacket exception 0x0B").value == 11.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("t=130 s: belt drive hartbeat lost", "nearest is 'belt drive heartbeat lost'"),
        ("step mesure: load cell frozen", "nearest is 'measure'"),
        ("t=130: operator stop", "unit '' of a time, expected ms or s"),
        ("at scan 0: operator stop", "scans count from 1"),
        ("soon: operator stop", "is no time"),
        ("operator stop", 'expected "WHEN: FAULT"'),
        ("t=1 s: load cell offset 3 K", "unit 'K', expected N"),
        ("t=1 s: operator stop 3 N", "takes no value"),
        ("t=1 s: guard opened for 0 s", "above 0 s"),
        ("t=-1 s: guard opened", "begins at t=0 s"),
    ],
)
def test_unreadable_lines_are_refused_with_the_expected_form(text: str, expected: str):
    with pytest.raises(FaultTextError) as caught:
        LANGUAGE.parse(text)
    assert expected in str(caught.value)
    assert text in str(caught.value)


def test_all_bad_lines_are_reported_at_once():
    with pytest.raises(FaultTextError) as caught:
        LANGUAGE.parse_script(["soon: operator stop", "t=1 s: guard opened", "t=1 s: nothing"])
    assert len(str(caught.value).splitlines()) == 2


def test_the_catalogue_has_at_least_forty_faults():
    assert len(CATALOGUE) >= 40


@pytest.mark.parametrize("phrase", sorted(CATALOGUE))
def test_every_row_can_be_written_and_makes_its_effect(phrase: str):
    found = LANGUAGE.parse(f"t=1 s: {phrase}")
    assert found.kind.effect(found.value) is not found.kind.effect(found.value)
