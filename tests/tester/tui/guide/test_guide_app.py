"""`tester commission --tui`: real keys, on the simulated rig; steps, STOP, resuming, bad answers."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import Any

import pytest
from textual.driver import Driver
from textual.events import Key

from tester.base.source import InvalidSource, Problem
from tester.machine.commission.commission_step import CommissionStep
from tester.machine.commission.person import Walk
from tester.machine.commission.quiet_seat import JogSeat
from tester.machine.commission.record import DONE, CommissionRecord
from tester.machine.commission.step_engine import Ended
from tester.tui.guide.guide_person import ScreenPerson
from tester.tui.stop_line import stopping
from tests.tester.tui.guide.twin_stage import TwinStage
from tests.tester.tui.stage import WAIT_S
from tests.tester.tui.test_stop_line import Silent


def done(stage: TwinStage) -> list[str]:
    return [one.step for one in CommissionRecord(stage.guide.path, str, "").entries if one.what == DONE]


def at_rest(stage: TwinStage) -> None:
    """No drive has power, and no axis moves."""
    for name, drive in stage.twin.hands.axes.items():
        assert not drive.energised, name
        assert abs(drive.axis.value) < 1e-6 or drive.config.mode == "position", name


def test_three_steps_are_done_with_real_keys_and_stand_when_the_screen_is_opened_again(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    async def act(on: TwinStage) -> None:
        await on.asked("begin identify")
        assert "nothing is connected, nothing moves" in on.text() and on.twin.hands is None
        await on.answer_until("jog belt whole read")
        assert "moved in all" in on.text() and "guard, safety chain" in on.text()
        assert "✔ jog wheel" in on.text() and "▶ jog belt" in on.text() and "▸ jog press" in on.text()
        await on.answer_until("begin jog press")
        assert "3 of 16 steps stand" in on.text()
        await on.type("n")
        await on.ended()
        assert "left before the end" in on.text()

    stage.play(act)
    assert done(stage) == ["identify", "jog wheel", "jog belt"]
    assert stage.guide.outcome is not None and stage.guide.outcome.ended is Ended.LEFT
    again = TwinStage(tmp_path)

    async def look(on: TwinStage) -> None:
        await on.asked("begin jog press")
        assert "3 of 16 steps stand" in on.text() and on.twin.hands is None
        await on.press("tab", "home", "down", "enter")
        assert "On record: jog wheel" in on.text() and "scale_error" in on.text()

    again.play(look)


class HeldPerson(ScreenPerson):
    """Keeps the engine waiting in the middle of a jog, so that a key is pressed while something moves."""

    def __init__(self) -> None:
        super().__init__(time_stands=True)
        self.moving, self.pressed = Event(), Event()

    def look(self, step: CommissionStep, walk: Walk) -> None:
        super().look(step, walk)
        seat: Any = walk.seat
        jog = seat.jogging.jog if isinstance(seat, JogSeat) else None
        if jog is not None and not jog.over and 0.2 < abs(jog.moved / jog.way) < 0.8 and not self.pressed.is_set():
            self.moving.set()
            assert self.pressed.wait(WAIT_S)


@pytest.mark.parametrize(("key", "dialog"), [("f12", False), ("ctrl+x", True), ("f9", True), ("space", False)])
def test_stop_during_a_jog_brings_it_to_rest_and_the_step_can_be_begun_again(
    key: str, dialog: bool, tmp_path: Path
) -> None:
    stage = TwinStage(tmp_path, 2.0)
    person = stage.guide.person = HeldPerson()

    async def act(on: TwinStage) -> None:
        await on.answer_until("jog wheel first")
        await on.type("go")
        if dialog:
            await on.press("f1")
            assert len(on.app.screen_stack) == 2
        await on.until(person.moving.is_set, "the wheel moves")
        assert on.twin.hands.axes["wheel"].axis.value > 0.1  # rad/s: it does move
        await on.press(key)
        person.pressed.set()
        await on.ended()
        assert "stopped at jog wheel" in on.text()
        at_rest(on)
        if dialog:
            await on.press("escape")
        await on.press("r")
        await on.asked("begin jog wheel")
        assert done(on) == ["identify"]

    stage.play(act)
    assert stage.guide.outcome is not None and stage.guide.outcome.ended is Ended.STOPPED


def test_stop_needs_no_screen_that_draws(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path, 2.0)
    person = stage.guide.person = HeldPerson()
    driver: Driver = stopping(Silent, person)()  # type: ignore[call-arg]

    async def act(on: TwinStage) -> None:
        await on.answer_until("jog wheel first")
        await on.type("go")
        await on.until(person.moving.is_set, "the wheel moves")
        driver.process_message(Key("f12", None))  # like the thread that reads the terminal
        person.pressed.set()
        engine = on.guide._thread
        assert engine is not None
        engine.join(WAIT_S)  # the screen's loop is blocked meanwhile
        assert not engine.is_alive()
        at_rest(on)

    stage.play(act)
    assert stage.guide.outcome is not None and stage.guide.outcome.ended is Ended.STOPPED


@pytest.mark.parametrize(("key", "command"), [("f12", "stop"), ("ctrl+x", "stop"), ("f9", "fast stop")])
def test_stop_is_taken_where_the_terminal_is_read_before_the_screen_gets_it(key: str, command: str) -> None:
    person = ScreenPerson(time_stands=True)
    driver: Driver = stopping(Silent, person)()  # type: ignore[call-arg]
    driver.process_message(Key(key, None))
    assert person.commands() == [command] and person.commands() == []


def test_an_invalid_answer_is_refused_in_words_and_not_passed_on(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    async def act(on: TwinStage) -> None:
        await on.asked("begin identify")
        await on.type("perhaps")
        assert "expected one of: yes, no" in on.text()
        await on.press(*["backspace"] * 7)
        assert "expected one of" not in on.text()
        await on.answer_until("jog wheel first")
        await on.type("g")  # a word that starts motion is typed in full
        assert 'expected "go"' in on.text() and on.app._asked is not None
        await on.press("backspace")
        await on.answer_until("jog wheel first read")
        await on.type("23 N")
        assert "23 N" in on.text() and "deg" in on.text()
        assert on.app._asked is not None and on.app._asked.key == "jog wheel first read"

    stage.play(act)
    assert not any("23 N" in text for text in stage.guide.person.messages)


def test_nothing_moves_by_space_while_a_question_is_open_and_a_message_appears(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    async def act(on: TwinStage) -> None:
        await on.answer_until("jog wheel first")
        await on.press("tab", "space")
        await on.until(lambda: "nothing moves before you answer" in on.text(), "it is said")
        assert on.app.seen.running

    stage.play(act)


def test_leaving_in_a_step_stops_it_first(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    async def act(on: TwinStage) -> None:
        await on.answer_until("jog wheel direction")
        await on.press("ctrl+c")
        await on.until(lambda: on.app._exit, "the screen ends")
        assert not on.guide.running
        at_rest(on)

    stage.play(act)
    assert stage.guide.outcome is not None and stage.guide.outcome.ended is Ended.STOPPED


def test_a_refused_step_shows_its_remedy_in_full(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    async def act(on: TwinStage) -> None:
        await on.answer_until("jog wheel direction")
        await on.type("rev")
        await on.asked("again")
        await on.type("leave")
        await on.ended()
        assert "0x607E" in on.text() and "r continues" in on.text()

    stage.play(act)
    assert stage.guide.outcome is not None and stage.guide.outcome.ended is Ended.REFUSED


def test_a_rig_file_broken_meanwhile_is_reported_with_its_line_and_tried_again(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)
    good = stage.guide._load

    def spoiled() -> Any:
        raise InvalidSource([Problem("rig.yaml", 7, 3, "axes.belt: expected a number")])

    async def act(on: TwinStage) -> None:
        await on.asked("begin identify")
        await on.type("no")
        await on.ended()
        on.guide._load = spoiled
        await on.press("r")
        assert "rig.yaml:7:3" in on.text()
        on.guide._load = good
        await on.press("r")
        await on.asked("begin identify")

    stage.play(act)


def test_an_error_of_the_program_itself_is_shown_stops_and_is_raised_again(tmp_path: Path) -> None:
    stage = TwinStage(tmp_path)

    def broken(_step: CommissionStep, walk: Walk) -> None:
        raise ZeroDivisionError("a reading")

    stage.guide.person.look = broken  # type: ignore[method-assign]

    async def act(on: TwinStage) -> None:
        await on.asked("begin identify")
        await on.type("yes")
        await on.ended()
        assert "the program has failed: ZeroDivisionError" in on.text()

    with pytest.raises(ZeroDivisionError):
        stage.play(act)
    assert not any(drive.energised for drive in stage.twin.hands.axes.values())
