"""The person of a commissioning, as the screen of a recipe run in it."""

from __future__ import annotations

import pytest

from tester.run.commission_run import PersonScreen
from tester.tui.guide.guide_person import ScreenPerson


@pytest.mark.parametrize("command", ["hold", "release", "stop", "fast stop"])
def test_hold_release_and_both_stops_reach_the_run(command: str) -> None:
    person = ScreenPerson(time_stands=True)
    screen = PersonScreen(person, answer_yes=False)
    person.command(command)
    assert screen.commands() == [command] and screen.commands() == []
