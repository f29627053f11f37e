"""Messages to the person: above the last line, also in a dialog, never over anything, removed after a while."""

from __future__ import annotations

from tester.tui.widgets.said import SHORT_S, SaidLines, said_now
from tests.tester.tui.stage import House, Stage


def test_a_message_has_a_line_of_its_own_and_expires(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.until(on.checked, "the recipes are checked")
        before = on.text().split("\n")
        on.app.say("two words", problem=True)
        await on.until(lambda: "two words" in on.line(-2), "the message is above the last line")
        assert on.line(-1) == before[-1] and on.text().split("\n")[:2] == before[:2]
        assert on.line(-3).startswith("╰")  # the screen's boxes end above it
        on.now[0] += SHORT_S + 1.0
        on.app.show_said()
        await on.until(lambda: on.line(-2) == before[-2] and "two words" not in on.text(), "the message is gone")

    house.play(act)


def test_a_message_is_seen_while_a_dialog_is_open(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f1")
        on.app.say("while the help is open")
        await on.until(lambda: "while the help is open" in on.line(-2), "the message is above the last line")
        assert "STOP" in on.line(-1)
        await on.pilot.press("escape")
        await on.until(lambda: "while the help is open" in on.line(-2), "the message stays when the dialog closes")

    house.play(act)


def test_the_newest_messages_are_shown_and_a_long_one_for_longer() -> None:
    assert said_now("x" * 300, problem=False, lasting=False, now_s=0.0).until_s == 20.0
    lines = SaidLines()
    lines.show_said([said_now(text, problem=False, lasting=False, now_s=0.0) for text in ("one", "two", "three")])
    shown = str(lines.content)
    assert lines.display and "one" not in shown and "two" in shown and "three" in shown
    lines.show_said([])
    assert not lines.display
