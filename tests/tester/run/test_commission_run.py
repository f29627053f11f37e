"""The person of a commissioning, as the screen of a recipe that is run in it."""

from __future__ import annotations

import pytest

from tester.run.commission_run import PersonScreen
from tester.tui.guide.guide_person import ScreenPerson


@pytest.mark.parametrize(
    ("given", "stopped"), [("hold", False), ("release", False), ("stop", True), ("fast stop", True)]
)
def test_hold_go_on_and_both_stops_reach_the_run(given: str, stopped: bool) -> None:
    person = ScreenPerson(time_stands=True)
    screen = PersonScreen(person, answer_yes=False)
    person.command(given)
    person.command("dance")
    assert screen.commands() == [given] and screen.commands() == []
    assert screen.stopped is stopped
