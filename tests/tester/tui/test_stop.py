"""STOP reaches the service from everywhere: every screen, dialog, input field, the palette; with real keys."""

from __future__ import annotations

from pathlib import Path

import pytest
from textual.widgets import Input

from tester.service.commands import Stop
from tests.tester.service.views import state as a_state
from tests.tester.service.views import with_alarm, with_prompt
from tests.tester.tui.stage import House, Stage, play

SCREENS = {"recipes": ["f2"], "run": ["f3"], "manual": ["f4"], "results": ["f5"], "bus": ["f6"]}
PLACES: dict[str, list[str]] = {
    **SCREENS,
    "the recipe's text": ["f2", "tab"],
    "start dialog": ["f2", "enter"],
    "start dialog, operator": ["f2", "enter", "shift+tab", "shift+tab", "shift+tab", "shift+tab"],
    "start dialog, checkbox": ["f2", "enter", "shift+tab"],
    "plan dialog": ["f2", "d"],
    "help": ["f3", "f1"],
    "event log": ["f3", "l"],
    "abort dialog, its word": ["f3", "x", "a", "b"],
    "prompt dialog": ["f3", "enter"],
    "resume dialog": ["f3", "r"],
    "filter of the frames": ["f6", "slash", "2"],
    "palette": ["f3", "ctrl+p"],
    "palette, a word typed": ["f3", "ctrl+p", "h", "o"],
}


@pytest.mark.parametrize("place", PLACES)
def test_the_keys_of_both_stops_reach_the_service_from(place: str, house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_prompt(a_state("HOLD" if place == "resume dialog" else "RUN")))
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press(*PLACES[place])
        await on.pilot.pause()
        if place not in SCREENS and place != "the recipe's text" and "filter" not in place:
            assert len(on.app.screen_stack) == 2, on.text()
        if any(word in place for word in ("word", "operator", "filter")):
            assert isinstance(on.app.focused, Input), on.text()
        for key, fast in (("f12", False), ("ctrl+x", False), ("f9", True), ("ctrl+f", True)):
            on.fake.orders.clear()
            await on.pilot.press(key)
            assert await on.ordered(Stop) == Stop(fast)

    house.play(act)


def test_stop_works_while_the_terminal_is_too_small(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        assert "the run continues" in on.text() and "F12 STOP" in on.text()
        await on.pilot.press("f12")
        assert await on.ordered(Stop) == Stop(False)

    play(act, tmp_path, (20, 5))


def test_a_stop_refused_by_the_service_is_reported_loudly(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        on.fake.refusals["stop"] = "no rig"
        await on.pilot.press("f12")
        await on.until(lambda: "STOP has not reached the service" in on.text(), "the failure is shown")
        assert [order.action for order in on.fake.orders] == [Stop(False)]

    play(act, tmp_path)


def test_a_view_only_screen_commands_nothing_and_shows_the_way_to_stop(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_alarm(a_state()))
        await on.pilot.press("f3", "space", "a", "f12")
        await on.until(lambda: "tester stop" in on.text(), "the way to stop is shown")
        assert not on.fake.orders

    play(act, tmp_path, view_only=True)
